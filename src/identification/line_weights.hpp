#pragma once
/// How much a line counts. Private to the module.

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

/// Mean over the lines up to `reach` away, per line.
Eigen::VectorXd running_mean(const Eigen::VectorXd& values, Eigen::Index reach);

/// Complex numbers that a line holds: a response each, or of a whole record an output each.
double numbers_per_line(const FrequencyResponses& responses);

/// Mean of |H|²/variance over entries and over the lines up to `reach` away, per line.
Eigen::VectorXd signal_to_noise(const FrequencyResponses& responses, Eigen::Index reach);

/// Root mean square of H per output.
Eigen::VectorXd row_sizes(const FrequencyResponses& responses);

/// w² per line and output (input, if `transposed`): one over the variance, averaged over the row
/// and over a few lines; without known errors one over the mean square of the row plus
/// its median over the lines.
Eigen::MatrixXd row_weights(const FrequencyResponses& responses, bool transposed);

}  // namespace hydrapod::identification
