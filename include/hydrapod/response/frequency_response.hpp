#pragma once
/// The 6×6 frequency response of the platform at a point Q fixed in it.
///
///     H(ω) = s(ω) · [platform rows of (K − ω² M + iω C)⁻¹ B],   s = 1, iω, −ω²
///
/// Chambers that relax (LinearModel::arms) take Σ κ λ/(iω + λ) s_y s_yᵀ off the dynamic stiffness.
/// An arm belongs to one leg, so the legs still meet only in the platform.
///
/// with the platform's coordinates taken at Q: motion of Q [m], rotation [rad], base axes. Inputs:
/// - wrench: force [N] and moment [N m] at Q;
/// - actuator: forces of the six oil columns, mapped to platform directions by J⁻ᵀ (J: extension
///   rates of the pistons per motion of Q), so that the six inputs are again forces and moments at
///   Q. For straight legs on a still base both are the same; bent legs (gravity) also push their
///   own seals, and all legs push a base that has coordinates back.
///
/// Motion is against the ground, on a base that moves too.
///
/// Modes of the payload (docs/theory/payload.md) couple to the platform alone. The elimination
/// takes them out of its 6×6 block as it does a leg.
///
/// Four exact ways to the same numbers:
/// - modes: H = Σ φφᵀ / (ω_k² − ω² + 2iζω_kω), where no viscous damper couples the modes;
/// - elimination: D = K − ω²M + iωC has one small flexible block per leg; those are eliminated
///   first, which leaves one 6×6 complex symmetric solve per frequency. Several frequencies go
///   through together, one per SIMD lane. No pivoting: where a pivot vanishes (an undamped leg
///   exactly at its own resonance) the frequency is done again by the dense way;
/// - whole: the same elimination without regard to legs, for modal ratios together with viscous
///   dampers, and for viscous dampers on a base with coordinates: both couple the legs. Frequencies
///   at which a pivot comes near zero are done again by the dense way;
/// - dense: LU with pivoting, to check the others.
///
/// Resonance peaks of the direct responses H_dd (force in a direction, motion in the same
/// direction).
///
/// |H_dd| is sampled on a grid that is fine around every mode, so that no peak falls between two
/// points; every local maximum is refined, and its prominence is its height above the higher of the
/// two valleys that part it from higher ground [dB]. Ripples below `min_prominence_db` are not
/// resonances.
///
/// A model without any damping has unbounded peaks, one at every mode that takes part in a
/// direction; magnitude and prominence are then infinite.
///
/// The mode behind a peak is, of the modes within a few bandwidths of it, the one with the largest
/// term in the modal sum of H_dd; if there is none so near, the nearest mode. "The x direction has
/// two resonances" counts a direction's own peaks: x and ry are coupled wherever the mass centre is
/// not in the joints' plane, and the ry response then shows the x mode as well.

#include <complex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hydrapod/dynamics/linear_model.hpp"

namespace hydrapod::response {

using Complex = std::complex<double>;
using Matrix6c = Eigen::Matrix<Complex, 6, 6>;
using dynamics::LinearModel;
using dynamics::ModelMatrix;
using dynamics::NormalModes;
using spatial::Vector3;

enum class Input { wrench, actuator };
enum class Output { displacement, velocity, acceleration };
enum class Method { modes, elimination, whole, dense };

/// A linear model with its platform coordinates moved to Q, ready to be swept.
struct ResponseModel {
  dynamics::ModelKind kind{};
  int base_count{};  ///< coordinates of the base, behind those of the legs
  Vector3 p_BQ{};    ///< the point [m] in B
  ModelMatrix M{}, K{}, C{};
  ModelMatrix loads{};                        ///< B (dof×6): generalised forces per input
  bool loads_flexible{};                      ///< some input acts on more than the platform
  NormalModes modes{};                        ///< in the coordinates at Q
  std::vector<dynamics::RelaxingArm> arms{};  ///< those with a rate; at Q
  double modal_ratio{};                       ///< ζ of every mode, on top of C
  int payload_count{};                        ///< coordinates of the payload's modes, the last
  std::vector<int> mode_direction{};  ///< per mode, 0…5: where most of its platform energy is
};

/// `p_PQ`: the point in P [m]. Throws std::invalid_argument for Input::actuator at a singular pose.
ResponseModel response_model(const LinearModel& model, const NormalModes& modes, double modal_ratio,
                             const Vector3& p_PQ, Input input = Input::wrench);

/// The whole damping matrix in the coordinates of `model`: C + M Φ diag(2 ζ ω) Φᵀ M.
ModelMatrix damping_matrix(const ResponseModel& model);

/// The cheapest exact method for `model`.
Method best_method(const ResponseModel& model);

/// H at every ω [rad/s] of `omega`, rows: output direction, columns: input direction. Not finite
/// where the model is undamped and ω is exactly one of its frequencies.
std::vector<Matrix6c> frequency_response(const ResponseModel& model, std::span<const double> omega,
                                         Output output = Output::displacement,
                                         std::optional<Method> method = {});

/// `points` values from `from` to `to`, evenly spaced on a logarithmic axis, both ends included.
std::vector<double> log_space(double from, double to, int points);

struct Peak {
  int direction{};         ///< 0…5: x y z rx ry rz
  double omega{};          ///< [rad/s]
  double magnitude{};      ///< |H_dd| there, [m/N] or [rad/(N m)] times s^k of the output
  double prominence_db{};  ///< infinite for the highest peak of the band
  int mode{};              ///< index of the mode behind the peak, see below
  bool own{};  ///< that mode moves the platform mainly in this direction; else it is a mode of
               ///< another direction that this one is coupled to
};

struct PeakOptions {
  double from{};  ///< [rad/s] > 0
  double to{};    ///< [rad/s]
  Output output{Output::displacement};
  double min_prominence_db{3.0};
};

/// Number of a direction's own resonances in `peaks`.
int count_own(const std::vector<Peak>& peaks, int direction);

/// Peaks of all six direct responses, by direction and ascending in frequency.
std::vector<Peak> find_peaks(const ResponseModel& model, const PeakOptions& options);

/// A peak of values at ascending lines.
struct LinePeak {
  std::size_t line{};
  double prominence_db{};  ///< as in Peak
};

/// Peaks of `magnitude` at least this prominent, ascending.
std::vector<LinePeak> line_peaks(const std::vector<double>& magnitude, double min_prominence_db);

/// Index of the mode behind a peak at `omega` [rad/s] of the response of `output` to `input`, 0…5:
/// of the modes near it the one with the largest term of the modal sum, else the nearest one.
int mode_behind(const ResponseModel& model, double omega, int output, int input);

}  // namespace hydrapod::response
