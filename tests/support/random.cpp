#include "support/random.hpp"

#include <cmath>
#include <numbers>

namespace hydrapod::test {

using spatial::Matrix3;
using spatial::Vector3;
using spatial::Vector6;

double Random::uniform() {
  constexpr double ulp = 0x1p-53;
  return ulp * static_cast<double>(engine_() >> 11);
}

double Random::log_uniform(double low, double high) {
  return low * std::pow(high / low, uniform());
}

Vector3 Random::vector(double size) {
  const double x = uniform(-size, size), y = uniform(-size, size), z = uniform(-size, size);
  return {x, y, z};
}

Vector3 Random::direction() {
  const double z = uniform(-1.0, 1.0), angle = uniform(0.0, 2.0 * std::numbers::pi);
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

Matrix3 Random::rotation() {
  const Vector3 axis = direction();
  return spatial::rotation_from_vector(uniform(0.0, std::numbers::pi) * axis);
}

Matrix3 Random::inertia(double mass, double radius) {
  // Second moments of a mass distribution may be any positive numbers; the inertia follows from
  // them.
  Vector3 moments;
  for (double& moment : moments) moment = mass * radius * radius * uniform(0.2, 1.0);
  const Vector3 principal = Vector3::Constant(moments.sum()) - moments;
  const Matrix3 R = rotation();
  const Matrix3 I = R * principal.asDiagonal() * R.transpose();
  return 0.5 * (I + I.transpose());
}

Vector6 Random::displacement(double length, double angle) {
  Vector6 displacement;
  displacement.head<3>() = vector(length);
  const Vector3 axis = direction();
  displacement.tail<3>() = uniform(0.0, angle) * axis;
  return displacement;
}

}  // namespace hydrapod::test
