#pragma once
/// Frequency responses with known errors, line by line.

#include "exact/modal_system.hpp"
#include "hydrapod/identification/responses.hpp"

namespace hydrapod::identification {

/// Adds the line at this frequency [Hz]: H with errors of `share` of each of its rows, which are
/// independent and whose size the responses state.
void add_line_with_errors(double frequency, Eigen::MatrixXcd H, double share, test::Random& random,
                          FrequencyResponses& r);

}  // namespace hydrapod::identification
