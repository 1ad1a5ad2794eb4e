#include "channel_watch.hpp"

#include <cmath>

namespace hydrapod::identification {

void ChannelWatch::Limit::restart(double at) {
  value = at;
  counted = 0;
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
  if (!begun_ || low < low_.value) low_.restart(low);
  if (!begun_ || high > high_.value) high_.restart(high);
  begun_ = true;
  // else no sample of this piece is at the limit
  if (low == low_.value) low_.counted += (samples.array() == low_.value).count();
  if (high == high_.value) high_.counted += (samples.array() == high_.value).count();
}

ChannelHealth ChannelWatch::health() const {
  ChannelHealth health;
  health.samples = samples_;
  health.missing = missing_;
  health.lowest = low_.value;
  health.highest = high_.value;
  if (high_.value > low_.value) health.at_limit = low_.counted + high_.counted;
  return health;
}

}  // namespace hydrapod::identification
