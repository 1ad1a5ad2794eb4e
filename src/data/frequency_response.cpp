#include "hydrapod/data/frequency_response.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace hydrapod::data {

namespace {

[[noreturn]] void refuse_responses(const std::string& what) {
  throw std::invalid_argument("frequency response: " + what);
}

void require_channels(const std::vector<Channel>& channels, const char* what) {
  RecordHeader header;
  header.channels = channels;
  header.sample_rate = 1.0;
  try {
    validate(header);
  } catch (const std::invalid_argument& error) {
    refuse_responses(fmt::format("{}: {}", what, error.what()));
  }
}

constexpr std::array<std::string_view, 5> estimator_names{"h1", "h2", "hv", "iv", "half-spectra"};

}  // namespace

std::string_view estimator_text(Estimator estimator) {
  return estimator_names[static_cast<std::size_t>(estimator)];
}

std::optional<Estimator> estimator_from_text(std::string_view text) {
  for (std::size_t i = 0; i < estimator_names.size(); ++i)
    if (estimator_names[i] == text) return static_cast<Estimator>(i);
  return {};
}

double FrequencyResponses::variance(std::size_t line, Eigen::Index output,
                                    Eigen::Index input) const {
  return noise[line](output, output).real() * input_factor[line](input, input).real();
}

void validate(const FrequencyResponses& responses) {
  require_channels(responses.outputs, "outputs");
  require_channels(responses.inputs, "inputs");
  const auto lines = responses.lines();
  const auto outputs = static_cast<Eigen::Index>(responses.outputs.size());
  const auto inputs = static_cast<Eigen::Index>(responses.inputs.size());
  if (lines == 0) refuse_responses("has no frequency");
  const auto& frequency = responses.frequency;
  for (std::size_t k = 0; k < lines; ++k)
    if (!std::isfinite(frequency[k]) || frequency[k] < 0.0 ||
        (k > 0 && frequency[k] <= frequency[k - 1]))
      refuse_responses(fmt::format("frequency {} is {} Hz; they must be finite and ascend", k + 1,
                                   frequency[k]));
  if (responses.H.size() != lines)
    refuse_responses(fmt::format("{} matrices for {} frequencies", responses.H.size(), lines));
  const auto fits = [&](const auto& matrices, Eigen::Index rows, Eigen::Index columns) {
    return (matrices.empty() || matrices.size() == lines) &&
           std::ranges::all_of(matrices, [&](const auto& matrix) {
             return matrix.rows() == rows && matrix.cols() == columns;
           });
  };
  for (const auto& H : responses.H)
    if (H.rows() != outputs || H.cols() != inputs)
      refuse_responses(fmt::format("a matrix is {} × {} for {} outputs and {} inputs", H.rows(),
                                   H.cols(), outputs, inputs));
  if (!responses.id_lines.empty() &&
      responses.id_lines.size() != static_cast<std::size_t>(outputs * inputs))
    refuse_responses("the lines of text are not one list per response");
  if (!fits(responses.on_axis, outputs, inputs))
    refuse_responses("the responses on the axis are not outputs × inputs");
  if (!responses.on_axis.empty() && !(responses.shift > 0.0))
    refuse_responses("there are responses on the axis beside those that are there already");
  if (responses.taper.size() > 0 && !(responses.sample_rate > 0.0))
    refuse_responses("the taper has no sample rate");
  if (!fits(responses.multiple_coherence, outputs, 1))
    refuse_responses("the coherence is not frequency × output");
  if (!fits(responses.noise, outputs, outputs))
    refuse_responses("the noise is not outputs × outputs");
  if (!fits(responses.input_factor, inputs, inputs) ||
      responses.input_factor.size() != responses.noise.size())
    refuse_responses("the input factor is not inputs × inputs, or without noise");
}

FrequencyResponses brought_to_axis(FrequencyResponses responses) {
  if (responses.on_axis.empty()) return responses;
  responses.H = std::exchange(responses.on_axis, {});
  responses.shift = 0.0;
  return responses;
}

}  // namespace hydrapod::data
