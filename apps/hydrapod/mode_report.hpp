#pragma once
/// Mode tables as people read them.

#include <string>

#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/tasks/machine.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

/// Machine, pose, model and assumptions in two lines.
std::string heading(const tasks::Machine& machine, bool colour);

/// The table of `table`; with `before`, also the change of every mode against it.
std::string mode_text(const modal::ModeTable& table, const modal::ModeTable* before,
                      const TableStyle& style);

/// One line per mode, all fields; a header line names them with units.
std::string mode_csv(const modal::ModeTable& table);

}  // namespace hydrapod::cli
