#pragma once
/// Parameters of a controller, every leg different, and a machine for it.

#include "hydrapod/control/controller.hpp"
#include "support/published_machine.hpp"

namespace hydrapod::test {

inline control::ControllerParameters example_parameters() {
  control::ControllerParameters parameters;
  parameters.gain = (spatial::Vector6() << 11.3, 12.7, 14.1, 9.2, 8.7, 10.9).finished();
  parameters.integral_time = 0.73;
  parameters.velocity_feedforward = 0.87;
  parameters.feedback = model::DampingFeedback::pressure;
  parameters.feedback_corner = 4.3;
  parameters.sample_time = 1.7e-3;
  parameters.output.resolution = 0.0;
  for (int i = 0; i < 6; ++i) {
    parameters.feedback_gain[i] = (7.1 + i) * 1e-7;
    auto& axis = parameters.axes[i];
    axis = {.piston_area = 2.1e-3 + 7e-5 * i,
            .annulus_area = 1.3e-3 - 3e-5 * i,
            .flow_coefficient = (2.9 + 0.1 * i) * 1e-7,
            .supply_pressure = 13.7e6,
            .return_pressure = 0.6e6,
            .overlap = 0.0,
            .load = 1200.0 + 310.0 * i};
  }
  return parameters;
}

/// What sensors without errors show at `X_BP` with the example's loads.
inline control::Measurement exact_measurement(const model::Machine& machine,
                                              const control::ControllerParameters& parameters,
                                              const spatial::Pose& X_BP) {
  control::Measurement measured;
  measured.length = kinematics::leg_lengths(machine, X_BP);
  for (int i = 0; i < 6; ++i) {
    const auto& axis = parameters.axes[i];
    measured.rod_pressure[i] = 3.1e6 + 1e5 * i;
    measured.cap_pressure[i] =
        (axis.load + measured.rod_pressure[i] * axis.annulus_area) / axis.piston_area;
  }
  return measured;
}

}  // namespace hydrapod::test
