#include "hydrapod/data/frequency_response.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace hydrapod::data {

namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("frequency response: " + what);
}

void require_channels(const std::vector<Channel>& channels, const char* what) {
  RecordHeader header;
  header.channels = channels;
  header.sample_rate = 1.0;
  try {
    validate(header);
  } catch (const std::invalid_argument& error) {
    refuse(fmt::format("{}: {}", what, error.what()));
  }
}

}  // namespace

void validate(const FrequencyResponse& response) {
  require_channels(response.outputs, "outputs");
  require_channels(response.inputs, "inputs");
  const auto lines = static_cast<std::size_t>(response.frequency.size());
  const auto outputs = static_cast<Eigen::Index>(response.outputs.size());
  const auto inputs = static_cast<Eigen::Index>(response.inputs.size());
  if (lines == 0) refuse("has no frequency");
  for (Eigen::Index k = 0; k < response.frequency.size(); ++k)
    if (!std::isfinite(response.frequency[k]) || response.frequency[k] < 0.0 ||
        (k > 0 && response.frequency[k] <= response.frequency[k - 1]))
      refuse(fmt::format("frequency {} is {} Hz; they must be finite and ascend", k + 1,
                         response.frequency[k]));
  if (response.response.size() != lines)
    refuse(fmt::format("{} matrices for {} frequencies", response.response.size(), lines));
  for (const auto& H : response.response)
    if (H.rows() != outputs || H.cols() != inputs)
      refuse(fmt::format("a matrix is {} × {} for {} outputs and {} inputs", H.rows(), H.cols(),
                         outputs, inputs));
  if (response.coherence.size() > 0 && (response.coherence.rows() != response.frequency.size() ||
                                        response.coherence.cols() != outputs))
    refuse("the coherence is not frequency × output");
  if (!response.variance.empty() && response.variance.size() != lines)
    refuse("the variance has another number of frequencies");
  for (const auto& variance : response.variance)
    if (variance.rows() != outputs || variance.cols() != inputs)
      refuse("a variance is not outputs × inputs");
}

}  // namespace hydrapod::data
