/// What a controller measures and what it is commanded, apart from the loop that runs it.

#include "true_measurement.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "hydrapod/simulation/closed_loop.hpp"

namespace hydrapod::simulation {

namespace {

/// Accelerations [m/s²] as accelerometers along the legs at the platform's joints see them: l̈, and
/// what a base that moves adds.
Vector6 leg_accelerations(const model::Machine& machine, const PlantOutput& plant) {
  const Vector3 omega = plant.twist.tail<3>();
  Vector6 found;
  for (size_t i = 0; i < model::leg_count; ++i) {
    const Vector3 a = plant.X_BP * machine.legs[i].platform_joint;
    const Vector3 arm = a - plant.p_BC;
    const Vector3 speed = plant.twist.head<3>() + omega.cross(arm);
    const Vector3 acceleration = plant.ground_acceleration.head<3>() +
                                 plant.ground_acceleration.tail<3>().cross(arm) +
                                 omega.cross(omega.cross(arm));
    const Vector3 L = a - machine.legs[i].base_joint;
    const double l = L.norm();
    const Vector3 n = L / l;
    const double along = n.dot(speed);
    found[static_cast<int>(i)] = n.dot(acceleration) + (speed.squaredNorm() - along * along) / l;
  }
  return found;
}

}  // namespace

control::Measurement true_measurement(const Plant& plant, const double* x, const PlantInput& input,
                                      model::DampingFeedback feedback) {
  const auto& layout = plant.layout();
  control::Measurement truth;
  truth.length = plant.leg_lengths(x);
  if (layout.pressures >= 0) {
    for (int i = 0; i < model::leg_count; ++i) {
      truth.cap_pressure[i] = x[layout.cap(i)];
      truth.rod_pressure[i] = x[layout.rod(i)];
    }
  }
  if (feedback == model::DampingFeedback::acceleration)
    truth.acceleration = leg_accelerations(plant.machine(), plant.outputs(x, input));
  return truth;
}

control::Command command_at(const Pose& operating, const signals::Sample& displacement) {
  const Vector3 rpy = displacement.value.tail<3>(), rates = displacement.rate.tail<3>();
  const double sy = std::sin(rpy.y()), cy = std::cos(rpy.y());
  const double sz = std::sin(rpy.z()), cz = std::cos(rpy.z());
  control::Command command;
  command.X_BP = {spatial::rotation_from_rpy(rpy) * operating.R_BP,
                  operating.p_BP + displacement.value.head<3>()};
  // The angular velocity in base axes of Rz(rz) Ry(ry) Rx(rx).
  command.velocity << displacement.rate.head<3>(), rates.x() * Vector3(cz * cy, sz * cy, -sy) +
                                                       rates.y() * Vector3(-sz, cz, 0.0) +
                                                       rates.z() * Vector3::UnitZ();
  return command;
}

Vector6 displacement_between(const Pose& operating, const Pose& X_BP) {
  Vector6 found;
  found << X_BP.p_BP - operating.p_BP,
      spatial::rpy_from_rotation(X_BP.R_BP * operating.R_BP.transpose());
  return found;
}

}  // namespace hydrapod::simulation
