#pragma once
/// The 6×6 frequency response of the platform at a point Q fixed in it.
///
///     H(ω) = s(ω) · [platform rows of (K − ω² M + iω C)⁻¹ B],   s = 1, iω, −ω²
///
/// with the platform's coordinates taken at Q: motion of Q [m], rotation [rad], base axes. Inputs:
/// - wrench: force [N] and moment [N m] at Q;
/// - actuator: forces of the six oil columns, mapped to platform directions by J⁻ᵀ (J: extension
///   rates of the pistons per motion of Q), so that the six inputs are again forces and moments at
///   Q. For straight legs both are the same; bent legs (gravity) also push their own knees.
///
/// Three exact ways to the same numbers:
/// - modes: H = Σ φφᵀ / (ω_k² − ω² + 2iζω_kω), where no viscous damper couples the modes;
/// - elimination: D = K − ω²M + iωC has one small flexible block per leg; those are eliminated
///   first, which leaves one 6×6 complex symmetric solve per frequency. Several frequencies go
///   through together, one per SIMD lane. No pivoting: where a pivot vanishes (an undamped leg
///   exactly at its own resonance) the frequency is done again by the dense way;
/// - dense: LU with pivoting, for modal ratios together with viscous dampers, and to check the
///   others.

#include <complex>
#include <optional>
#include <span>
#include <vector>

#include "hydrapod/dynamics/normal_modes.hpp"

namespace hydrapod::response {

using Complex = std::complex<double>;
using Matrix6c = Eigen::Matrix<Complex, 6, 6>;
using dynamics::LinearModel;
using dynamics::ModelMatrix;
using dynamics::NormalModes;
using spatial::Vector3;

enum class Input { wrench, actuator };
enum class Output { displacement, velocity, acceleration };
enum class Method { modes, elimination, dense };

/// A linear model with its platform coordinates moved to Q, ready to be swept.
struct ResponseModel {
  dynamics::ModelKind kind{};
  Vector3 p_BQ{};  ///< the point [m] in B
  ModelMatrix M{}, K{}, C{};
  ModelMatrix loads{};                ///< B (dof×6): generalised forces per input
  bool loads_flexible{};              ///< some input acts on flexible coordinates
  NormalModes modes{};                ///< in the coordinates at Q
  double modal_ratio{};               ///< ζ of every mode, on top of C
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

}  // namespace hydrapod::response
