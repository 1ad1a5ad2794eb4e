#pragma once
/// Sensors with their faults: noise, range, resolution.

#include "hydrapod/control/controller.hpp"
#include "hydrapod/numerics/gaussian.hpp"

namespace hydrapod::simulation {

/// What one sensor shows of `value`; `noise` is a normally distributed number.
double shown(const model::Sensor& sensor, double value, double noise);

/// The sensors that a controller reads. The same seed gives the same noise.
class SensorBank {
 public:
  SensorBank(const model::Sensors& sensors, std::uint64_t seed);
  [[nodiscard]] control::Measurement read(const control::Measurement& truth);

 private:
  model::Sensors sensors_;
  numerics::Gaussian random_;
};

}  // namespace hydrapod::simulation
