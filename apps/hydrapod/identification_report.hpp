#pragma once
/// Tables that `hydrapod identify` prints.

#include <string>

#include "hydrapod/tasks/measurement.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

std::string modes_text(const tasks::Identified& found, const TableStyle& style);

std::string comparison_text(const report::ComparedModes& compared,
                            const identification::Identification& result, const TableStyle& style);

std::string output_only_text(const std::vector<identification::OutputOnlyMode>& modes,
                             std::size_t outputs, int block, const TableStyle& style);

}  // namespace hydrapod::cli
