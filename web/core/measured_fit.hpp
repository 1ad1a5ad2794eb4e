#pragma once
/// The fit of poles that the reader of the page chooses, to the measured responses that the page
/// shows: the library's, with the poles and participations held.

#include <span>
#include <vector>

#include "hydrapod/report/json.hpp"
#include "identification/fit_system.hpp"

namespace hydrapod::page {

class MeasuredFit {
 public:
  /// `{ "outputs", "inputs", "lines", "deviations": are they known?, "shift" [1/s],
  /// "residual_terms": as many as the identification has, 0: those of FitOptions, "window": of how
  /// many values, "duration" [s], "correlation": are the errors of inputs correlated? }`.
  /// `numbers`: frequencies [Hz]; by output and input Re H of all lines, Im H of all lines and the
  /// deviations where they are known; where errors of inputs are correlated, by pairs i < j Re and
  /// Im of their correlation; ρ − 1 of the window at even lags. Throws std::invalid_argument for
  /// what is no measurement.
  MeasuredFit(const report::Json& shape, std::span<const double> numbers);
  MeasuredFit(const MeasuredFit&) = delete;
  MeasuredFit& operator=(const MeasuredFit&) = delete;

  /// `{ "poles": [{ "pole": { "re", "im" } [1/s], "participation": { "re": […], "im": […] } }] }`.
  /// The answer: the error of the synthesised responses; by pole and output the shape: re, im, with
  /// the largest element of the participation made 1; by output, input and line the model with the
  /// effect of the window: re, im. Throws std::invalid_argument for what is no pole.
  std::vector<double> fit(const report::Json& request);

 private:
  identification::FrequencyResponses responses_;
  identification::FitSystem system_;  // refers to the responses
  identification::FitState last_{};   // of the poles asked for last
};

}  // namespace hydrapod::page
