#include "search.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hydrapod/base/error.hpp"
#include "line_weights.hpp"
#include "names.hpp"
#include "usable.hpp"

namespace hydrapod::identification {

namespace {

/// Where the responses stand above their noise.
Band audible_band(const FrequencyResponses& r, const BandOptions& options) {
  Band band{r.frequency.front(), r.frequency.back()};
  if (!r.has_errors()) return band;
  const VectorXd ratio = signal_to_noise(r, options.reach);
  const auto heard = [&](double x) { return x > options.audible; };
  const auto first = std::find_if(ratio.begin(), ratio.end(), heard);
  if (first == ratio.end()) return band;
  auto last = ratio.end() - 1;
  while (!heard(*last)) --last;
  band.from = r.frequency[static_cast<std::size_t>(first - ratio.begin())];
  band.to = r.frequency[static_cast<std::size_t>(last - ratio.begin())];
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
  Band band = audible_band(r, options.band);
  if (options.from) band.from = *options.from;
  if (options.to) band.to = *options.to;
  Search s = search(r, band, options, progress);
  const auto& limits = options.band;
  for (int round = 0; !options.to && round < limits.rounds; ++round) {
    double highest = 0.0;
    for (const auto& c : s.clusters)
      if (c.representative.damping_ratio() <= options.highest_damping)
        highest = std::max(highest, c.representative.omega() / two_pi);
    const double to = highest > 0.0 ? limits.room * highest : 0.5 * band.to;
    if (to > limits.worth * band.to) break;
    if (within(r, band.from, to).lines() < few_lines) break;
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
  return lines_of(r, lines);
}

}  // namespace hydrapod::identification
