#pragma once
/// `hydrapod modes --system`: poles of mechanics, hydraulics and controller together.

#include "hydrapod/machine_arguments.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

struct SystemArguments {
  bool system{};
  bool open_loop{};          ///< without the controller
  std::string root_locus{};  ///< `KEY=from:to:count`
  int pade{simulation::default_pade_order};
  std::string plot{};  ///< of the root locus
};

/// Adds --system, --open-loop, --root-locus, --pade and --plot.
void add_system_options(Command command, SystemArguments& arguments);

/// What `hydrapod modes` prints with --system, --open-loop or --root-locus; `format` is that of
/// modes: 0 table, 1 JSON, 2 CSV.
std::string system_modes_text(const MachineArguments& machine, const SystemArguments& system,
                              std::size_t format, const TableStyle& style);

}  // namespace hydrapod::cli
