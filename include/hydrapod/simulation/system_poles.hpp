#pragma once
/// Poles of a linear system, what takes part in them, and whether it is stable.
///
/// Participation of state k in the pole λ with right and left eigenvectors v, w (wᵀ v = 1) is
/// |w_k v_k|, brought to the sum 1: it does not depend on units. In equal poles (a symmetric
/// machine has x with y, rx with ry) any mix of vectors is one; there |P_kk| of the projector P = Σ
/// v wᵀ over the group is used, which does not depend on the mix.

#include <array>
#include <complex>

#include "hydrapod/simulation/linear_system.hpp"

namespace hydrapod::simulation {

struct SystemPole {
  std::complex<double> pole{};                  ///< λ [1/s], Im ≥ 0: one of each conjugate pair
  double omega{};                               ///< |λ| [rad/s]
  double damping_ratio{};                       ///< −Re λ / |λ|, 1 for real stable poles
  int group{};                                  ///< same number for equal poles
  std::array<double, part_count> parts{};       ///< participation by Part, sum 1
  std::array<double, model::leg_count> legs{};  ///< of seals, oil and valves by leg
  /// C v: how P's origin moves against the base in it, any scale. Equal poles: together they span
  /// the motion.
  Eigen::Matrix<std::complex<double>, 6, 1> motion{
      Eigen::Matrix<std::complex<double>, 6, 1>::Zero()};
  /// C_ground v: the same against the ground.
  Eigen::Matrix<std::complex<double>, 6, 1> ground_motion{
      Eigen::Matrix<std::complex<double>, 6, 1>::Zero()};
  [[nodiscard]] bool oscillates() const { return pole.imag() > 0.0; }
};

struct SystemPoles {
  std::vector<SystemPole> poles{};  ///< least damped in time first: by Re λ, descending
  bool stable{};                    ///< all Re λ < 0
  double largest_real{};            ///< max Re λ [1/s]
  /// Of the sampled loop: exact. Equal to 1 in growth is the limit.
  std::vector<std::complex<double>> sampled{};  ///< s = ln(z)/T [1/s], Im ≥ 0, by Re, descending
  double largest_modulus{};                     ///< max |z|
  bool sampled_stable{};                        ///< max |z| < 1
};

SystemPoles system_poles(const LinearSystem& system);

/// H(iω) from the commanded displacement (with its velocity, fed forward) to the platform's.
/// 6×6, at `omega` [rad/s].
Eigen::Matrix<std::complex<double>, 6, 6> command_response(const LinearSystem& system,
                                                           double omega);

}  // namespace hydrapod::simulation
