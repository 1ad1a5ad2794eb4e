#pragma once
/// Damping of a model and its damped modes.
///
/// C = C_legs + α M + β K + M Φ diag(2 ζ ω) Φᵀ M: the legs' viscous dampers and Rayleigh damping
/// (both already in LinearModel::C) and a ratio ζ for every undamped mode. In the coordinates of
/// the undamped modes, y = Φ z, this reads z̈ + Γ ż + Ω² z = 0 with Γ = Φᵀ C Φ. Where Γ is diagonal
/// the modes are real; else they are complex, the eigenvectors of [0 I; −Ω² −Γ].
///
/// Damped modes come as pairs of poles λ = −ζω ± iω√(1 − ζ²): ω = |λ|, ζ = −Re λ/|λ|. An overdamped
/// mode has two real poles; the two whose shapes match best are reported as one mode with ζ > 1.
///
/// Chambers that relax (LinearModel::arms) add a state and a real pole each: pressures that even
/// out, and a platform that drifts while the valves leak. These poles are no modes and are left
/// out: the real ones in which the arms have the largest share.
///
/// How undamped modes move with a parameter p of the model: (K − ω² M) φ = 0, φᵀ M φ = 1.
///
/// With dM, dK the model's derivatives and λ = ω²,
///
///     dλ = φᵀ (dK − λ dM) φ
///     dφ = Σ_k φ_k [φ_kᵀ (dK − λ dM) φ] / (λ − λ_k) − ½ φ (φᵀ dM φ),   λ_k ≠ λ
///
/// exact, since all modes are known. A group of repeated λ has no derivative mode by mode: along a
/// direction in parameter space its λ split as the eigenvalues of the small symmetric matrix
/// G = Φᵀ (dK − λ dM) Φ of that direction. The basis Φ of a group is therefore turned once so that
/// it diagonalises the parameter that splits the group most; if nothing splits it, every basis is
/// right and the one of the modes stays.
///
/// Sources: Fox & Kapoor, AIAA J. 6 (1968) 2426; for repeated values Lancaster, Numer. Math. 6
/// (1964) 377.

#include <Eigen/Core>
#include <complex>
#include <span>
#include <vector>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/numerics/parallel.hpp"

namespace hydrapod::modal {

using model::default_modal_ratio;
using model::modal_ratio;
using model::ModalRatio;

struct DampedMode {
  std::complex<double> pole{};  ///< λ [1/s], the one with Im ≥ 0; for ζ > 1 the slower one
  double omega{};               ///< |λ| [rad/s], 0 when unstable without oscillation
  double damping_ratio{};       ///< ζ
  bool stable{true};
  ModelVector real{};       ///< shape; for real modes the whole of it, φᵀ M φ = 1
  ModelVector imaginary{};  ///< zero for real modes; together φᴴ M φ = 1
  int group{};              ///< same number for modes that repeat
  [[nodiscard]] bool is_complex() const { return !imaginary.isZero(0.0); }
};

/// Damped modes, ascending in ω. `ratio`: ζ given to every mode on top of the model's C.
std::vector<DampedMode> damped_modes(const LinearModel& model, const NormalModes& modes,
                                     double ratio);

/// For every undamped mode the number of the damped one that it is, by their shapes, a damped mode
/// once; −1: none is left, since modes that do not oscillate are fewer.
std::vector<int> damped_counterparts(const LinearModel& model, const NormalModes& modes,
                                     const std::vector<DampedMode>& damped);

/// normal_modes(); where the machine has seals that are elastomers, each with the ω of its damped
/// counterpart, whose seals are as stiff as at its frequency. Modes that do not oscillate keep
/// theirs. `model`: of `machine`.
NormalModes modes_with_elastomers(const model::Machine& machine, const LinearModel& model);

/// Γ = Φᵀ C Φ + diag(2 ζ ω).
ModelMatrix modal_damping_matrix(const LinearModel& model, const NormalModes& modes, double ratio);

using dynamics::LinearModel;
using dynamics::ModelMatrix;
using dynamics::ModelVector;
using dynamics::NormalModes;

/// Change of a model per change of a parameter. Not on the stack: there are many at a time.
struct ModelDerivative {
  Eigen::MatrixXd M{}, K{}, C{};
  /// Arms of the model by `step` above and below, where it has any: those of a leg can trade
  /// places, and only their sums have derivatives.
  std::vector<dynamics::RelaxingArm> arms_above{}, arms_below{};
  double step{};
};

/// φᵀ C φ of the dampers that the arms are at the frequency ω.
double relaxed_damping(std::span<const dynamics::RelaxingArm> arms, const ModelVector& phi,
                       double omega);

/// G of the group of `size` modes from `first` on [rad²/s² per unit of the parameter].
ModelMatrix group_derivative(const NormalModes& modes, int first, int size,
                             const ModelDerivative& derivative);

/// Turns the basis of every group of repeated modes to the one in which its modes part along the
/// parameter that splits it most, the lowest first. `scales`: how much of each parameter counts as
/// equally much.
void turn_repeated(NormalModes& modes, std::span<const ModelDerivative> derivatives,
                   const Eigen::VectorXd& scales);

/// dω²/dp: a row per mode, a column per parameter. In a group of repeated modes these are the
/// diagonals of G in the basis of the group (see turn_repeated).
Eigen::MatrixXd omega2_derivatives(const NormalModes& modes,
                                   std::span<const ModelDerivative> derivatives);

/// Modes whose ω² differs from that of mode k by no more than the share `together` of it; those of
/// its group always.
std::vector<int> neighbours(const NormalModes& modes, int k, double together = 0.0);

/// dφ/dp of mode k, a column per parameter; what turns its neighbours and it into each other is
/// left out.
Eigen::MatrixXd shape_derivatives(const NormalModes& modes, int k,
                                  std::span<const ModelDerivative> derivatives,
                                  double together = 0.0);

/// Modes at given amplitudes: what guide rings, elastomers and friction make of them
/// (docs/theory/amplitude.md).
///
/// The platform swings in one mode at a time. Every leg's guide sleeve, piston ring, piston and
/// joints then have amplitudes, for which harmonic balance gives springs and dampers. The balance
/// (K(y, ω) − ω² M) y = 0 of the motion y is a curve in (y, ω), the branch of the mode. It is
/// followed along its arc from small motions on, so that it may turn back in amplitude.
struct AmplitudeOptions {
  /// |change of ω| ≤ tolerance · ω and |change of y| ≤ √tolerance · |y| end Newton's iteration, |y|
  /// in the metric of M. It converges quadratically: half of the digits of y are enough for all of
  /// ω.
  double tolerance{1e-10};
  int most_iterations{12};  ///< of Newton's method in a step; more: a shorter step is tried
  /// Length of a step, √(|change of y|²/|y|² + (change of ω/ω)²), at most: a guide ring that is met
  /// makes the sleeves many times stiffer.
  double longest_step{0.4};
  /// Below it no step is tried, and the branch ends. At the edge of a gap the stiffness turns
  /// within a tenth of the gap, at pistons that slide within a bend of the bristles.
  double shortest_step{1e-6};
  int most_steps{2000};  ///< per branch; those of the shipped machines take some hundred
  /// Cosine of the angle between the directions of the branch at both ends of a step <
  /// least_cosine: a shorter step is tried.
  double least_cosine{0.9};
  /// Distance of a step from the arc between both directions > largest_kink times its length: a
  /// shorter step is tried. On a branch the distance falls with the square of the length; beside
  /// another branch, to which the step would lead, it does not.
  double largest_kink{0.1};
  /// The branch is followed up to this multiple of the last amplitude, to see whether it comes
  /// back.
  double beyond{1.5};
  /// Modes with less of their kinetic energy in the platform are left out, and branches end there:
  /// its amplitude says little of them.
  double least_platform{0.05};
};

struct ModeAtAmplitude {
  double amplitude{};  ///< [m] of the platform joint that moves most
  double omega{};      ///< [rad/s]
  double damping_ratio{};
  double mac{};         ///< with the linear mode, in the metric of M
  double sleeve{};      ///< largest amplitude at a guide sleeve [m]
  double piston{};      ///< largest amplitude of a piston along its leg [m]
  int legs_on_guide{};  ///< whose rods touch the guide ring in the period
  int turns{};          ///< how often the branch has turned back in amplitude before
  bool converged{};     ///< false: the branch has no solution at this amplitude
  ModelVector shape{};  ///< φᵀ M φ = 1; empty where it did not converge
};

/// Where a branch ends.
enum class BranchEnd {
  beyond,     ///< behind all amplitudes
  turned,     ///< it turned back and left the amplitudes where it had come from
  local,      ///< the platform hardly moves any more (AmplitudeOptions::least_platform)
  stopped,    ///< the shortest step finds no balance
  most_steps  ///< it is longer than AmplitudeOptions::most_steps
};

/// The branch of one mode.
struct AmplitudeCurve {
  int mode{};       ///< index into NormalModes of the linear model
  int direction{};  ///< 0…5, in which the platform moves most
  /// Where the branch begins: at a thousandth of the first amplitude, or at long swings. 0: there
  /// is no balance.
  double omega{};
  /// It is followed from long swings down, on which the rods lie on their guides nearly all the
  /// time.
  bool from_long_swings{};
  /// One per amplitude, the first that the branch comes to.
  std::vector<ModeAtAmplitude> points{};
  /// The others at these amplitudes, where the branch passes them several times, in its order.
  std::vector<ModeAtAmplitude> further{};
  /// Where the branch turns back: the amplitude has an extremum.
  std::vector<ModeAtAmplitude> turning{};
  BranchEnd end{};
  ModeAtAmplitude last{};  ///< at the end of the branch
};

/// Of every mode that moves the platform (least_platform); then the branches from long swings of
/// those modes whose branch from small motions does not get behind all amplitudes. `amplitudes` [m]
/// > 0, ascending. Throws as linear_model() does, std::invalid_argument for amplitudes that do not
/// ascend, and base::ComputationError where progress stops.
std::vector<AmplitudeCurve> modes_at_amplitudes(const model::Machine& machine,
                                                const spatial::Pose& X_BP, dynamics::ModelKind kind,
                                                std::span<const double> amplitudes,
                                                const AmplitudeOptions& options = {},
                                                const numerics::Progress& progress = {});

/// A motion y of any size to begin with, and the amplitude [m] > 0 that it is to have.
struct SwingStart {
  double amplitude{};
  ModelVector shape{};
};

/// The balances at these amplitudes that are like the shapes, by Newton's method from these, or
/// from small motions on in steps of the amplitude; much faster than branches, and with one
/// solution where a branch has several. ModeAtAmplitude::mac is with the shape; `converged` is
/// false where no balance is found so. Throws as linear_model() does.
std::vector<ModeAtAmplitude> balances_at(const model::Machine& machine, const spatial::Pose& X_BP,
                                         dynamics::ModelKind kind,
                                         std::span<const SwingStart> starts);

}  // namespace hydrapod::modal
