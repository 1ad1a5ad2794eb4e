#include "channel_watch.hpp"

#include <cmath>

namespace hydrapod::identification {

void ChannelWatch::Limit::add(const Column& samples, double extreme, double side) {
  const auto count = [&](double at) { return (samples.array() == at).count(); };
  if (extreme != value) {  // beyond all before
    next = value;
    counted_next = counted;
    value = extreme;
    counted = 0;
  }
  counted += count(value);
  // the value next to it may be among these samples
  double inner = next;
  for (const double x : samples)
    if (std::isfinite(x) && x != value && side * (x - inner) > 0.0) inner = x;
  if (inner != next) counted_next = 0;
  next = inner;
  counted_next += count(next);
}

void ChannelWatch::add(const Column& samples) {
  samples_ += samples.size();
  double low = 0.0, high = 0.0;
  bool any = false;
  if (samples.allFinite()) {
    low = samples.minCoeff();
    high = samples.maxCoeff();
    any = samples.size() > 0;
  } else {
    for (const double x : samples) {
      if (!std::isfinite(x)) {
        ++missing_;
        continue;
      }
      low = any ? std::min(low, x) : x;
      high = any ? std::max(high, x) : x;
      any = true;
    }
  }
  if (!any) return;
  if (!begun_) {
    low_ = {.value = low, .next = high};
    high_ = {.value = high, .next = low};
  }
  begun_ = true;
  // else no sample of this piece is at the limit or next to it
  if (low <= low_.next) low_.add(samples, std::min(low, low_.value), -1.0);
  if (high >= high_.next) high_.add(samples, std::max(high, high_.value), 1.0);
}

ChannelHealth ChannelWatch::health() const {
  ChannelHealth health;
  health.samples = samples_;
  health.missing = missing_;
  health.lowest = low_.value;
  health.highest = high_.value;
  if (high_.value > low_.value) health.at_limit = low_.clipped() + high_.clipped();
  return health;
}

}  // namespace hydrapod::identification
