#pragma once
/// Frequency responses of several inputs and outputs from cross spectra.
///
///     Y = H U + V      u: inputs, y: outputs, r: instruments; V: what does not come from u
///
///     H1 = S_yu S_uu⁻¹             no noise in u; V independent of u
///     H2 = S_yy S_uy⁻¹             no noise in y; as many outputs as inputs
///     Hv                           noise in all channels, in proportion to their level at the
///                                  line: per output the smallest eigenvector of the coherence
///                                  matrix of (u, y_o) (total least squares)
///     instrumental = S_yr S_ur⁻¹   r reaches y only through u and is independent of V, as the
///                                  external excitation of a closed loop is; as many r as u
///
/// In closed loop u holds part of V, and H1 from u to y is biased; from the external excitation r
/// to y it is not, and then shows the closed loop's modes.
///
/// Variance. With G = S_uu⁻¹ (H1, H2, Hv) or S_ur⁻¹, and R = u or r,
///
///     S_vv = (I, −H) S_(y,u) (I, −H)ᴴ · K/(K − p),   cov(H_oi, H_pj) = (S_vv)_op Q_ji / K,
///     Q = Gᴴ S_RR G,
///
/// K effective averages, p inputs; to first order in the noise. |Ĥ_oi − H_oi|² / var(H_oi) is then
/// distributed as F(2, 2 (K − p)): confidence_radius(). Periodic excitation: S_vv from what differs
/// between periods, and K the number of periods, over all records.
///
/// Sources: J. S. Bendat, A. G. Piersol, Random Data, 4th ed. (2010), ch. 7 and 9; R. Pintelon,
/// J. Schoukens, System Identification: A Frequency Domain Approach, 2nd ed. (2012), ch. 2 and 7;
/// G. T. Rocklin, J. Crowley, H. Vold, IMAC 3 (1985) 272 (Hv).

#include <vector>

#include "hydrapod/data/frequency_response.hpp"
#include "hydrapod/identification/spectra.hpp"

namespace hydrapod::identification {

using data::Estimator;
using data::FrequencyResponses;

/// Which channels of the spectra are what.
struct ChannelChoice {
  std::vector<int> inputs{}, outputs{}, instruments{};
};

/// Lines from `lowest_line` on; the first ones hold what is left of the mean. Throws
/// base::ComputationError where nothing sensible can come out: too few averages, inputs that are
/// linearly dependent, nothing on an input. Dead outputs and inputs that repeat another are left
/// out with a warning.
FrequencyResponses estimate_responses(const CrossSpectra& spectra, const ChannelChoice& choice,
                                      Estimator estimator);

/// |Ĥ − H| stays below this, in standard deviations √variance, with the given probability.
double confidence_radius(double probability, double degrees);

/// Largest difference between H1 and the instrumental estimate against its own 95 % radius, and at
/// which share of the lines it is beyond: says whether H1 from u is biased. `share` near 0.05 is
/// what chance gives.
struct BiasFinding {
  double share{};   ///< of entries × lines beyond their 95 % radius
  double median{};  ///< of |H1 − H| / |H|
};
BiasFinding compare_responses(const FrequencyResponses& plain,
                              const FrequencyResponses& instrumental);

}  // namespace hydrapod::identification
