#pragma once
/// Records of a hammer test: one hit each. Private to the module.
///
/// The input is short, and the outputs ring down: a record is one block, and a window that begins
/// and ends at zero would cut off what matters. With e^(−at) on input and outputs alike, t from the
/// beginning of the record,
///
///     H(a + iω) = Σ_k Y_k U_k* / Σ_k |U_k|²   over the records k
///
/// is exact for whatever has rung down by e^(−aT) at the end, T after the hit. Beside the hit the
/// input is set to zero (force window). There are lines as far as the hit excites; without blocks
/// to average, errors are not known.
///
/// With a = 0 it is H(iω), as other programs have it, but for what has not rung down: `on_axis`.
///
/// Source: D. L. Brown, R. J. Allemang, W. G. Halvorsen, Impact testing considerations, in:
/// Structural Testing, Univ. of Cincinnati (1999).

#include <optional>

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

struct HitOptions {
  /// A record is one hit where energy of the input within ± reach · its length around its largest
  /// sample ≥ energy · all. White noise has 4 % of it there.
  double energy{0.7};
  double reach{0.02};
  /// The force is from the first to the last sample there of which |x| > of_noise · the median of
  /// all, and > of_peak · the largest, and two samples more.
  double of_noise{8.0}, of_peak{0.01};
  double decay{5.0};                  ///< a = decay/T: what has not rung down is 0.7 % at the end
  Eigen::Index most_covariances{32};  ///< of neighbouring lines: there they are below 5 %
  double weakest{1e-3};  ///< lines up to the first with |U|² < weakest · the largest: 30 dB
  Eigen::Index fewest{64}, most{Eigen::Index{1} << 21};  ///< samples of a record
};

/// The largest sample of a hit; none: the signal is no hit.
std::optional<Eigen::Index> hit_in(const Eigen::VectorXd& input, const HitOptions& options = {});

/// `records`: each all samples of the channels of `choice`, with one input. None where one of them
/// is no hit, or has a missing sample.
std::optional<FrequencyResponses> responses_of_hits(const std::vector<data::Samples>& records,
                                                    const ChannelChoice& choice, double sample_rate,
                                                    const HitOptions& options = {});

}  // namespace hydrapod::identification
