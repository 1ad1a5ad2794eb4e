#pragma once
/// What can be wrong with channels before and after an estimate. Private to the module.

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

/// Responses without lines: channels, averages and warnings of the choice, which loses its dead
/// outputs and inputs that repeat another. Throws base::ComputationError.
FrequencyResponses without_lines(const CrossSpectra& spectra, Estimator estimator,
                                 ChannelChoice& choice);

/// Rounding must not leave a negative variance in V, the spectrum of what H does not explain.
void keep_positive(const CrossSpectra& spectra, Eigen::Index line, const std::vector<int>& outputs,
                   Eigen::MatrixXcd& V);

/// A warning for each channel that stands at its limits too often.
void warn_of_limits(const CrossSpectra& spectra, const std::vector<int>& channels,
                    std::vector<data::ResponseWarning>& warnings);

/// Per line, the condition of the matrix of `inputs` against `others` (themselves, or the
/// instruments), each scaled to its level; infinite where one of them is not excited.
Eigen::VectorXd input_conditions(const CrossSpectra& spectra, const std::vector<int>& inputs,
                                 const std::vector<int>& others);

/// Condition beyond which a line is left out.
inline constexpr double singular_condition = 1e8;

/// Coherences and input densities of a line.
struct LineQuality {
  Eigen::MatrixXd coherence{};
  Eigen::VectorXd multiple_coherence{}, input_density{};
};
/// V: what H does not explain.
LineQuality quality_of(const CrossSpectra& spectra, Eigen::Index line, const ChannelChoice& choice,
                       const Eigen::MatrixXcd& V);

/// Warnings about the whole; throws base::ComputationError when no line is left.
void finish_checks(const CrossSpectra& spectra, const ChannelChoice& choice,
                   FrequencyResponses& responses);

}  // namespace hydrapod::identification
