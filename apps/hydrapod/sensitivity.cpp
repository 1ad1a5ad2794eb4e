#include <fmt/format.h>

#include <memory>

#include "hydrapod/base/file.hpp"
#include "hydrapod/calibration_report.hpp"
#include "hydrapod/commands.hpp"
#include "hydrapod/machine_arguments.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/tasks/linear.hpp"
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

void run(const Arguments& arguments) {
  const auto format = choose_word("--format", arguments.format, {"table", "json", "csv"});
  const auto machine = load(arguments.machine);
  const auto result = tasks::sensitivity(machine, {.parameters = arguments.parameters});
  const std::string title = fmt::format("{}, pose {}, {} model", machine.file.machine.name,
                                        machine.pose.name, dynamics::name(machine.kind));
  if (!arguments.plot.empty()) report::plot_sensitivities(result, title, arguments.plot);
  std::string text;
  if (format == 0) {
    const auto style = table_style(arguments.output);
    text = styled(title, Style::bold, style.colour) + "\n\n" + sensitivity_text(result, style) +
           "\nRepeated modes are shown in the basis of the parameter that separates them most.\n";
  } else if (format == 1) {
    auto json = report::head_json("sensitivity", machine);
    json["model"] = dynamics::name(machine.kind);
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
      app, "sensitivity", "Effect of each parameter of the machine file on each frequency",
      {{"sensitivity machine.toml", "all modes and all parameters, % per %"},
       {"sensitivity machine.toml --parameter legs.guide_sleeve.stiffness --parameter "
        "legs.oil_spring.cylinder.bulk_modulus",
        "seals and oil"},
       {"sensitivity machine.toml --pose \"z=100 mm\" --plot map.svg",
        "at another pose, as a heat map"}});
  auto arguments = std::make_shared<Arguments>();
  add_machine_options(command, arguments->machine);
  add_pose_option(command, arguments->machine);
  add_model_option(command, arguments->machine);
  command.add_option("--parameter", arguments->parameters,
                     "Only this parameter (PATH); may be repeated");
  command.add_option("--format", arguments->format, "table, json or csv").capture_default_str();
  command.add_option("-o,--output", arguments->output, "File to write; - prints")
      .capture_default_str();
  command.add_option("--plot", arguments->plot, "Heat map to write: .svg, .png or .pdf");
  command.callback([arguments] { run(*arguments); });
}

}  // namespace hydrapod::cli
