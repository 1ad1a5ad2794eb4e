#pragma once
/// Electric drives: motor, screw, nut and speed loop of each leg (docs/theory/actuators.md,
/// "Drives"). Private to the module.
///
/// Of a leg, with the way of its nut s_n [m], θ̇ = (2π/p) ṡ_n and the command u in [−1, 1]:
///
///     T = sat(k_p (u ω_max − θ̇) + T_i, ±T_max),      t_i Ṫ_i = T − T_i
///     m_r s̈_n = (2π/p) (T − b θ̇ − T_f tanh(ṡ_n/v_0)) − F
///     F = k (s_n + F_0/k_j − s) + c (ṡ_n − ṡ)
///
/// Within the limit the first line is a proportional and integral controller of the speed, k_p (e +
/// ∫e dt/t_i); beyond it the integral part T_i tends to the limit in the time t_i, and no further.
/// The current loop is taken as immediate. k and c are hydraulics::axial_spring: with compliant
/// gimbals in series, whose force at rest is F_0 (Plant::Gimbals).

#include <array>

#include "hydrapod/simulation/plant.hpp"

namespace hydrapod::simulation {

struct Drive {
  double ratio{};          ///< 2π/p [rad/m]
  double mass{};           ///< m_r [kg]
  double viscous{};        ///< b [N m s/rad]
  double coulomb{};        ///< T_f [N m]
  double smoothing{};      ///< v_0 [m/s]
  double torque_limit{};   ///< T_max [N m]
  double speed_limit{};    ///< ω_max [rad/s]
  double gain{};           ///< k_p [N m s/rad]
  double integral_rate{};  ///< 1/t_i [1/s]

  /// T [N m] while the nut moves at `rate` [m/s].
  [[nodiscard]] double torque(double command, double rate, double integral) const;
  /// b θ̇ + T_f tanh(ṡ_n/v_0) [N m].
  [[nodiscard]] double friction(double rate) const;
};

/// Throws base::InputError where the motor has no largest torque or no largest speed.
Drive drive_of(const model::Leg& leg);

struct Drives {
  std::array<Drive, model::leg_count> legs{};
};

}  // namespace hydrapod::simulation
