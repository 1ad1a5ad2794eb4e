#pragma once
/// Modes of the payload in the nonlinear mechanics; derivation: docs/theory/payload.md. Letters: L
/// participation about C, l and h its halves, a = Σ l ξ, all in base axes; g_0 gravity in P at the
/// reference pose.
///
///     T = ½ m v² + v·ȧ + ½ ω·Iω + Σ ξ̇ h·ω + ½ Σ ξ̇²
///     V = Σ ½ ω_k² ξ² − Σ ξ l·(g − R g_0) − m g·p_C
///
/// gives, beside the equations of a rigid platform,
///
///     ξ̈ = −Lᵀ (v̇; ω̇) − s,   s = ω_k² ξ + 2 ζ_k ω_k ξ̇ − l·(g − R g_0)
///     m v̇ + Σ l ξ̈ + ω̇ × a + 2 ω × Σ l ξ̇ + ω × (ω × a) = F
///     I ω̇ + a × v̇ + Σ h ξ̈ + ω × Iω + ω × Σ h ξ̇ = M + a × g
///
/// into which the first is put.

#include "hydrapod/dynamics/nonlinear.hpp"

namespace hydrapod::dynamics {

struct PayloadConstants {
  int count{};
  Matrix6 L;        ///< a column per mode, axes of P
  Vector6 omega2;   ///< ω_k²
  Vector6 damping;  ///< 2 ζ_k ω_k
  Vector3 weight;   ///< g_0

  PayloadConstants() = default;
  PayloadConstants(const model::Machine& machine, const Vector3& weight_at_rest);
  /// ξ where the platform rests with gravity `g_P` in P.
  [[nodiscard]] Vector6 at_rest(const Vector3& g_P) const;
};

/// Static equilibrium at `X_BP`. Away from the reference orientation the payload hangs otherwise,
/// and its weight acts elsewhere.
StaticEquilibrium rest_with_payload(const model::Machine& machine, const spatial::Pose& X_BP,
                                    ModelKind kind, const PayloadConstants& payload,
                                    const StaticsOptions& options = {});

/// All of this is set with `count` above 0 only, so that machines without do not pay for it.
struct PayloadInMotion {
  using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6>;
  using Modes = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;

  int count{};
  Columns L{};      ///< base axes
  Modes pull{};     ///< s
  Vector3 offset;   ///< a
  Vector6 rates;    ///< Σ L ξ̇
  Vector6 inertia;  ///< what acts on the platform by velocities and displaced weight

  PayloadInMotion(const PayloadConstants& payload, const Motion& motion, const Vector3& gravity);
  /// Σ ξ̈ out of the platform's equations M (v̇; ω̇) = force; the lower half of M is meant.
  void eliminate(Matrix6& M, Vector6& force) const;
  /// ξ̈ to where `to` points.
  void accelerations(const Vector6& platform, double* to) const;
  /// The platform's mass matrix gets what a displaced mass adds to it, and ξ its rows and columns,
  /// which begin at `first`.
  void add_mass(Eigen::MatrixXd& M, Eigen::Index first) const;
};

/// Of T and V above what a rigid platform does not have, and 2 ζ ω ξ̇² [W].
void add_payload_energies(const PayloadConstants& payload, const Motion& motion,
                          const Vector3& gravity, Energies& energies);
double payload_dissipation(const PayloadConstants& payload, const Motion& motion);

}  // namespace hydrapod::dynamics
