#pragma once
/// What a grid of poses reaches. Private to the module.

#include <optional>

#include "hydrapod/study/study.hpp"

namespace hydrapod::study {

/// None: there is no grid, its values do not ascend, or rows are missing.
std::optional<ReachedPart> reached_part(const Spool& spool, const Problem& problem,
                                        const Plan& plan);

}  // namespace hydrapod::study
