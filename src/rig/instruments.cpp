#include "hydrapod/rig/rig.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace hydrapod::rig {

std::vector<Accelerometer> default_accelerometers(const model::Machine& machine) {
  std::vector<Accelerometer> list;
  constexpr std::array<const char*, 3> axes{"x", "y", "z"};
  for (const int leg : {1, 3, 5})
    for (int axis = 0; axis < 3; ++axis) {
      Accelerometer one;
      one.name = fmt::format("acceleration {}{}", leg, axes[axis]);
      one.p_P = machine.legs[leg - 1].platform_joint;
      one.e_P = Vector3::Unit(axis);
      one.direction = static_cast<data::Direction>(axis + 1);
      one.point = leg;
      list.push_back(one);
    }
  return list;
}

/// Against the ground, with the share of gravity as the platform and the base under it tilt.
double specific_force(const Accelerometer& one, const model::Machine& machine,
                      const spatial::Pose& operating, const simulation::PlantOutput& plant) {
  const Vector3 p_CA_B = plant.X_BP.R_BP * (one.p_P - machine.platform.mass_center);
  const Vector3 omega = plant.twist.tail<3>(), alpha = plant.ground_acceleration.tail<3>();
  const Vector3 a =
      plant.ground_acceleration.head<3>() + alpha.cross(p_CA_B) + omega.cross(omega.cross(p_CA_B));
  const Vector3& gravity = machine.gravity;
  const Vector3 gravity_B = gravity - Vector3(plant.base.motion.tail<3>()).cross(gravity);
  const double at_rest = (operating.R_BP * one.e_P).dot(-gravity);
  return (plant.X_BP.R_BP * one.e_P).dot(a - gravity_B) - at_rest;
}

void LowPass::add(double corner, double zeta, double rate) {
  if (!(corner < rate / 2.0)) return;
  const double c = 1.0 / std::tan(std::numbers::pi * corner / rate);
  const double scale = 1.0 / (c * c + 2.0 * zeta * c + 1.0);
  sections_.push_back({scale, 2.0 * (1.0 - c * c) * scale, (c * c - 2.0 * zeta * c + 1.0) * scale});
}

LowPass LowPass::butterworth(int order, double corner, double rate) {
  LowPass filter;
  for (int k = 0; k < order / 2; ++k)
    filter.add(corner, std::sin(std::numbers::pi * (2.0 * k + 1.0) / (2.0 * order)), rate);
  return filter;
}

LowPass LowPass::second_order(double corner, double zeta, double rate) {
  LowPass filter;
  if (corner > 0.0) filter.add(corner, zeta, rate);
  return filter;
}

double LowPass::operator()(double value) {
  for (Section& s : sections_) {  // transposed direct form II
    const double out = s.b * value + s.s1;
    s.s1 = 2.0 * s.b * value - s.a1 * out + s.s2;
    s.s2 = s.b * value - s.a2 * out;
    value = out;
  }
  return value;
}

void LowPass::settle(double value) {
  for (Section& s : sections_) {  // unit gain at rest: in and out are `value`
    s.s2 = (s.b - s.a2) * value;
    s.s1 = (1.0 - s.b) * value;
  }
}

}  // namespace hydrapod::rig
