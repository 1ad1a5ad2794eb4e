#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "hydrapod/base/file.hpp"
#include "hydrapod/calibration_report.hpp"
#include "hydrapod/commands.hpp"
#include "hydrapod/machine_arguments.hpp"
#include "hydrapod/report/calibration.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  MachineArguments machine{};
  std::vector<std::string> parameters{};
  std::string format{"table"};
  std::string output{"-"};
  std::string plot{};
};

void check_paths(const Arguments& arguments, const model::MachineFile& file) {
  const model::VariableMachine machine(file);
  std::vector<base::Diagnostic> errors;
  for (const auto& path : arguments.parameters) {
    const auto* number = machine.find(path);
    const std::string near = machine.nearest_path(path);
    if (number == nullptr)
      errors.push_back(
          {.file = "--parameter " + path,
           .message = "the machine file has no such number" +
                      (near.empty() ? "" : fmt::format("; did you mean `{}`?", near))});
    if (number != nullptr && number->value == 0.0)
      errors.push_back(
          {.file = "--parameter " + path, .message = "is 0, and has no change in per cent"});
  }
  if (!errors.empty()) throw base::InputError(errors);
}

/// Position of the pose in the machine, which gets it when it is none of its own.
std::size_t pose_index(model::MachineFile& file, const std::string& text) {
  const auto pose = choose_pose(file.machine, text);
  for (std::size_t k = 0; k < file.machine.poses.size(); ++k)
    if (file.machine.poses[k].name == pose.name) return k;
  file.machine.poses.push_back({"asked-for", pose.X_BP});
  return file.machine.poses.size() - 1;
}

void run(const Arguments& arguments) {
  const auto format = choose_word("--format", arguments.format, {"table", "json", "csv"});
  auto file = load(arguments.machine);
  const auto given = file;
  check_paths(arguments, file);
  const auto kind = choose_model(file.machine, arguments.machine.model);
  const auto pose = choose_pose(file.machine, arguments.machine.pose);
  const auto index = pose_index(file, arguments.machine.pose);
  const auto result = calibration::sensitivities(file, index, kind, arguments.parameters);
  const std::string title =
      fmt::format("{}, pose {}, {} model", file.machine.name, pose.name, dynamics::name(kind));
  if (!arguments.plot.empty()) report::plot_sensitivities(result, title, arguments.plot);
  std::string text;
  if (format == 0) {
    const bool to_terminal = arguments.output == "-";
    const bool colour = to_terminal && has_colour(stdout);
    text = styled(title, Style::bold, colour) + "\n\n" +
           sensitivity_text(result, colour, to_terminal ? terminal_width() : Table::unlimited) +
           "\nOf repeated modes each is shown as it parts from the others along the parameter that "
           "splits them most.\n";
  } else if (format == 1) {
    report::Json json{{"kind", "sensitivity"},
                      {"machine", report::machine_json(given, arguments.machine.file)},
                      {"assumptions", report::assumptions_json(given.machine)},
                      {"pose", report::pose_json(pose)},
                      {"model", dynamics::name(kind)}};
    json.update(report::sensitivity_json(result));
    text = json.dump(1) + "\n";
  } else {
    text = sensitivity_csv(result);
  }
  base::write_file_whole(arguments.output, text);
}

}  // namespace

void add_sensitivity(Command app) {
  Command command = add_command(
      app, "sensitivity", "How much each number of the machine file changes each frequency",
      {{"sensitivity machine.toml", "all modes against all numbers, in per cent per per cent"},
       {"sensitivity machine.toml --parameter legs.guide_sleeve.stiffness --parameter "
        "legs.oil_spring.cylinder.bulk_modulus",
        "seals against oil"},
       {"sensitivity machine.toml --pose \"z=100 mm\" --plot map.svg",
        "at another pose, as a heat map"}});
  auto arguments = std::make_shared<Arguments>();
  add_machine_options(command, arguments->machine);
  add_pose_option(command, arguments->machine);
  add_model_option(command, arguments->machine);
  command.add_option("--parameter", arguments->parameters,
                     "Only this number (PATH); may be repeated");
  command.add_option("--format", arguments->format, "table, json or csv").capture_default_str();
  command.add_option("-o,--output", arguments->output, "File to write; - prints")
      .capture_default_str();
  command.add_option("--plot", arguments->plot, "Draw a heat map: .svg, .png or .pdf");
  command.callback([arguments] { run(*arguments); });
}

}  // namespace hydrapod::cli
