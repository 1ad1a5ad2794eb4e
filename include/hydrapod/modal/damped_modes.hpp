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
/// The platform swings in one mode at a time. Every leg's guide sleeve, piston ring and piston then
/// have amplitudes, for which harmonic balance gives a spring and a damper.
/// With these the mode is computed anew, until nothing changes any more.
struct AmplitudeOptions {
  /// |change of ω| ≤ tolerance · ω and |change of φ| ≤ √tolerance end the iteration.
  double tolerance{1e-10};
  int most_iterations{300};
  /// From one amplitude to the next in steps of this ratio: a guide ring that is met makes the
  /// sleeves many times stiffer.
  double largest_ratio{1.5};
  /// Modes with less of their kinetic energy in the platform are left out: its amplitude says
  /// little of them.
  double least_platform{0.05};
  /// MAC with the mode a step before < least_mac: shorter steps are tried, then the mode is lost,
  /// and no number is given.
  double least_mac{0.8};
};

struct ModeAtAmplitude {
  double amplitude{};  ///< [m] of the platform joint that moves most
  double omega{};      ///< [rad/s]
  double damping_ratio{};
  double mac{};         ///< with the linear mode, in the metric of M
  double sleeve{};      ///< largest amplitude at a guide sleeve [m]
  double piston{};      ///< largest amplitude of a piston along its leg [m]
  int legs_on_guide{};  ///< whose rods touch the guide ring in the period
  bool converged{};
  ModelVector shape{};  ///< φᵀ M φ = 1; empty where it did not converge
};

/// The curves of one mode over the amplitudes.
struct AmplitudeCurve {
  int mode{};       ///< index into NormalModes of the linear model
  int direction{};  ///< 0…5, in which the platform moves most
  double omega{};   ///< of motions a thousandth of the first amplitude; 0: there is no balance
  std::vector<ModeAtAmplitude> points{};  ///< one per amplitude
};

/// Of every mode that moves the platform (least_platform). `amplitudes` [m] > 0, ascending. Throws
/// as linear_model() does, and std::invalid_argument for amplitudes that do not ascend.
std::vector<AmplitudeCurve> modes_at_amplitudes(const model::Machine& machine,
                                                const spatial::Pose& X_BP, dynamics::ModelKind kind,
                                                std::span<const double> amplitudes,
                                                const AmplitudeOptions& options = {});

}  // namespace hydrapod::modal
