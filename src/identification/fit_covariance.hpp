#pragma once
/// Standard deviations of a fitted modal model. Private to the module.

#include "fit_system.hpp"

namespace hydrapod::identification {

/// Derivative of the best own parameters by the shared ones, with the other sign: N_oo⁻¹ N_os.
Eigen::MatrixXd own_by_shared(const Eigen::MatrixXd& normal, Eigen::Index shared);

/// Noise that neighbouring lines share counts that often.
double lines_in_step(const FrequencyResponses& responses);

/// H of the model at a line of the responses, with the window's effect that is in `lines`.
Eigen::MatrixXcd modelled(const ModalModel& model, const std::vector<PoleLines>& lines,
                          Eigen::Index line, const FrequencyResponses& responses);

/// Puts the deviations into the modes of `model`. `misfit`: Σ|residual|² over the degrees of
/// freedom; where it is above 1 all variances grow with it, and without known errors it is what
/// they are.
void add_deviations(const FitSystem& system, const FrequencyResponses& responses,
                    const FitState& state, const FitOptions& options, double misfit,
                    ModalModel& model);

}  // namespace hydrapod::identification
