#include "channel_watch.hpp"

#include <algorithm>
#include <cmath>

namespace hydrapod::identification {

void ChannelWatch::Limit::count(double sample) {
  std::size_t at = 0;
  while (at < known_ && side_ * values_[at] > side_ * sample) ++at;
  if (at < known_ && values_[at] == sample) {
    ++counts_[at];
    return;
  }
  known_ = std::min(known_ + 1, values_.size());
  const auto from = static_cast<std::ptrdiff_t>(at), to = static_cast<std::ptrdiff_t>(known_);
  std::move_backward(values_.begin() + from, values_.begin() + to - 1, values_.begin() + to);
  std::move_backward(counts_.begin() + from, counts_.begin() + to - 1, counts_.begin() + to);
  values_[at] = sample;
  counts_[at] = 1;
  if (known_ == values_.size()) least_ = side_ * values_.back();
}

void ChannelWatch::Limit::add(const Column& samples, double extreme) {
  if (side_ * extreme < least_) return;
  for (const double x : samples)
    if (side_ * x >= least_ && std::isfinite(x)) count(x);
}

std::int64_t ChannelWatch::Limit::clipped(std::int64_t all) const {
  // A rounded top in steps of the resolution has at most as many samples in its last step as in the
  // three before it, √1 against √4 − √1, and a tail of noise has fewer: 0.3 is for scatter.
  constexpr double jump = 1.3;
  // Coarser steps leave no room for that: what falls towards the limit and rises there is clipped,
  // and so is what stands there as often as only a sine of five steps does.
  // Of few samples a slow signal has few tops, any of which may look so.
  constexpr double rise = 1.5, rising_share = 0.01, large_share = 0.2, least = 100.0;
  const auto n = [&](std::size_t k) { return static_cast<double>(counts_[k]); };
  const double share = n(0) / static_cast<double>(all);
  const bool jumps = known_ == counts_.size() && n(0) > jump * (n(1) + n(2) + n(3));
  const bool rises = share >= rising_share && n(1) <= n(2) && n(0) > rise * n(1);
  const bool is_usual = share >= large_share && n(0) > n(1);
  return jumps || (n(0) >= least && (rises || is_usual)) ? counts_[0] : 0;
}

void ChannelWatch::add(const Column& samples, double low, double high) {
  samples_ += samples.size();
  if (!std::isfinite(low - high)) {
    low = std::numeric_limits<double>::infinity();
    high = -low;
    for (const double x : samples) {
      if (!std::isfinite(x)) {
        ++missing_;
        continue;
      }
      low = std::min(low, x);
      high = std::max(high, x);
    }
    if (low > high) return;
  }
  low_.add(samples, low);
  high_.add(samples, high);
  tops_.add(samples, low, high);
  cut_tops_.add(samples, low, high);
  hold_.add(samples);
  values_.add(samples);
}

ChannelHealth ChannelWatch::health() const {
  ChannelHealth health;
  health.samples = samples_;
  health.missing = missing_;
  health.lowest = low_.value();
  health.highest = high_.value();
  if (!(health.highest > health.lowest)) return health;
  const std::int64_t at_low = low_.clipped(samples_), at_high = high_.clipped(samples_);
  health.at_limit = at_low + at_high;
  auto cut = tops_.cut_off(health.highest - health.lowest);
  if (cut.samples == 0) cut = cut_tops_.cut_off(tops_.step());
  health.in_flat_tops = cut.samples;
  if (cut.samples == 0 && at_low > 0) cut.below = health.lowest;
  if (cut.samples == 0 && at_high > 0) cut.above = health.highest;
  health.cut_below = cut.below;
  health.cut_above = cut.above;
  health.longest_hold = hold_.samples();
  health.held_samples = values_.samples();
  return health;
}

}  // namespace hydrapod::identification
