#pragma once
/// Straight lines over missing samples. Private to the module.

#include <cmath>

#include "names.hpp"

namespace hydrapod::identification {

/// Over those of x, a vector, of which missing(t) holds; before the first sample and after the last
/// their value, 0 where there is none.
template <class Samples, class Missing>
void bridge(Samples&& x, const Missing& missing) {
  Index last = -1;
  for (Index t = 0; t < x.size(); ++t) {
    if (missing(t)) continue;
    const double from = x[last < 0 ? t : last];
    for (Index s = last + 1; s < t; ++s)
      x[s] = from + (x[t] - from) * static_cast<double>(s - last) / static_cast<double>(t - last);
    last = t;
  }
  const double rest = last < 0 ? 0.0 : x[last];
  x.tail(x.size() - last - 1).setConstant(rest);
}

/// Over samples that are not finite.
inline VectorXd bridged(VectorXd samples) {
  bridge(samples, [&](Index t) { return !std::isfinite(samples[t]); });
  return samples;
}

}  // namespace hydrapod::identification
