#include "hydrapod/command.hpp"

#include <optional>

#include "hydrapod/report/json.hpp"
#include "hydrapod/reports.hpp"
#include "hydrapod/system_modes.hpp"
#include "hydrapod/tasks/linear.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  MachineArguments machine{};
  std::string format{"table"};
  std::string output{"-"};
  bool matrices{};
  SystemArguments system{};
};

std::string mode_json(const tasks::Machine& machine, const modal::ModeTable& table, bool matrices) {
  auto json = report::modes_json(table);
  if (matrices) json["matrices"] = report::matrices_json(table);
  return json_text(report::head_json("modes", machine), json);
}

std::string table_text(const tasks::Machine& machine, const modal::ModeTable& table,
                       const TableStyle& style) {
  std::optional<modal::ModeTable> before;
  std::string note;
  try {
    before = tasks::modes_without_overrides(machine);
  } catch (const std::exception&) {  // it may be unsound or buckled, and --set mends it
    note = "\nthe change by --set is not shown: without it the file has no modes at this pose\n";
  }
  return heading(machine, style) + "\n" + mode_text(table, before ? &*before : nullptr, style) +
         note + "\n" + report::answer_text(table);
}

void run(const Arguments& arguments) {
  const size_t format = choose_word("--format", arguments.format, {"table", "json", "csv"});
  const auto& system = arguments.system;
  const auto style = table_style(arguments.output);
  if (!system.plot.empty() && system.root_locus.empty())
    base::refuse("--plot " + system.plot,
                 "needs --root-locus; `hydrapod report` shows moving modes");
  if (system.system || system.open_loop || !system.root_locus.empty()) {
    if (arguments.matrices)
      base::refuse("--matrices", "M, K and C are those of the mechanics; leave --system out");
    return base::write_file_whole(arguments.output,
                                  system_modes_text(arguments.machine, system, format, style));
  }
  if (arguments.matrices && arguments.format != "json")
    base::refuse("--matrices", "matrices are part of the JSON; add --format json");
  const auto machine = load(arguments.machine);
  const auto table = tasks::modes(machine);
  base::write_file_whole(arguments.output, format == 0 ? table_text(machine, table, style)
                                           : format == 1
                                               ? mode_json(machine, table, arguments.matrices)
                                               : mode_csv(table));
}

}  // namespace

void add_modes(Command app) {
  Command command = add_command(
      app, "modes",
      "Modes of the machine with rigid and with flexible legs; poles with hydraulics and "
      "controller",
      {{"modes machine.toml", "frequencies, motion, energy shares"},
       {"modes machine.toml --pose \"z=100 mm, ry=5 deg\"", "at another pose"},
       {"modes machine.toml --model rigid", "the six modes of the rigid-leg model"},
       {"modes machine.toml --set legs.guide_sleeve.stiffness=\"2e6 N/m\"",
        "effect of stiffer seals"},
       {"modes machine.toml --system", "poles with hydraulics and controller; stability"},
       {"modes machine.toml --open-loop", "the same without the controller"},
       {"modes machine.toml --root-locus controller.gain=5:80:16 --plot locus.svg",
        "these poles as functions of the gain"},
       {"modes machine.toml --format json --matrices -o modes.json", "all results as JSON"}});
  auto& arguments = command.calls(&run);
  add_subject_options(command, arguments.machine);
  command.add_options(
      {{"--format", arguments.format, "table, json or csv"},
       {"--matrices", arguments.matrices, "Put M, K and C into the JSON (with --format json)"}});
  add_system_options(command, arguments.system);
  command.add_options({{"-o,--output", arguments.output, "File to write; - prints"}});
}

}  // namespace hydrapod::cli
