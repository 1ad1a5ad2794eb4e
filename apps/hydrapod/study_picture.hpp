#pragma once
/// The heat map of a grid over two inputs.

#include <string>
#include <vector>

#include "hydrapod/study_rows.hpp"

namespace hydrapod::cli {

/// Draws the output `value` of the rows. `ranges`: as they were written, whose units the axes have.
/// A requirement for this output is drawn as a contour, and so is the end of the stroke.
void plot_map(const tasks::StudyJob& job, const std::vector<std::string>& ranges,
              const std::string& value, const StudyRows& rows, const std::string& path);

}  // namespace hydrapod::cli
