#pragma once
/// A random machine on soft oil springs, let go far from rest and moving: energy and kinematics on
/// its way.

#include "hydrapod/simulation/closed_loop.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {

struct FlightResult {
  double first_energy{};          ///< kinetic energy at the start [J]: the scale of all errors
  double energy_drift{};          ///< largest |E − E_0| / first_energy
  double kinematic_error{};       ///< largest of leg lengths and of forward kinematics' pose [m]
  double largest_swing{};         ///< of the mass centre from the start [m]
  double lost{};                  ///< E_0 − E at the end [J]
  double dissipated{};            ///< ∫ power dt by Simpson's rule [J]
  double smallest_dissipation{};  ///< [W]
};

class FreeFlight {
 public:
  FreeFlight(model::FlexibleAxes axes, dynamics::ModelKind kind);

  /// Gives seals, joints and oil springs dampers, and adds Rayleigh damping.
  void damp();

  /// Gives the joints bristles that stick and slide.
  void stick();

  /// Looks at the state every `interval` [s].
  [[nodiscard]] FlightResult run(double seconds, const simulation::IntegratorOptions& options,
                                 double interval = 1e-3) const;

 private:
  model::Machine machine_{};
  dynamics::ModelKind kind_;
  spatial::Vector6 velocity_{};
};

}  // namespace hydrapod::test
