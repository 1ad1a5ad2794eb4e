#include "hydrapod/model/machine.hpp"

#include <cmath>
#include <numbers>

namespace hydrapod::model {

namespace {
constexpr double degree = std::numbers::pi / 180.0;

Vector3 on_circle(double radius, double angle) {
  return {radius * std::cos(angle), radius * std::sin(angle), 0.0};
}
}  // namespace

JointPoints base_joint_points(const JointCircle& circle) {
  const double alpha = circle.half_angle();
  JointPoints points;
  for (int pair = 0; pair < 3; ++pair) {
    const double center = (60.0 + 120.0 * pair) * degree;
    points[2 * pair] = on_circle(circle.radius, center - alpha);
    points[2 * pair + 1] = on_circle(circle.radius, center + alpha);
  }
  return points;
}

JointPoints platform_joint_points(const JointCircle& circle) {
  const double alpha = circle.half_angle();
  JointPoints points;
  for (int pair = 0; pair < 3; ++pair) {
    points[2 * pair] = on_circle(circle.radius, 120.0 * pair * degree + alpha);
    points[2 * pair + 1] = on_circle(circle.radius, 120.0 * (pair + 1) * degree - alpha);
  }
  return points;
}

}  // namespace hydrapod::model
