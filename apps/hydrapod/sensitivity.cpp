#include "hydrapod/command.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/reports.hpp"
#include "hydrapod/tasks/linear.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  MachineArguments machine{};
  std::vector<std::string> parameters{};
  std::string format{};
  std::string output{"-"};
  std::string plot{};
};

void run(const Arguments& arguments) {
  const auto format = result_format(arguments.format, arguments.output, {"table", "json", "csv"});
  const auto machine = load(arguments.machine);
  const auto result = tasks::sensitivity(machine, {.parameters = arguments.parameters});
  const std::string title = fmt::format("{}, pose {}, {} model", machine.file.machine.name,
                                        machine.pose.name, dynamics::name(machine.kind));
  draw(arguments.plot, [&](const auto& path) {
    report::plot_sensitivities(
        result,
        {machine.file.machine.name,
         fmt::format("damped modes; pose {}, {} model; machine: {}", machine.pose.name,
                     dynamics::name(machine.kind), report::mechanics_state_text(machine.file))},
        path);
  });
  std::string text;
  if (format == 0) {
    const auto style = table_style(arguments.output);
    text = bold(title, style) + "\n" + mechanics_state_line(machine.file) + "\n" +
           sensitivity_text(result, style) +
           style.detail(
               "\nRepeated modes are shown in the basis of the parameter that separates them "
               "most.\nHz: " +
               std::string(damped_frequencies));
  } else if (format == 1) {
    text = json_text(head_of_model("sensitivity", machine), report::sensitivity_json(result));
  } else {
    text = sensitivity_csv(result);
  }
  write_result(arguments.output, format, text);
}

}  // namespace

void add_sensitivity(Command app) {
  Command command = app.add_command(
      "sensitivity", "Effect of each parameter of the machine file on each frequency",
      {{"sensitivity machine.toml", "all modes and all parameters, % per %"},
       {"sensitivity machine.toml --parameter legs.guide_sleeve.stiffness --parameter "
        "legs.oil_spring.cylinder.bulk_modulus",
        "seals and oil"},
       {"sensitivity machine.toml --pose \"z=100 mm\" --plot map.svg",
        "at another pose, as a heat map"}});
  auto& arguments = command.calls(&run);
  add_subject_options(command, arguments.machine);
  command.add_options(
      {{"--parameter", arguments.parameters, "Only this parameter (PATH); may be repeated"},
       {"--format", arguments.format,
        "table, json or csv; default: by the ending of -o, else table"},
       {"-o,--output", arguments.output, "File to write; - prints", writes},
       {"--plot", arguments.plot, "Heat map to write: .svg, .png or .pdf", writes}});
  command.add_extent_options();
}

}  // namespace hydrapod::cli
