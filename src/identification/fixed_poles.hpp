#pragma once
/// Shapes and residual terms of given poles: the linear part of fit_modes(), alone. The page fits
/// the poles that its reader chooses with it. Private to the module and to the core of the page.

#include <vector>

#include "fit_system.hpp"

namespace hydrapod::identification {

/// λ and L of `poles`, the largest element of each L made 1.
SharedParameters shared_parameters(const std::vector<PoleEstimate>& poles, Eigen::Index inputs);

/// Modes, residual terms, sum of squares and error of a `state` that `system` has solved; without
/// deviations and significance.
ModalModel model_of(const FitSystem& system, const FrequencyResponses& responses,
                    const FitState& state);

}  // namespace hydrapod::identification
