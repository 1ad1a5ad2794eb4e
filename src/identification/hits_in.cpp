#include <algorithm>
#include <cmath>

#include "hits.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

double median_of(const VectorXd& x) { return numerics::upper_median({x.begin(), x.end()}); }

std::vector<Hit> only_hits(const std::vector<Hit>& forces, const HitOptions& options) {
  double largest = 0.0;
  for (const auto& hit : forces) largest = std::max(largest, hit.peak);
  std::vector<Hit> hits;
  for (const auto& hit : forces)
    if (hit.peak >= options.least * largest) hits.push_back(hit);
  return hits;
}

double rms(const Eigen::Ref<const VectorXd>& x, double rest) {
  return std::sqrt((x.array() - rest).square().mean());
}

}  // namespace

double rest_of(const VectorXd& input) { return median_of(input); }

std::vector<Hit> forces_in(const VectorXd& input, const HitOptions& options) {
  const Index n = input.size();
  const Eigen::ArrayXd size = (input.array() - median_of(input)).abs();
  const double level =
      std::max(options.of_noise * median_of(size.matrix()), options.of_peak * size.maxCoeff());
  const Index apart = std::lround(options.apart * static_cast<double>(n));
  const auto reach = [&](const Hit& hit) {
    return std::max<Index>(2 * hit_margin, std::min(apart, hit.to - hit.from + 1));
  };
  std::vector<Hit> all;
  for (Index k = 0; k < n; ++k) {
    if (!(size[k] > level)) continue;
    if (all.empty() || k - all.back().to > reach(all.back())) all.push_back({k, k, 0.0});
    all.back().to = k;
    all.back().peak = std::max(all.back().peak, size[k]);
  }
  for (auto& hit : all) {
    hit.from = std::max<Index>(0, hit.from - hit_margin);
    hit.to = std::min(n - 1, hit.to + hit_margin);
  }
  return all;
}

std::vector<Hit> hits_in(const VectorXd& input, const HitOptions& options) {
  if (input.size() < options.fewest || !input.allFinite()) return {};
  const double rest = median_of(input), all = (input.array() - rest).square().sum();
  if (!(all > 0.0)) return {};
  constexpr double deviation = 1.4826;  // of normal noise, by the median of its size
  const Eigen::ArrayXd size = (input.array() - rest).abs();
  if (deviation * median_of(size.matrix()) > options.quiet * size.maxCoeff()) return {};
  const auto forces = forces_in(input, options);
  double energy = 0.0;
  Index length = 0;
  for (const auto& hit : forces) {
    const Index own = hit.to - hit.from + 1;
    energy += (input.segment(hit.from, own).array() - rest).square().sum();
    length += own;
  }
  constexpr Index always = 9;  // samples of a hit in the shortest of records
  const auto longest =
      std::max<Index>(always, std::lround(options.longest * static_cast<double>(input.size())));
  if (energy < options.energy * all || length > longest) return {};
  auto hits = only_hits(forces, options);
  if (hits.size() > options.most_hits) hits.clear();
  return hits;
}

bool outputs_rise(const data::Samples& samples, const std::vector<int>& outputs,
                  const std::vector<Hit>& hits, const HitOptions& options) {
  constexpr Index enough = 16, part = 16;  // of a record: what is heavily damped is over soon
  const Index n = samples.rows(), longest = std::max(enough, n / part);
  for (std::size_t k = 0; k < hits.size(); ++k) {
    const Index from = hits[k].from, next = k + 1 < hits.size() ? hits[k + 1].from : n,
                before = std::min(from, longest), after = std::min(next - from, longest);
    if (before < enough || after < enough) continue;
    const auto rises = [&](int o) {
      const VectorXd y = samples.col(o).segment(from - before, before + after);
      const double rest = y.head(before).mean();
      return rms(y.tail(after), rest) > options.rise * rms(y.head(before), rest);
    };
    if (std::ranges::any_of(outputs, rises)) return true;
    if (k == 0) return false;
  }
  return true;
}

}  // namespace hydrapod::identification
