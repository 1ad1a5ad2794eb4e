#include <fmt/format.h>

#include <cstdio>
#include <iostream>
#include <memory>

#include "hydrapod/base/file.hpp"
#include "hydrapod/commands.hpp"
#include "hydrapod/kinematics/check_machine.hpp"
#include "hydrapod/machine_arguments.hpp"
#include "hydrapod/mode_report.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  MachineArguments machine{};
  std::string format{"table"};
  std::string output{"-"};
  bool matrices{};
};

/// The same table without the overrides, to show what they change.
std::optional<modal::ModeTable> before_overrides(const Arguments& arguments) {
  if (arguments.machine.overrides.empty()) return {};
  try {
    const auto file =
        model::read_machine_file(arguments.machine.file, {}, kinematics::check_machine);
    const auto pose = choose_pose(file.machine, arguments.machine.pose);
    dynamics::ModelKind kind = choose_model(file.machine, "");
    if (!arguments.machine.model.empty() && arguments.machine.model != "full")
      kind = choose_model(file.machine, arguments.machine.model);
    return modal::mode_table(file.machine, pose.X_BP, kind);
  } catch (const std::exception&) {
    return {};  // the file alone may be unsound or buckled; the overrides mend it
  }
}

std::string json_text(const Arguments& arguments, const model::MachineFile& file,
                      const report::PoseChoice& pose, const modal::ModeTable& table) {
  report::Json json{{"kind", "modes"},
                    {"machine", report::machine_json(file, arguments.machine.file)},
                    {"assumptions", report::assumptions_json(file.machine)},
                    {"pose", report::pose_json(pose)}};
  json.update(report::modes_json(table));
  if (arguments.matrices) json["matrices"] = report::matrices_json(table);
  return json.dump(1) + "\n";
}

std::string table_text(const Arguments& arguments, const model::MachineFile& file,
                       const report::PoseChoice& pose, const modal::ModeTable& table) {
  const bool colour = arguments.output == "-" && has_colour(stdout);
  const bool from_stdin = arguments.machine.file == "-";
  const auto before = from_stdin ? std::nullopt : before_overrides(arguments);
  return heading(file.machine, pose, table, colour) + "\n" +
         mode_text(table, before ? &*before : nullptr, colour) + "\n" + answer_text(table);
}

void run(const Arguments& arguments) {
  const size_t format = choose_word("--format", arguments.format, {"table", "json", "csv"});
  const auto file = load(arguments.machine);
  const auto pose = choose_pose(file.machine, arguments.machine.pose);
  const auto kind = choose_model(file.machine, arguments.machine.model);
  const auto table = modal::mode_table(file.machine, pose.X_BP, kind);
  base::write_file_whole(arguments.output, format == 0   ? table_text(arguments, file, pose, table)
                                           : format == 1 ? json_text(arguments, file, pose, table)
                                                         : mode_csv(table));
}

}  // namespace

void add_modes(CLI::App& app) {
  CLI::App* command =
      add_command(app, "modes", "Modes of the machine, rigid beside rigid-flexible",
                  {{"modes machine.toml", "which modes, what moves, where the energy is"},
                   {"modes machine.toml --pose \"z=100 mm, ry=5 deg\"", "at another pose"},
                   {"modes machine.toml --model rigid", "the six rigid modes alone"},
                   {"modes machine.toml --set legs.guide_sleeve.stiffness=\"2e6 N/m\"",
                    "what stiffer seals would change"},
                   {"modes machine.toml --format json --matrices -o modes.json",
                    "everything, for other programs"}});
  auto arguments = std::make_shared<Arguments>();
  add_machine_options(*command, arguments->machine);
  add_pose_option(*command, arguments->machine);
  add_model_option(*command, arguments->machine);
  command->add_option("--format", arguments->format, "table, json or csv")->capture_default_str();
  command->add_flag("--matrices", arguments->matrices, "Put M, K and C into the JSON");
  command->add_option("-o,--output", arguments->output, "File to write; - prints")
      ->capture_default_str();
  command->callback([arguments] { run(*arguments); });
}

}  // namespace hydrapod::cli
