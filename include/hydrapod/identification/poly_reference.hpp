#pragma once
/// Poles from frequency responses: poly-reference least squares in the frequency domain (pLSCF).
///
/// Right matrix fraction with p inputs (references) and order n, z = e^(sT) on the band f_0 … f_1,
/// T = 1/(2 (f_1 − f_0)), s = 2πi (f − f_0):
///
///     H(z) = B(z) A(z)⁻¹,   A = Σ A_k z^k (p×p),   B = Σ B_k z^k,   real coefficients.
///
/// Per output o the equation error w_o (B_o − H_o A) is linear in all of them; B is eliminated and
/// the reduced normal equations M α = 0 are solved with A_0 = I. Then the zeros of det A that model
/// noise lie outside the unit circle and are told from those of the machine by their sign. All
/// sums depend on differences of powers only: they are formed once, for the highest order, and a
/// lower one uses the leading blocks. With fewer outputs than inputs the transposed problem is
/// solved.
///
/// Source: B. Peeters, H. Van der Auweraer, P. Guillaume, J. Leuridan, Shock and Vibration 11
/// (2004) 395.

#include <functional>

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

/// A pole λ with its rank-one residue A = φ Lᵀ: H ≈ φ Lᵀ/(s − λ) near it.
struct PoleEstimate {
  std::complex<double> pole{};       ///< λ [1/s], Im > 0
  Eigen::VectorXcd shape{};          ///< φ, a number per output
  Eigen::VectorXcd participation{};  ///< L, a number per input
  [[nodiscard]] double omega() const { return std::abs(pole); }
  [[nodiscard]] double damping_ratio() const { return -pole.real() / std::abs(pole); }
};

/// What was found with one model order.
struct OrderPoles {
  int order{};
  std::vector<PoleEstimate> poles{};  ///< oscillating, in the band; ascending in |λ|
};

struct OrderRange {
  int lowest{2}, highest{40}, step{2};
};

/// Of the lines of `responses`; frequencies may be unevenly spaced. `progress` is told the share
/// that is done. Throws std::invalid_argument for orders that make no sense and for less than four
/// lines; highest order is lowered to what the number of lines can bear.
std::vector<OrderPoles> poly_reference_poles(const FrequencyResponses& responses,
                                             const OrderRange& orders = {},
                                             const std::function<void(double)>& progress = {});

}  // namespace hydrapod::identification
