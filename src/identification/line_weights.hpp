#pragma once
/// How much a line counts. Private to the module.

#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

/// w² per line and output (input, if `transposed`): one over the variance, averaged over the row
/// and over a few lines; without known errors one over the mean square of the row plus
/// its median over the lines.
Eigen::MatrixXd row_weights(const FrequencyResponses& responses, bool transposed);

}  // namespace hydrapod::identification
