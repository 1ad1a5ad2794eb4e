#pragma once
/// What another method says of the same responses: the eigensystem realisation (realisation.hpp)
/// beside the modes of identify.hpp. Modes that both see, each by its own criteria, are hardly made
/// by the method.
///
/// Poles in the time domain, as a cross-check: realisation of a state space from a sequence of
/// matrices Y_k = C A^(k−1) B.
///
/// - Eigensystem realisation (ERA): Y_k is the impulse response at k T, the inverse transform of H.
/// - Covariance-driven stochastic subspace identification (SSI-COV), for output-only data: Y_k =
///   E[y(t + kT) yᵀ(t)], the inverse transform of S_yy; its C A^(k−1) G has the poles of the
///   machine under white excitation.
///
/// Both are corrected for the window's ρ(τ). The Hankel matrix [Y_(i+j−1)] is decomposed once, U Σ
/// Vᵀ; order n takes its n largest singular values: O = U_n Σ_n^½, A = O_up⁺ O_down, C the first
/// rows of O, B the first columns of Σ_n^½ V_nᵀ.
///
/// Sources: J.-N. Juang, R. S. Pappa, J. Guid. Control Dyn. 8 (1985) 620; B. Peeters, G. De Roeck,
/// Mech. Syst. Signal Process. 13 (1999) 855.

#include <optional>

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

/// Y_1, Y_2, … a step of `interval` [s] apart.
struct MarkovSequence {
  std::vector<Eigen::MatrixXd> values{};
  double interval{};
};

/// Impulse response of all lines up to the last frequency. Throws base::ComputationError where the
/// frequencies are not evenly spaced multiples of their distance.
MarkovSequence impulse_response(const FrequencyResponses& responses);

/// Poles of all orders (numbers of states); orders beyond what the sequence can bear are left out.
std::vector<OrderPoles> realised_poles(const MarkovSequence& sequence,
                                       const OrderRange& orders = {4, 60, 2});

struct CrossCheck {
  double omega{}, damping_ratio{};  ///< mean over the model orders that know it
  double mac{};                     ///< of its shape with what realised modes within 2 % span
  /// Within 1 % in frequency, 20 % (and 0.002) in damping and 80 % in MAC: SelectionOptions.
  bool agrees{};
};

/// Per mode of `found` what the realisation has near it (3 % in frequency), each of its modes once.
/// `responses`: all lines that were measured, of which those up to the band's end are used. Throws
/// base::ComputationError where there is no impulse response: frequencies that are not even.
std::vector<std::optional<CrossCheck>> cross_check(const Identification& found,
                                                   const FrequencyResponses& responses);

}  // namespace hydrapod::identification
