#pragma once
/// Frequency responses of several inputs and outputs, and their Universal Files.
///
/// H(f): output o per input i, in the units of the channels. Coherence and variance come from the
/// estimator and may be absent.

#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/data/record.hpp"

namespace hydrapod::data {

struct FrequencyResponse {
  std::string title{};
  std::string date{};  ///< ISO 8601
  std::vector<Channel> outputs{};
  std::vector<Channel> inputs{};             ///< references
  Eigen::VectorXd frequency{};               ///< [Hz], ascending
  std::vector<Eigen::MatrixXcd> response{};  ///< per frequency: outputs × inputs
  /// Multiple coherence of each output with all inputs, 0 … 1: frequency × output; or empty.
  Eigen::MatrixXd coherence{};
  /// Variance of H, E|δH|² [unit²]: per frequency, outputs × inputs; or empty.
  std::vector<Eigen::MatrixXd> variance{};
};

/// Throws std::invalid_argument naming what does not fit: sizes, frequencies that do not ascend or
/// are not finite, channels as validate(RecordHeader) has them.
void validate(const FrequencyResponse& response);

/// Datasets 151, 164 and per output and input one dataset 58 (type 4, complex double; multiple
/// coherence type 26, variance type 0 with "variance" as its fifth line). Frequencies even within
/// 1e-6 of their spacing are written as such, others one by one (to six digits). `binary`: 58b.
/// Written whole or not at all. Throws as base::write_file_whole.
void write_frequency_response(const std::string& path, const FrequencyResponse& response,
                              bool binary = true);

struct ReadFrequencyResponseResult {
  FrequencyResponse response{};
  std::vector<base::Diagnostic> notes{};
};

/// All functions of type 4 that share the first one's frequencies, with their coherences and
/// variances. Units become SI: labels that are known, else dataset 164. A pair of output and input
/// that is not in the file is NaN. Throws base::InputError.
ReadFrequencyResponseResult read_frequency_response(const std::string& path);

}  // namespace hydrapod::data
