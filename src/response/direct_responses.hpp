#pragma once
/// The six direct responses H_dd of the platform alone (force in a direction, motion in the same
/// one), as a sum over the damped modes. A line takes one division per mode.
///
///     H_dd(ω) = Σ_k p_dk² / (g_k (iω − λ_k)) + the same of the conjugate poles
///     Q(λ_k) y_k = 0,   Q(s) = s² M + s C + K,   g_k = y_kᵀ (2 λ_k M + C) y_k,
///
/// p_k being the platform's part of the shape y_k, and C having all damping in it.
///
/// An eigensolver knows λ and y to some epsilons of the largest frequency. On a resonance with the
/// damping ratio ζ the response shows 1/ζ times the error of λ. Both are therefore corrected:
/// - Modes whose |λ| follow each other within a thousandth are a group. Repeated modes are in one.
///   The shapes of a group turn Q into a small complex symmetric pencil, which is diagonalised.
/// - Then each mode takes a step of Newton's method in the basis of all shapes,
///
///       λ_k ← λ_k − y_kᵀ Q(λ_k) y_k / g_k
///       y_k ← y_k + Σ_j y_j (y_jᵀ Q(λ_k) y_k) / (g_j (λ_j − λ_k)),
///
///   j being the modes of other groups and the conjugates of all. What is left is of second order.
///
/// The difference to frequency_response() is a sum over the same poles. It is largest near a pole,
/// and against H_dd in the valleys of |H_dd|. The sum is compared with frequency_response() at
/// these lines. Where they differ, the lines beside are compared, too, and all of them become those
/// of frequency_response(). Where that is a tenth of the lines, all of them are.

#include <array>
#include <span>
#include <vector>

#include "hydrapod/response/frequency_response.hpp"

namespace hydrapod::response {

/// The damped modes of a model, as many as it has coordinates, by |λ|.
struct DampedShapes {
  std::vector<Complex> poles{};     ///< λ [1/s], that with Im λ > 0
  ModelMatrix real{}, imaginary{};  ///< y in the coordinates of the model, one column per mode
};

using DirectLine = std::array<Complex, 6>;  ///< H_xx … H_rzrz

struct DirectResponses {
  std::vector<DirectLine> H{};
  bool is_sum{};  ///< over modes; else by frequency_response()
};

/// At every ω [rad/s] of `omega`, ascending. The input of `model` is the wrench at Q. `damped`:
/// what an eigensolver found; empty, or with real poles, where the modes do not all oscillate.
/// Where best_method() is the modal sum, `damped` is not used.
DirectResponses direct_responses(const ResponseModel& model, const DampedShapes& damped,
                                 std::span<const double> omega);

}  // namespace hydrapod::response
