#include "search.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hydrapod/base/error.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

template <class T>
std::vector<T> picked(const std::vector<T>& all, const std::vector<std::size_t>& lines) {
  std::vector<T> some;
  if (all.empty()) return some;
  some.reserve(lines.size());
  for (const std::size_t k : lines) some.push_back(all[k]);
  return some;
}

/// Mean of |H|² over variance per line, over a few lines.
std::vector<double> signal_to_noise(const FrequencyResponses& r) {
  std::vector<double> raw;
  for (std::size_t k = 0; k < r.lines(); ++k) {
    double sum = 0.0;
    for (Index o = 0; o < r.H[k].rows(); ++o)
      for (Index i = 0; i < r.H[k].cols(); ++i)
        sum += std::norm(r.H[k](o, i)) /
               std::max(r.variance(k, static_cast<int>(o), static_cast<int>(i)), 1e-300);
    raw.push_back(sum / static_cast<double>(r.H[k].size()));
  }
  constexpr std::size_t reach = 4;
  std::vector<double> smooth;
  for (std::size_t k = 0; k < raw.size(); ++k) {
    const std::size_t from = k < reach ? 0 : k - reach, to = std::min(raw.size() - 1, k + reach);
    double sum = 0.0;
    for (std::size_t j = from; j <= to; ++j) sum += raw[j];
    smooth.push_back(sum / static_cast<double>(to - from + 1));
  }
  return smooth;
}

/// Where the responses stand above their noise.
Band audible_band(const FrequencyResponses& r) {
  Band band{r.frequency.front(), r.frequency.back()};
  if (!r.has_errors()) return band;
  constexpr double audible = 3.0;
  const auto ratio = signal_to_noise(r);
  const auto heard = [&](double x) { return x > audible; };
  const auto first = std::ranges::find_if(ratio, heard);
  if (first == ratio.end()) return band;
  const auto last = std::find_if(ratio.rbegin(), ratio.rend(), heard);
  band.from = r.frequency[static_cast<std::size_t>(first - ratio.begin())];
  band.to = r.frequency[static_cast<std::size_t>(ratio.rend() - last - 1)];
  return band;
}

}  // namespace

Search search(const FrequencyResponses& r, const Band& band, const IdentifyOptions& options,
              const std::function<void(double)>& progress) {
  Search s{within(r, band.from, band.to), {}, {}};
  if (s.responses.lines() < fewest_lines)
    throw base::ComputationError(fmt::format(
        "{} frequencies from {:.4g} Hz to {:.4g} Hz are too few to find modes in; at least {} are "
        "needed (a longer record, or longer blocks, has finer lines)",
        s.responses.lines(), band.from, band.to, fewest_lines));
  s.chart = poly_reference_poles(s.responses, options.orders, progress);
  s.clusters = select_poles(s.chart, options.selection);
  return s;
}

Search search_in_best_band(const FrequencyResponses& r, const IdentifyOptions& options,
                           const std::function<void(double)>& progress) {
  Band band = audible_band(r);
  if (options.from) band.from = *options.from;
  if (options.to) band.to = *options.to;
  Search s = search(r, band, options, progress);
  constexpr double room = 1.6, worth = 0.75;
  for (int round = 0; !options.to && round < 6; ++round) {
    double highest = 0.0;
    for (const auto& c : s.clusters)
      if (c.representative.damping_ratio() <= options.highest_damping)
        highest = std::max(highest, c.representative.omega() / two_pi);
    const double to = highest > 0.0 ? room * highest : 0.5 * band.to;
    if (to > worth * band.to) break;
    const auto narrower = within(r, band.from, to);
    if (narrower.lines() < few_lines) break;
    Search next = search(r, {band.from, to}, options, progress);
    if (highest > 0.0 && next.clusters.empty()) break;
    band.to = to;
    s = std::move(next);
  }
  return s;
}

FrequencyResponses within(const FrequencyResponses& r, double from, double to) {
  std::vector<std::size_t> lines;
  for (std::size_t k = 0; k < r.lines(); ++k)
    if (r.frequency[k] >= from && r.frequency[k] <= to) lines.push_back(k);
  FrequencyResponses some = r;
  some.frequency = picked(r.frequency, lines);
  some.H = picked(r.H, lines);
  some.noise = picked(r.noise, lines);
  some.input_factor = picked(r.input_factor, lines);
  some.coherence = picked(r.coherence, lines);
  some.multiple_coherence = picked(r.multiple_coherence, lines);
  some.condition = picked(r.condition, lines);
  some.input_density = picked(r.input_density, lines);
  return some;
}

}  // namespace hydrapod::identification
