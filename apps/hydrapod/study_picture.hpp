#pragma once
/// The heat map of a grid over two inputs.

#include <string>
#include <vector>

#include "hydrapod/tasks/study.hpp"

namespace hydrapod::cli {

/// Draws the output `value`, one of `values` a row. `ranges`: as they were written, whose units the
/// axes have. A requirement for this output is drawn as a contour.
void plot_map(const tasks::StudyJob& job, const std::vector<std::string>& ranges,
              const std::string& value, const std::vector<double>& values, const std::string& path);

}  // namespace hydrapod::cli
