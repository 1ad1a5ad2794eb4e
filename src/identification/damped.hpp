#pragma once
/// The instrumental estimate of a closed loop on a line beside the imaginary axis.
///
/// Welch's window multiplies impulse responses with its ρ(τ) (lag_taper): resonances widen. For H1
/// this is part of the modal model; in the ratio S_yr S_ur⁻¹ numerator and denominator are widened
/// apart, and no such model exists. But one lag window commutes with every division: that of an
/// exponential. With the responses of outputs y and inputs u to the instruments r (H1, which the
/// loop does not bias) brought to their impulse responses h(τ), τ ≥ 0,
///
///     H'(ω) = Σ_τ h(τ) e^(−aτ) e^(−iωτ) = H(a + iω),     H_yu(a + iω) = H'_yr H'_ur⁻¹
///
/// is exact: a pole at λ shows at λ − a, no matter how sharp it is. h(τ) is had from the H1
/// estimate over all lines, divided by ρ(τ), for τ up to half a block; a makes what is cut off
/// there small. Excitation must be flat over a few lines; lines that are hardly excited are left
/// out, and so are those near them.
///
/// Errors. With w = (y, u) − H_wr r, its spectrum W̄ and P̄ = S_rr⁻¹ averaged over the lines that
/// the lag window mixes, K blocks and p inputs,
///
///     cov(H_oi, H_pj*) = [(I, −H) W̄ (I, −H)ᴴ]_op Q_ji c/(K − p),   Q = H'_ur⁻ᴴ P̄ H'_ur⁻¹,
///
/// c = Σ |q|² v over lags: q the factor on h, v the share of the estimate's scatter at that lag,
/// which also gives the covariance of neighbouring lines.

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

/// For spectra that are not periodic. Lines are twice as far apart as those of the spectra. Where
/// hardly any line is left (blocks too short for the band) it is estimate_responses(), without a
/// shift; throws base::ComputationError as that does.
FrequencyResponses damped_instrumental(const CrossSpectra& spectra, const ChannelChoice& choice);

/// What modes are looked for in: damped_instrumental() for the instrumental estimate of spectra
/// that are not periodic, else estimate_responses().
FrequencyResponses responses_for_modes(const CrossSpectra& spectra, const ChannelChoice& choice,
                                       Estimator estimator);

}  // namespace hydrapod::identification
