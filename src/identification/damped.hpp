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
/// there small. Excitation must be flat over a few lines.
///
/// The cut at τ = 0 spreads errors of the strongest lines over all others, 1/(2πd)² of their
/// variance to the d-th line, and with one phase: what comes from a sharp pole of the loop looks
/// like a mode there. All of H_wr, divided by ρ(τ), is therefore multiplied by a filter D(ω), one
/// for outputs and inputs, which the quotient cancels. |D| is the inverse of the standard deviation
/// of H_wr, as a mean over outputs and inputs: D H_wr has no strong errors. Where r says nothing,
/// H_wr is noise; there |D| falls to 0 within a few lines. D has minimum phase: D H_wr remains
/// causal, so that nothing is cut off at τ = 0, and its delay, over which the lag window gives more
/// weight to noise than to the response, is the least possible.
///
/// Errors. With w = (y, u) − H_wr r, its spectrum W̄ and P̄ = |D|² S_rr⁻¹ averaged over all lines as
/// the lag window mixes them, K blocks and p inputs,
///
///     cov(H_oi, H_pj*) = [(I, −H) W̄ (I, −H)ᴴ]_op Q_ji c/(K − p),   Q = H'_ur⁻ᴴ P̄ H'_ur⁻¹,
///
/// c = Σ |q|² v over lags: q the factor on h, v the share of the estimate's scatter at that lag,
/// which also gives the covariance of neighbouring lines. Lines far away count: errors of one line
/// cancel in (I, −H) W̄ (I, −H)ᴴ where the loop resonates, and those of others do not.
///
/// Weak excitation. The errors of H'_ur are known in the same way, and H'_ur⁻¹ is right to first
/// order only where they are small beside it, in every direction of u. Their ratio is the F
/// statistic of the first stage (p numbers of r for each u); the weakest mixture of inputs has
///
///     F = 1/(p λ),   λ the largest eigenvalue of W̄_uu Q c/(K − p).
///
/// Around 1 r explains nothing of it, and the estimate is anything between H and what the loop
/// makes of noise. Sources: D. Staiger, J. H. Stock, Econometrica 65 (1997) 557; J. G. Cragg, S. G.
/// Donald, Econometric Theory 9 (1993) 222.

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

struct DampedOptions {
  /// e^(−decay) of an impulse response may be left after half a block, where it is cut off.
  double decay{4.0};
  /// A line is excited where each instrument's density > weakly_excited · that of its strongest
  /// line: below, the window's leakage is all there is.
  double weakly_excited{1e-5};
  /// … and where r explains more than seen · what it would explain of noise by chance, in the mean
  /// over outputs and inputs and over the seen_reach lines below, and over those above. Chance
  /// scatters by a third of itself for one input, by less for several. A single dip of the
  /// inputs, as at a sharp resonance inside the loop, is no end of the excitation.
  double seen{2.0};
  Eigen::Index seen_reach{6};
  /// Lines: standard deviation of the bell that rounds the edges of ln |D|, and distance of the
  /// edges from lines that are not excited. Narrower edges make D ring past the end of a block.
  double edge{6.0};
  /// |D| far outside: what is left there is cut off, and so small that this does not show.
  double attenuation{1e-5};
  /// Lines with |D| > least_share are used: below, what leaks from their neighbours prevails.
  double least_share{0.1};
  std::size_t least_lines{16};
  /// Lines: standard deviation of the bell that smooths ln |D| between the edges. Without it D
  /// would follow the scatter of the estimated noise and ring past the end of a block.
  double whitening{1.0};
  /// Variance of H_wr, by that of the strongest line, below which D rises no more.
  double deepest{1e-6};
  /// The excitation is weak at a line where F < strong. In loops of three masses, excited more and
  /// more weakly, 95 % intervals of such modes hold 90 to 93 % (WeakExcitationLong). The rule of
  /// Staiger and Stock, 10, is about a bias that shows when intervals are much narrower.
  double strong{5.0};
};

/// For spectra that are not periodic. Lines are twice as far apart as those of the spectra. Where
/// hardly any line is left (blocks too short for the band) it is estimate_responses(), without a
/// shift; throws base::ComputationError as that does.
FrequencyResponses damped_instrumental(const CrossSpectra& spectra, const ChannelChoice& choice,
                                       const DampedOptions& options = {});

/// What modes are looked for in: damped_instrumental() for the instrumental estimate of spectra
/// that are not periodic, else estimate_responses().
FrequencyResponses responses_for_modes(const CrossSpectra& spectra, const ChannelChoice& choice,
                                       Estimator estimator);

}  // namespace hydrapod::identification
