#include "flat_tops.hpp"

#include <algorithm>
#include <cmath>

#include "names.hpp"

namespace hydrapod::identification {

namespace {

constexpr Index least_run = 3, longest_flank = 64;
constexpr Index kept_before = 3 * longest_flank;  // samples: a top, and what it falls by
constexpr std::size_t most_tops = 1000;

}  // namespace

/// The resolution: of a signal of few levels the first steps have it.
void FlatTops::measure_steps(const Column& samples) {
  constexpr int enough = 4096;
  for (Index k = 0; k < samples.size() && steps_ < enough; ++k) {
    const double step = std::abs(samples[k] - last_);
    last_ = samples[k];
    if (!(step > 0.0)) continue;
    step_ = std::min(step_, step);
    ++steps_;
  }
}

/// At runs whose flanks are known since `known` samples were seen, and not before.
void FlatTops::look(End& end, Index known) const {
  const auto x = VectorXd::Map(seen_.data(), static_cast<Index>(seen_.size()));
  for (Index from = 0; from < x.size(); ++from) {
    if (x[from] != end.extreme) continue;
    Index to = from;
    while (to < x.size() && x[to] == end.extreme) ++to;
    const Index run = to - from, flank = std::min(run, longest_flank);
    const bool is_new = to + flank > known && to + flank <= x.size();
    if (run >= least_run && is_new && from >= std::max<Index>(flank, 2) && to + 1 < x.size() &&
        x[from - 1] != x[from - 2] && x[to] != x[to + 1]) {
      const auto falls = [&](Index t) { return end.side * (end.extreme - x[t]); };
      if (end.tops.size() < most_tops)
        end.tops.push_back({run, std::min(falls(from - flank), falls(to + flank - 1))});
    }
    from = to;
  }
}

void FlatTops::add(const Column& samples, double low, double high) {
  measure_steps(samples);
  const bool begins = !(low_.extreme <= high_.extreme);
  // what stands at the end of the last piece may have had no flank yet
  const bool was_near = is_near_;
  is_near_ = begins || low <= low_.extreme || high >= high_.extreme;
  const Index used = is_near_ || was_near ? samples.size() : std::min(samples.size(), kept_before);
  const auto known = static_cast<Index>(seen_.size());
  seen_.insert(seen_.end(), samples.end() - used, samples.end());
  const auto look_again = [&](End& end, double extreme) {
    if (begins || end.side * extreme > end.side * end.extreme) {
      end.extreme = extreme;
      end.tops.clear();
    }
    look(end, known);
  };
  if (is_near_ || was_near) {
    look_again(low_, low);
    look_again(high_, high);
  }
  const auto kept = std::min<std::ptrdiff_t>(kept_before, std::ssize(seen_));
  seen_.erase(seen_.begin(), seen_.end() - kept);
}

CutOff FlatTops::cut_off(double range, const FlatTopOptions& options) const {
  const auto least = [&](const Top& top) {
    const auto n = static_cast<double>(top.samples);
    const double rounded = step_ * std::pow((3.0 * n - 1.0) / (n - 1.0), 2);
    return std::max(options.of_rounded * rounded, options.of_range * range);
  };
  CutOff cut;
  for (const End* end : {&low_, &high_})
    for (const Top& top : end->tops) {
      if (!(top.flank > least(top))) continue;
      cut.samples += top.samples;
      (end == &low_ ? cut.below : cut.above) = end->extreme;
    }
  return cut;
}

}  // namespace hydrapod::identification
