#pragma once
/// Platform receptance by eliminating the legs' blocks; see response/frequency_response.hpp.

#include "hydrapod/response/frequency_response.hpp"

namespace hydrapod::response {

/// Displacement responses into `out` (same size as `omega`); entries that met a vanishing pivot are
/// NaN.
void eliminate(const ResponseModel& model, std::span<const double> omega, std::span<Matrix6c> out);

/// The same of a model with arms.
void eliminate_relaxing(const ResponseModel& model, std::span<const double> omega,
                        std::span<Matrix6c> out);

/// The same where dampers and modal ratios couple all coordinates, `C` being the whole damping
/// matrix. Returns the lines at which a pivot came near zero: they need another method.
std::vector<std::size_t> eliminate_whole(const ResponseModel& model, const ModelMatrix& C,
                                         std::span<const double> omega, std::span<Matrix6c> out);

}  // namespace hydrapod::response
