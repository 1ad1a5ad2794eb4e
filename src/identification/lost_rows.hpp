#pragma once
/// Rows that a logger lost without a trace: time columns and counts go on as if nothing were
/// missing. Private to the module.
///
/// One step is predicted of every output, from p samples of all channels before it and from what
/// excites at the same time (r: the inputs, in a loop the instruments; none with outputs alone),
///
///     y_t = Σ_(k = 1 … p) A_k z_(t−k) + B r_t + e_t,   z = (r, y).
///
/// Where rows are missing the machine has moved on, and the first sample behind the place is beyond
/// what is usual in most outputs at once; the p samples before it are not. A spike is in one output
/// there, and in the others later. A measured hit, a burst or a step of the excitation is in r_t.
/// A blow that no input shows is beyond it too; blocks are as little use there.
///
/// A block across such a place has a jump in the phase of all that rings, which widens resonances.
/// So a stretch behind each is taken as missing, long enough not to be filled (gaps.hpp): the
/// blocks that contain it are left out. Where the excitation is periodic the machine needs a period
/// more to follow it.

#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "background.hpp"
#include "hydrapod/identification/responses.hpp"
#include "reading.hpp"

namespace hydrapod::identification {

struct LostRowsOptions {
  /// |e| of most outputs > stands_out · its deviation (by its median). Noise does not do that, nor
  /// do heavy tails in most outputs at once; in one output they do.
  double stands_out{12.0};
  /// … and |e| of all outputs in the p samples before ≤ quiet · its deviation: else it is more of
  /// something that began before.
  double quiet{6.0};
  /// Half of the samples of each channel are ≥ moves · its RMS (of normal noise 0.67): of hits and
  /// bursts the deviation is that of the rest between them, and tells nothing.
  double moves{0.2};
  /// The model is fitted once more without rows of |e| > outlier · its deviation.
  double outlier{8.0};
  /// p = most_coefficients / channels, at most highest_order.
  Eigen::Index most_coefficients{120}, highest_order{16};
  Eigen::Index most_outputs{5};  ///< that are predicted, if there are more: evenly
  /// The model is fitted to so many rows, evenly over the first `fit_within`. A model of a part
  /// that is quieter than the rest finds nothing there: its errors are never small.
  Eigen::Index fit_rows{Eigen::Index{1} << 12};
  std::int64_t fit_within{std::int64_t{1} << 20};
  Eigen::Index fewest_per_coefficient{8};  ///< rows for each, or nothing is looked for
  /// More places in a stretch of `each` samples or less on the average are its signal: friction,
  /// blows.
  std::int64_t each{200};
  /// The stretch that is taken as missing: more than GapOptions::longest of a block.
  double of_block{0.15};
  /// Averages without the places ≥ inputs + degrees: the noise is known within a factor. Else they
  /// are used.
  double degrees{2.0};
};

struct LostRows {
  std::vector<data::RecordSet::Stretch> stretches{};
  std::int64_t places{};
  std::size_t file{};    ///< of the first
  std::int64_t first{};  ///< its sample
};

/// Not where an input reached the limit of its range, as what it did then is not known. What it
/// finds after `stop` became true is nothing.
LostRows find_lost_rows(data::RecordSet& records, const Reading& reading,
                        const LostRowsOptions& options = {},
                        const std::atomic<bool>* stop = nullptr);

/// The same beside the spectra, where the samples are in memory: it needs the reading alone.
class LostRowsSearch {
 public:
  LostRowsSearch(const data::RecordSet& records, const Reading& reading);
  /// Once. It is looked for here where it was not, or where other samples are missing by now.
  /// `reading`: the same, with what was found since.
  LostRows result(data::RecordSet& records, const Reading& reading);

 private:
  std::vector<data::RecordSet::Stretch> missing_;
  std::optional<Background<LostRows>> search_{};
};

/// `rest`: what was measured without them, if that can be. `measured` gets the warning, and is
/// `rest` where that has blocks enough.
void take_without_lost_rows(const LostRows& lost, std::optional<Measurement> rest,
                            const data::RecordSet& records, Measurement& measured,
                            const LostRowsOptions& options = {});

}  // namespace hydrapod::identification
