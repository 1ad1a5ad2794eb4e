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
///
/// Which poles are the machine's: those that come back whatever the model order.
///
/// A pole of one order matches one of another order when
///
///     |Δω|/ω ≤ frequency,   |Δζ| ≤ damping · ζ + damping_floor,   MAC ≥ vector,
///
/// MAC being that of its shape (and of its participation) with what the other order has within
/// `neighbourhood` of it: with the subspace that those poles span, so that repeated modes, whose
/// shapes may be mixed at will, count as the same. A cluster takes one pole of every order at most;
/// the pole that most other orders match begins the first one, and so on with what is left. So
/// a repeated mode makes as many clusters as it has poles. A cluster is kept when it has at
/// least `persistence` of the orders from the one on at which it first appears, and at least
/// `fewest`.
///
/// What a pole of the stabilisation chart has in common with the model order before its own.

#include <complex>
#include <functional>
#include <vector>

#include "hydrapod/data/modal_results.hpp"
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

/// highest = 0: as many as it takes for `poles` = n · p zeros of det A, p being the references (the
/// smaller number of inputs and outputs), at least `fewest`; then step = 0: `fewest`/2 orders.
struct OrderRange {
  int lowest{2}, highest{0}, step{0};
  /// Half of the zeros are poles in the band, and noise takes two of three of these: 25 modes in a
  /// band show up in the upper half of the orders.
  int poles{160};
  int fewest{40};  ///< order of the highest; many references need no fewer
};

/// Of the lines of `responses`; frequencies may be unevenly spaced. `progress` is told the share
/// that is done. Throws std::invalid_argument for orders that make no sense and for less than four
/// lines; highest order is lowered to what the number of lines can bear.
std::vector<OrderPoles> poly_reference_poles(const FrequencyResponses& responses,
                                             const OrderRange& orders = {},
                                             const std::function<void(double)>& progress = {});

using data::mac;

struct SelectionOptions {
  double frequency{0.01};       ///< several times what frequencies scatter by over orders
  double damping{0.2};          ///< damping ratios scatter that much more
  double damping_floor{0.002};  ///< and those near zero by this
  double vector{0.8};           ///< another mode's is rarely above 0.5
  double neighbourhood{0.02};   ///< twice `frequency`: both poles may be off
  double persistence{0.5};      ///< poles of noise come back less often
  int fewest{4};                ///< fewer orders may agree by chance
  /// Clusters vote on the order of their representatives within voters · neighbourhood: so far
  /// reaches what a cluster's poles and their neighbours may be apart.
  double voters{2.0};
  double highest_damping{0.9};  ///< poles with more than this are not looked at
};

/// Which pole of which order.
struct PoleIndex {
  std::size_t order{}, pole{};
};

struct PoleCluster {
  PoleEstimate representative{};     ///< of the highest order in which all clusters near it are
  std::vector<PoleIndex> members{};  ///< one per order at most
  double persistence{};              ///< share of the orders from the first one on
  double frequency_scatter{};        ///< standard deviation of ω over its mean, over members
  double damping_scatter{};          ///< standard deviation of ζ
  double vector_consistency{};       ///< mean MAC of the members with the representative
};

/// Ascending in frequency.
std::vector<PoleCluster> select_poles(const std::vector<OrderPoles>& chart,
                                      const SelectionOptions& options = {});

/// Each level holds what the ones before it do.
enum class PoleStability {
  fresh,      ///< no pole near it in the order before
  frequency,  ///< one within SelectionOptions::frequency
  damping,    ///< and its damping ratio agrees
  vector      ///< and shape and participation lie in what poles near it span
};

/// Per order and pole of `chart`. Poles of the lowest order are fresh.
std::vector<std::vector<PoleStability>> pole_stability(const std::vector<OrderPoles>& chart,
                                                       const SelectionOptions& options = {});

}  // namespace hydrapod::identification
