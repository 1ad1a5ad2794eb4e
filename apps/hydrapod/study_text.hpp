#pragma once
/// What `hydrapod montecarlo`, `sweep` and `map` print of their results.

#include <string>

#include "hydrapod/tasks/study.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

/// Table of the outputs, statuses, requirements and indices.
std::string summary_text(const tasks::StudyJob& job, const study::Summary& summary,
                         const TableStyle& style);

/// Where a map has its extremes; of others empty. A drop means little without the share of the
/// motion that it is of.
std::string extremes_text(const tasks::StudyJob& job, const study::Summary& summary);

/// The row with the worst value of each requirement; none where no row has one.
std::string worst_text(const tasks::StudyJob& job, const study::Summary& summary);

}  // namespace hydrapod::cli
