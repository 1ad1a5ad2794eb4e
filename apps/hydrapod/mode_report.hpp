#pragma once
/// Mode tables as people read them.

#include <cstddef>
#include <string>

#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/report/json.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

/// Machine, pose, model and assumptions in two lines.
std::string heading(const model::Machine& machine, const report::PoseChoice& pose,
                    const modal::ModeTable& table, bool colour);

/// The table of `table`; with `before`, also the change of every mode against it. Tables wider than
/// `width` columns are split.
std::string mode_text(const modal::ModeTable& table, const modal::ModeTable* before, bool colour,
                      std::size_t width = Table::unlimited);

/// One line per mode, all fields; a header line names them with units.
std::string mode_csv(const modal::ModeTable& table);

}  // namespace hydrapod::cli
