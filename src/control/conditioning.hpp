#pragma once
/// Signal conditioning of one leg: wanted speed to drive. Private to the module.

#include "hydrapod/control/controller.hpp"

namespace hydrapod::control {

/// Speeds at full drive by which drives are corrected, under the slow load force [N].
AxisSpeeds conditioning_speeds(const ControllerParameters& parameters, int leg, double slow_force);

/// ∂(ln v)/∂F [1/N] of the speed at full drive under the load F; 0 where that is held at its least.
double log_speed_per_load(const DriveAxis& axis, double load, bool extending);

struct ConditionedDrive {
  double value{};  ///< share of the rated one, what the converter gives
  bool limited{};
};

/// The drive for the wanted speed `speed` [m/s], with the speeds of conditioning_speeds.
ConditionedDrive condition(const ControllerParameters& parameters, int leg, double speed,
                           const AxisSpeeds& speeds);

/// The wanted speed [m/s] that is conditioned to `drive`; limit and rounding left out.
double speed_of_drive(const ControllerParameters& parameters, int leg, double drive,
                      const AxisSpeeds& speeds);

/// ∂drive/∂speed [s/m] where the drive is `drive`; limit and rounding left out.
double drive_per_speed(const ControllerParameters& parameters, int leg, double slow_force,
                       double drive);

}  // namespace hydrapod::control
