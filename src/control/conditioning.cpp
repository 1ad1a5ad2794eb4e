#include "conditioning.hpp"

#include <algorithm>
#include <cmath>

namespace hydrapod::control {

namespace {

/// Half the width of the ramp that stands for the jump over the overlap, share of full drive.
constexpr double overlap_ramp = 0.002;

double jump(const ControllerParameters& parameters, int leg) {
  return parameters.overlap_compensation * std::max(parameters.axes[leg].overlap, 0.0);
}

}  // namespace

AxisSpeeds conditioning_speeds(const ControllerParameters& parameters, int leg, double slow_force) {
  const auto& axis = parameters.axes[leg];
  const bool at_load = parameters.compensation == model::Compensation::load;
  const auto speeds = full_drive_speeds(axis, at_load ? slow_force : axis.load);
  if (parameters.compensation != model::Compensation::none) return speeds;
  const double mean = 0.5 * (speeds.extending + speeds.retracting);
  return {mean, mean};
}

ConditionedDrive condition(const ControllerParameters& parameters, int leg, double speed,
                           const AxisSpeeds& speeds) {
  const auto& output = parameters.output;
  double drive = speed / (speed > 0.0 ? speeds.extending : speeds.retracting);
  if (const double over = jump(parameters, leg); over > 0.0)
    drive += over * std::clamp(drive / overlap_ramp, -1.0, 1.0);
  drive = output.scale[leg] * drive + output.offset[leg];
  const bool limited = std::abs(drive) > output.limit;
  drive = std::clamp(drive, -output.limit, output.limit);
  if (output.resolution > 0.0)
    drive = output.resolution * std::nearbyint(drive / output.resolution);
  return {drive, limited};
}

double speed_of_drive(const ControllerParameters& parameters, int leg, double drive,
                      const AxisSpeeds& speeds) {
  const auto& output = parameters.output;
  if (output.scale[leg] == 0.0) return 0.0;
  const double jumped = (drive - output.offset[leg]) / output.scale[leg];
  const double over = jump(parameters, leg);
  const double plain = std::abs(jumped) < overlap_ramp + over
                           ? jumped / (1.0 + over / overlap_ramp)
                           : jumped - std::copysign(over, jumped);
  return plain * (plain > 0.0 ? speeds.extending : speeds.retracting);
}

double drive_per_speed(const ControllerParameters& parameters, int leg, double slow_force,
                       double drive) {
  const auto& output = parameters.output;
  const double scale = output.scale[leg];
  const double before_scale = scale != 0.0 ? (drive - output.offset[leg]) / scale : 0.0;
  const double over = jump(parameters, leg);
  const bool on_ramp = std::abs(before_scale) < overlap_ramp + over;
  const auto speeds = conditioning_speeds(parameters, leg, slow_force);
  return scale * (1.0 + (on_ramp ? over / overlap_ramp : 0.0)) /
         (before_scale > 0.0 ? speeds.extending : speeds.retracting);
}

}  // namespace hydrapod::control
