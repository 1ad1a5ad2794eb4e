#pragma once
/// What a measurement sees of a machine: its poles, and its responses to what excites it.
///
/// Linear about rest at a pose, δẋ = A δx + B δu, with A V = V Λ,
///
///     H(s) = C V (s − Λ)⁻¹ V⁻¹ B      motion of the mass centre per input
///
/// where the base gives way: against the base, as leg lengths show it, or against the ground. Of
/// which system (Observed):
///
/// - mechanics: legs on oil springs (linear_model.hpp), damped as the machine file says;
/// - plant: mechanics, oil and valves (simulation/linear_system.hpp), Coulomb friction left out.
///   Leakage past pistons and edges softens the oil at low frequencies, heavy dampers shift poles
///   that lie close together, and oil with air in it is as stiff as the pressure at rest makes it;
/// - system: the plant with its controller and delays around it.
///
/// What is observed of the plant or of the machine under control beside a point, to first order.
///
/// With A V = V Λ, W = V⁻¹ and a change dA of the state matrix, G = W dA V gives
///
///     dλ_k = G_kk,   dV = V X,   dW = −X W,   X_jk = G_jk / (λ_k − λ_j),   X_kk = 0
///
/// (perturbation theory of a simple eigenvalue; Wilkinson, The Algebraic Eigenvalue Problem, 1965,
/// chapter 2). Poles closer than 1e-5 |λ| count as one repeated pole. The basis of a repeated pole
/// is turned until its block of G is diagonal; X is zero within the block.
///
/// dA, dB and dC are central differences of the linear system. One decomposition serves all
/// parameters; differences of the poles need two for each.

#include <array>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/observation/targets.hpp"
#include "hydrapod/simulation/linear_system.hpp"

namespace hydrapod::observation {

/// A pole with a frequency.
struct ObservedMode {
  std::complex<double> pole{};  ///< λ [1/s], Im > 0
  Eigen::Index column{};        ///< of Observation::poles
  /// Motion of mechanics in its coordinates (linear_model.hpp), against the ground, scaled to
  /// φᴴ M φ = 1.
  Eigen::VectorXcd shape{};
  Vector6c against_base{Vector6c::Zero()};  ///< motion of the mass centre, in the same scale
  /// How much each input of the observed system moves it: the mode's part of H is
  /// motion() · input / (s − λ). Of the plant: valves. Of others: forces and moments about the mass
  /// centre, in units of the roots of the platform's mass and moments of inertia. Zero for
  /// undamped modes.
  Eigen::Matrix<std::complex<double>, 1, 6> input{
      Eigen::Matrix<std::complex<double>, 1, 6>::Zero()};
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
  Eigen::VectorXcd poles{};                                            ///< all
  Eigen::Matrix<std::complex<double>, 6, Eigen::Dynamic> to_base{};    ///< C V against the base
  Eigen::Matrix<std::complex<double>, 6, Eigen::Dynamic> to_ground{};  ///< the same of the ground
  /// V⁻¹ B of every Entry; of commands per displacement. Without columns: the system has no such
  /// input.
  std::array<Eigen::MatrixXcd, 3> inputs{};
  Eigen::MatrixXcd command_speed{};  ///< V⁻¹ B per speed of the command
  Eigen::MatrixXcd right{}, left{};  ///< V and V⁻¹, of plant and system

  /// H(s): 6 directions of the mass centre × 6 inputs; `window`: as an average over blocks shows
  /// it. Throws std::invalid_argument for an entry that the system does not have.
  [[nodiscard]] Eigen::Matrix<std::complex<double>, 6, 6> response(
      std::complex<double> s, Entry entry, MotionAgainst against = MotionAgainst::base,
      const LagWindow* window = nullptr) const;
};

/// `controller`: at work where the system is observed; none: as the machine's file has it. Throws
/// base::ComputationError where the machine cannot stand at `X_BP`, and base::InputError for what
/// the plant does not have.
Observation observe(const model::Machine& machine, const spatial::Pose& X_BP,
                    dynamics::ModelKind kind, Observed observed,
                    const control::ControllerParameters* controller = nullptr);

/// The undamped modes of mechanics in their order, λ = iω; 0 for modes that have buckled.
std::vector<ObservedMode> undamped_modes(const dynamics::LinearModel& model,
                                         const dynamics::NormalModes& modes);

/// The one of `modes`, of these mechanics, whose shape is most like it.
int nearest_mode(const dynamics::LinearModel& mechanics, const dynamics::NormalModes& modes,
                 const ObservedMode& mode);

/// "mechanics with oil springs", "mechanics, hydraulics and valves", "… and controller".
std::string_view description(Observed observed);

/// Does the system have that input?
bool can_enter(Observed observed, Entry entry);

/// The linear system behind an observation.
struct ObservedSystem {
  spatial::Pose X_BP{};
  spatial::Vector3 p_BC{};
  spatial::Matrix6 platform_mass{};  ///< about the mass centre
  simulation::LinearSystem linear{};
  /// Motion of the mass centre per state, against the ground less against the base; the latter is
  /// the first six states.
  Eigen::MatrixXd carried{};
};

/// `observed`: plant or system. Throws as observe() does.
ObservedSystem observed_system(const model::Machine& machine, const spatial::Pose& X_BP,
                               dynamics::ModelKind kind, Observed observed,
                               const control::ControllerParameters* controller = nullptr);

class Tangent {
 public:
  /// `below`, `above`: the systems of two values of a parameter that are `width` apart; `center`
  /// observes the plant or the system of the value in the middle.
  Tangent(const Observation& center, const ObservedSystem& below, const ObservedSystem& above,
          double width);

  /// What is observed `step` beside the centre: the same modes in the same order, their shapes
  /// without the legs' coordinates.
  [[nodiscard]] Observation at(double step) const;
  /// Was the basis of a repeated pole turned? Its modes are then others than those of the centre.
  [[nodiscard]] bool turned() const { return turned_; }

 private:
  Observation center_{}, change_{};
  bool turned_{};
};

}  // namespace hydrapod::observation
