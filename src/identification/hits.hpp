#pragma once
/// Records of a hammer test: a few hits each. Private to the module.
///
/// The input is short, and the outputs ring down: what is transformed is one block, and a window
/// that begins and ends at zero would cut off what matters. With e^(−at) on input and outputs
/// alike, t from the beginning of the block,
///
///     H(a + iω) = Σ_k Y_k U_k* / Σ_k |U_k|²   over the blocks k
///
/// A block begins just before a hit. What came before it is noise alone, and would count most of
/// all. What has not rung down at the end, e^(−aT), changes Y by e^(−sT) Σ φ x(T)/(s − λ), and
/// e^(−iωT) is 1 at the lines: as U hardly turns from line to line, poles and shapes stay as they
/// are, and only the scale is off by that.
///
/// Where a record has several hits, there are two ways.
///
/// - Where the response to it has rung down when the next one comes, a hit ends a block.
/// - Else the block goes on. The system is at rest before its first hit, so this is exact for any
///   number of hits. Where they cancel each other, |U| is nearly zero, and those lines are left
///   out: with two equal hits Δt apart, around every second multiple of 1/(2 Δt).
///
/// All blocks have one length. Hits of which much less was recorded than of the others are left
/// out.
///
/// Beside hits the input is set to zero (force window). There are lines as far as each hit by
/// itself excites. Errors are not known; where hits meet in a block, the density of the input tells
/// how they change from line to line.
///
/// With a = 0 it is H(iω), as other programs have it, but for what has not rung down: `on_axis`.
///
/// Source: D. L. Brown, R. J. Allemang, W. G. Halvorsen, Impact testing considerations, in:
/// Structural Testing, Univ. of Cincinnati (1999).

#include <optional>
#include <vector>

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

struct HitOptions {
  /// The force is where |x| > of_noise · the median of all, and > of_peak · the largest, with what
  /// is within `apart` · its length of the next such sample, but no further than that force is
  /// long, and two samples more on either side.
  double of_noise{8.0}, of_peak{0.01};
  double apart{0.002};
  /// RMS of the noise of a hammer at rest, at most this of the largest: hum has some per cent
  double quiet{0.02};
  /// A tone of the input at rest is hum of its cable where it has > hum · the power there: noise
  /// has that in no line. It is taken out, up to most_hum of them.
  double hum{0.5};
  int most_hum{4};
  /// RMS of an output just after the first hit, of that before: spikes of the recorder move nothing
  double rise{2.0};
  /// A record is hits where energy of the input there ≥ energy · all, and it is no longer than
  /// longest · the record. White noise has 4 % of its energy in 4 % of its length.
  double energy{0.7}, longest{0.04};
  double least{0.05};                 ///< of the largest: smaller ones are force, but no hits
  std::size_t most_hits{64};          ///< in a record: else it is a broad-band excitation
  double decay{5.0};                  ///< a ≥ decay/T: what has not rung down is 0.7 % at the end
  double rung_down{0.01};             ///< RMS before the next hit, of that after one
  double short_of{0.5};               ///< of the median: shorter blocks are left out
  std::size_t fewest_lines{32};       ///< else the usual estimate is better
  Eigen::Index most_covariances{32};  ///< of neighbouring lines: there they are below 5 %
  double weakest{1e-3};  ///< lines up to the first with |U|² < weakest · the largest: 30 dB
  /// Lines are left out with |U|² < cancelled · that of the hits one by one. Where these are more
  /// than `wide`, a mode could hide there, and nearly_cancelled is the limit.
  double cancelled{0.15}, nearly_cancelled{0.01};
  Eigen::Index wide{4}, gap{5};  ///< lines; gaps from there on are said
  /// Hits disagree where they have not in common more than that of the power of an output, and
  /// that is as much at its resonances as `alike` times the response.
  double in_common{0.9}, alike{0.3};
  Eigen::Index fewest{64}, most{Eigen::Index{1} << 21};  ///< samples of a record
};

/// Samples from … to of the force; the largest, less what it is at rest.
struct Hit {
  Eigen::Index from{}, to{};
  double peak{};
};

constexpr Eigen::Index hit_margin = 2;  ///< samples

/// A tone in an input.
struct Hum {
  double omega{};      ///< [rad/sample]
  double amplitude{};  ///< in the unit of the input
};

/// The input without the hum that its rest shows, where it has peaks that stand out of it; `found`:
/// what was taken out, the strongest first.
Eigen::VectorXd without_hum(const Eigen::VectorXd& input, std::vector<Hum>& found,
                            const HitOptions& options = {});

/// What the input is where nothing pushes.
double rest_of(const Eigen::VectorXd& input);

/// Where the input is more than noise, taps and all.
std::vector<Hit> forces_in(const Eigen::VectorXd& input, const HitOptions& options = {});

/// Empty: the signal is no hits.
std::vector<Hit> hits_in(const Eigen::VectorXd& input, const HitOptions& options = {});

/// Does the first hit after a few samples of rest set an output in motion?
bool outputs_rise(const data::Samples& samples, const std::vector<int>& outputs,
                  const std::vector<Hit>& hits, const HitOptions& options = {});

struct HitResponses {
  FrequencyResponses responses{};
  Eigen::Index samples{};  ///< of a block
  bool without_cut{};      ///< blocks with samples that are cut off were left out
};

/// `samples`: each all of a record, of the channels of `choice`, with one input. None where one of
/// them is no hits, or has a missing sample, or where too few lines come out. With a warning: count
/// of records, total of hits in them, share 1 where each hit is a block, 0 where each record is
/// one, else blocks per hit, value: share of the power of channel on which they do not agree.
/// Others tell what was left out. `health`: of the channels; blocks with samples that are cut off
/// are left out where others remain, and else what comes from the first hit with such samples on.
std::optional<HitResponses> responses_of_hits(const std::vector<data::Samples>& samples,
                                              const std::vector<data::Channel>& outputs,
                                              const ChannelChoice& choice, double sample_rate,
                                              const std::vector<ChannelHealth>& health = {},
                                              const HitOptions& options = {});

}  // namespace hydrapod::identification
