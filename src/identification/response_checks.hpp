#pragma once
/// What can be wrong with channels before and after an estimate. Private to the module.

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

/// When a channel or an estimate deserves a warning.
struct ResponseCheckOptions {
  /// Two inputs are one where their coherence over all lines > same_signal: different sensors of
  /// one motion have more noise than that.
  double same_signal{0.99999};
  /// Inputs are correlated where the median condition > correlated · what chance gives independent
  /// ones: then intervals are wider than independent inputs would make them.
  double correlated{3.0};
  /// … over the lines at which each input has more than this share of its largest density.
  double excited{1e-4};
  /// A channel is clipped where few_at_limit or more samples, and a share > rare_at_limit, stand at
  /// its limit: fewer may be chance, but in flat tops. A signal with two_levels or more there is
  /// meant so.
  std::int64_t few_at_limit{10};
  double rare_at_limit{1e-4}, two_levels{0.5};
  /// The excitation ends within the band where its highest line < pass_band · half the sample rate:
  /// above, filters of the recorder end it.
  double pass_band{0.7};
  /// … or two lines are further apart than lines_missing · the spacing. A single line left out
  /// beside a resonance makes it 2.
  double lines_missing{4.5};
  /// … or it begins above line lowest_lines of the spectra: the first ones are left out in any
  /// case.
  double lowest_lines{40.0};
  bool of_averages{true};  ///< false: responses do not come from averages, which may be few
};

/// Responses without lines: channels, averages and warnings of the choice, which loses its dead
/// outputs and inputs that repeat another. Throws base::ComputationError.
FrequencyResponses without_lines(const CrossSpectra& spectra, Estimator estimator,
                                 ChannelChoice& choice, const ResponseCheckOptions& options = {});

/// Rounding must not leave a negative variance in V, the spectrum of what H does not explain.
void keep_positive(const CrossSpectra& spectra, Eigen::Index line, const std::vector<int>& outputs,
                   Eigen::MatrixXcd& V);

/// A warning for each channel that stands at its limits too often; `rms`: of all channels.
void warn_of_limits(const CrossSpectra& spectra, const Eigen::VectorXd& rms,
                    const std::vector<int>& channels, std::vector<data::ResponseWarning>& warnings,
                    const ResponseCheckOptions& options = {});

/// RMS of a channel about its mean, by its spectrum.
double rms_in(const CrossSpectra& spectra, int channel);
Eigen::VectorXd rms_of_all(const CrossSpectra& spectra);

/// A warning for each channel that has the samples of one before it.
void warn_of_repeated(const CrossSpectra& spectra, const std::vector<int>& outputs,
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
                   FrequencyResponses& responses, const ResponseCheckOptions& options = {});

}  // namespace hydrapod::identification
