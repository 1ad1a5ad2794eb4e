#include "peaks_above.hpp"

#include <algorithm>

#include "hydrapod/numerics/statistics.hpp"
#include "line_weights.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

/// Mean square over the responses, each by its median.
VectorXd mean_square(const FrequencyResponses& r, Index reach) {
  const auto lines = static_cast<Index>(r.lines());
  VectorXd sum = VectorXd::Zero(lines);
  for (Index o = 0; o < r.H[0].rows(); ++o)
    for (Index i = 0; i < r.H[0].cols(); ++i) {
      VectorXd own(lines);
      for (Index k = 0; k < lines; ++k) own[k] = std::norm(r.H[static_cast<std::size_t>(k)](o, i));
      const double median = numerics::upper_median({own.begin(), own.end()});
      if (median > 0.0) sum += own / median;
    }
  return running_mean(sum, reach);
}

}  // namespace

std::vector<double> peaks_above(const FrequencyResponses& all, double to,
                                const IdentifyOptions& options) {
  const auto& f = all.frequency;
  const VectorXd size = mean_square(all, options.band.reach),
                 ratio = signal_to_noise(all, options.band.reach);
  const auto at = [&](double x) {
    return static_cast<Index>(std::ranges::lower_bound(f, x) - f.begin());
  };
  std::vector<Index> peaks;
  for (Index k = at(to) + 1; k < size.size(); ++k) {
    if (!(ratio[k] > options.band.audible)) continue;
    const double own = f[static_cast<std::size_t>(k)];
    const auto below = size.segment(at(own / options.peaks.side), k - at(own / options.peaks.side)),
               above = size.segment(k, std::min(at(own * options.peaks.side), size.size()) - k);
    if (below.size() == 0 || below.maxCoeff() > size[k] || above.maxCoeff() > size[k]) continue;
    if (options.peaks.drop * std::max(below.minCoeff(), above.minCoeff()) < size[k])
      peaks.push_back(k);
  }
  std::ranges::sort(peaks, std::greater(), [&](Index k) { return size[k]; });
  std::vector<double> frequencies;
  for (const Index k : peaks) frequencies.push_back(f[static_cast<std::size_t>(k)]);
  return frequencies;
}

}  // namespace hydrapod::identification
