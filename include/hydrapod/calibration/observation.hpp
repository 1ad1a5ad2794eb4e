#pragma once
/// What a measurement from the drives of the valves on sees of a machine: poles of mechanics, oil
/// and valves together.
///
/// The plant (simulation/plant.hpp) at rest at a pose, Coulomb friction left out, linear:
/// δẋ = A δx + B δu. With A V = V Λ,
///
///     H(s) = C V (s − Λ)⁻¹ V⁻¹ B      motion of the mass centre per command of the valves
///
/// where the base gives way: against the base, as leg lengths show it, or against the ground.
///
/// Undamped modes of mechanics on oil springs (linear_model.hpp) lie elsewhere: leakage past
/// pistons and edges softens the oil at low frequencies, heavy dampers shift poles that lie close
/// together, and oil with air in it is as stiff as the pressure at rest makes it.

#include "hydrapod/calibration/targets.hpp"
#include "hydrapod/dynamics/linear_model.hpp"

namespace hydrapod::calibration {

/// A pole with a frequency.
struct ObservedMode {
  std::complex<double> pole{};  ///< λ [1/s], Im > 0
  /// Motion of mechanics in its coordinates (linear_model.hpp), against the ground, scaled to
  /// φᴴ M φ = 1.
  Eigen::VectorXcd shape{};
  Vector6c against_base{Vector6c::Zero()};  ///< motion of the mass centre, in the same scale
  /// How much each valve moves it: the mode's part of H is motion() · input / (s − λ).
  Eigen::Matrix<std::complex<double>, 1, 6> input{};
  [[nodiscard]] double omega() const { return std::abs(pole); }
  [[nodiscard]] double damping_ratio() const { return -pole.real() / std::abs(pole); }
  /// Of the mass centre.
  [[nodiscard]] Vector6c motion(MotionAgainst against = MotionAgainst::ground) const {
    return against == MotionAgainst::base ? against_base : Vector6c(shape.head<6>());
  }
};

struct Observation {
  dynamics::LinearModel mechanics{};
  std::vector<ObservedMode> modes{};  ///< ascending in ω

  // The modal form of H.
  Eigen::VectorXcd poles{};                                         ///< all
  Eigen::Matrix<std::complex<double>, 6, Eigen::Dynamic> output{};  ///< C V against the base
  Eigen::Matrix<std::complex<double>, Eigen::Dynamic, 6> input{};   ///< V⁻¹ B

  Eigen::Matrix<std::complex<double>, 6, Eigen::Dynamic> to_ground{};  ///< C V against the ground

  /// H(s): 6 directions of the mass centre × 6 valves.
  [[nodiscard]] Eigen::Matrix<std::complex<double>, 6, 6> response(
      std::complex<double> s, MotionAgainst against = MotionAgainst::base) const;
};

/// Throws base::ComputationError where the machine cannot stand at `X_BP`, and base::InputError
/// for what the plant does not have.
Observation observe_plant(const model::Machine& machine, const spatial::Pose& X_BP,
                          dynamics::ModelKind kind);

}  // namespace hydrapod::calibration
