#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "identify_steps.hpp"
#include "line_weights.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

/// [s] of the blocks that gave the responses; none: not known, or periods, which have no window.
std::optional<double> block_duration(const FrequencyResponses& r) {
  if (r.lines() < 2) return {};
  const bool of_outputs = r.estimator == data::Estimator::half_spectra;
  if (r.whole && !of_outputs) return {};
  // on the shifted axis, and of half spectra, every second line is kept
  const bool every_second = r.shift > 0.0 || of_outputs;
  // lines of periods err alone
  const bool of_blocks = r.averages > 0.0 && r.line_covariance.size() > 1;
  if (every_second || (r.estimator == data::Estimator::instrumental && of_blocks)) {
    double spacing = r.frequency[1] - r.frequency[0];
    for (std::size_t k = 2; k < r.lines(); ++k)
      spacing = std::min(spacing, r.frequency[k] - r.frequency[k - 1]);
    return (every_second ? 2.0 : 1.0) / spacing;
  }
  if (r.taper.size() == 0) return {};
  return static_cast<double>(r.taper.size()) / r.sample_rate;
}

void warn_of_short_blocks(const IdentifyOptions& options, Identification& result) {
  const auto duration = block_duration(result.responses);
  if (!duration) return;
  ModeWarning warning{.kind = ModeWarning::Kind::short_blocks,
                      .value = *duration,
                      .total = static_cast<std::int64_t>(result.modes.size())};
  for (const auto& mode : result.modes) {
    const double width = 2.0 * mode.fit.damping_ratio() * mode.fit.omega() / two_pi;
    if (!(width * *duration < options.fewest_lines_wide)) continue;
    if (warning.count++ > 0 && width > warning.to) continue;
    warning.from = mode.fit.omega() / two_pi;
    warning.to = width;
  }
  if (warning.count == 0) return;
  // where that is so of most modes, others may be hidden in those that look wide
  if (result.responses.estimator == data::Estimator::instrumental &&
      2 * warning.count >= warning.total)
    for (auto& mode : result.modes)
      mode.explained = std::min(mode.explained, warning.to * *duration / options.fewest_lines_wide);
  result.warnings.push_back(std::move(warning));
}

/// Of the highest mode.
void warn_of_few_samples(const IdentifyOptions& options, Identification& result) {
  constexpr double folded = 3.0;  // samples per period: with fewer it may be one that was folded
  const double rate = result.responses.sample_rate,
               frequency = result.modes.back().fit.omega() / two_pi, samples = rate / frequency;
  if (!(rate > 0.0) || !(samples < options.fewest_samples)) return;
  ModeWarning warning{.kind = ModeWarning::Kind::few_samples,
                      .value = samples,
                      .to = samples < folded ? rate - frequency : 0.0};
  const double pass_band = rate / options.filtered_samples;
  for (auto& mode : result.modes) {
    if (!(mode.fit.omega() / two_pi > pass_band)) continue;
    mode.explained = std::min(mode.explained, options.folded_quality);
    ++warning.count;
  }
  if (warning.count > 0) {
    warning.from = pass_band;
    warning.total = std::ssize(result.modes);
  }
  result.warnings.push_back(warning);
}

}  // namespace

void add_warnings(const IdentifyOptions& options, Identification& result) {
  using Kind = ModeWarning::Kind;
  if (result.modes.empty()) {
    result.warnings.push_back({.kind = Kind::no_mode, .from = result.from, .to = result.to});
  } else {
    warn_of_few_samples(options, result);
  }
  if (result.model.misfit > options.largest_misfit)
    result.warnings.push_back({.kind = Kind::misfit, .value = result.model.misfit});
  warn_of_short_blocks(options, result);
  if (result.unexplained.empty()) return;
  const auto& worst = result.unexplained.front();
  const auto& r = result.responses;
  std::vector<std::pair<Index, Index>> entries;
  for (const auto& part : result.unexplained) entries.emplace_back(part.output, part.input);
  std::ranges::sort(entries);
  const auto count =
      static_cast<std::int64_t>(std::unique(entries.begin(), entries.end()) - entries.begin());
  result.warnings.push_back(
      {.kind = Kind::unexplained,
       .value = worst.level,
       .from = worst.from,
       .to = worst.to,
       .smooth = worst.smooth,
       .share = worst.share,
       .output = r.outputs[static_cast<std::size_t>(worst.output)].name,
       .input = r.excitation.empty() ? r.inputs[static_cast<std::size_t>(worst.input)].name : "",
       .count = count,
       .total = static_cast<std::int64_t>(numbers_per_line(r))});
}

}  // namespace hydrapod::identification
