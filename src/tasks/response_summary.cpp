#include <algorithm>
#include <cmath>

#include "hydrapod/tasks/measurement.hpp"

#include <fmt/format.h>

#include "hydrapod/base/error.hpp"
#include "hydrapod/numerics/statistics.hpp"

namespace hydrapod::tasks {

namespace {

ResponseSummary::Output output_summary(const identification::FrequencyResponses& r,
                                       Eigen::Index output) {
  ResponseSummary::Output result;
  std::vector<double> coherence;
  double largest = 0.0;
  for (std::size_t k = 0; k < r.lines(); ++k) {
    if (!r.multiple_coherence.empty()) coherence.push_back(r.multiple_coherence[k][output]);
    for (std::size_t i = 0; i < r.inputs.size(); ++i) {
      const auto input = static_cast<Eigen::Index>(i);
      const double density = r.input_density.empty() ? 1.0 : r.input_density[k][input];
      const double size = std::abs(r.H[k](output, input)) * std::sqrt(density);
      if (size <= largest) continue;
      largest = size;
      result.line = k;
      result.input = i;
    }
  }
  if (!coherence.empty()) {
    result.median_coherence = numerics::upper_median(coherence);
    result.lowest_coherence = *std::ranges::min_element(coherence);
  }
  result.magnitude = std::abs(r.H[result.line](output, static_cast<Eigen::Index>(result.input)));
  if (r.has_errors())
    result.deviation = std::sqrt(
        r.variance(result.line, static_cast<int>(output), static_cast<int>(result.input)));
  return result;
}

}  // namespace

ResponseSummary summary_of(const identification::FrequencyResponses& responses) {
  ResponseSummary summary;
  for (std::size_t o = 0; responses.lines() > 0 && o < responses.outputs.size(); ++o)
    summary.outputs.push_back(output_summary(responses, static_cast<Eigen::Index>(o)));
  if (responses.condition.empty()) return summary;
  summary.median_condition = numerics::upper_median(responses.condition);
  summary.largest_condition = *std::ranges::max_element(responses.condition);
  return summary;
}

identification::FrequencyResponses shared_responses(const Measured& measured,
                                                    const Progress& progress) {
  const auto& responses = measured.responses();
  if (!(responses.shift > 0.0)) return responses;
  // those of files were brought there by modes already; those of hits are cut off at the end
  if (!responses.on_axis.empty() && !measured.records) return responses;
  try {
    const auto found = identification::identify_modes(responses, {}, [&](double share) {
      if (progress) progress(share);
    });
    if (!found.modes.empty()) {
      auto shared = responses;
      shared.on_axis = identification::on_imaginary_axis(responses, found);
      return shared;
    }
  } catch (const base::ComputationError&) {
    // no modes, as above
  }
  if (!responses.on_axis.empty()) return responses;
  const auto& m = measured.measurement;
  if (!measured.records)
    throw base::ComputationError(fmt::format(
        "the responses are at a + iω, a = {:.4g} 1/s, and have no mode to bring them to iω by",
        responses.shift));
  return identification::estimate_responses(m.spectra, m.choice, responses.estimator);
}

}  // namespace hydrapod::tasks
