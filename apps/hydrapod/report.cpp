#include "hydrapod/command.hpp"
#include "hydrapod/commands.hpp"

#include <charconv>

#include "hydrapod/base/text.hpp"
#include "hydrapod/identification_arguments.hpp"
#include "hydrapod/reproduction.hpp"
#include "hydrapod/tasks/measurement.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  MachineArguments machine{};
  std::vector<std::string> poses{};
  std::string output{"report.html"};
  std::string theme{"auto"};
  std::string format{"html"};
  std::string modes{};
  std::vector<std::string> commands{};
  std::string until{};
  int samples{1500};
  IdentificationArguments identification{};
  DiagnosisArguments diagnosis{};
  std::string comparison{};
  report::HtmlOptions page{};
};

/// A mode's number, all of `text`.
int mode_number(const std::string& all, std::string_view text) {
  text = base::trimmed(text);
  int value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size())
    base::refuse("--modes " + all,
                 fmt::format("'{}' is not a mode number; expected a list such as 1,2,15-18", text));
  return value;
}

/// "1,2,15-18", each between 1 and `count`.
std::vector<int> mode_list(const std::string& text, int count) {
  std::vector<int> modes;
  if (text.empty()) return modes;
  for (const auto& part : base::split(text, ",")) {
    const size_t dash = part.find('-');
    const int first = mode_number(text, part.substr(0, dash));
    const int last = dash == part.npos ? first : mode_number(text, part.substr(dash + 1));
    if (first < 1 || last > count || first > last)
      base::refuse("--modes " + text, fmt::format("the modes of this model are 1 to {}", count));
    for (int mode = first; mode <= last; ++mode) modes.push_back(mode);
  }
  return modes;
}

tasks::ReportOptions options_of(const Arguments& a, const tasks::Machine& machine) {
  constexpr std::array themes{report::Theme::automatic, report::Theme::light, report::Theme::dark};
  tasks::ReportOptions options{.page = a.page, .comparison = a.comparison};
  options.page.theme = themes[choose_word("--theme", a.theme, {"auto", "light", "dark"})];
  options.page.modes =
      mode_list(a.modes, dynamics::degrees_of_freedom(machine.file.machine, machine.kind));
  for (const auto& pose : a.poses)
    options.poses.push_back(tasks::pose_of(machine.file.machine, pose));
  if (a.commands.empty() && !a.until.empty()) base::refuse("--until", "needs --command");
  if (!a.commands.empty()) {
    auto& simulation = options.simulation.emplace();
    simulation.commands = a.commands;
    simulation.trace_samples = static_cast<std::size_t>(a.samples);
    auto& integrator = simulation.loop.integrator;
    integrator.relative_tolerance = integrator.absolute_tolerance = 1e-6;  // as `simulate` has it
    if (!a.until.empty())
      simulation.until = positive_quantity("--until", a.until, "s", "expected a time above 0");
  }
  const auto& record = a.identification;
  if (!record.measurement.files.empty()) {
    options.identification = identify_options(record);
  } else {
    if (!record.from.empty()) base::refuse("--from " + record.from, "needs --measured");
    if (!record.to.empty()) base::refuse("--to " + record.to, "needs --measured");
    if (record.measurement.from_drive) base::refuse("--from-drive", "needs --measured");
  }
  if (!a.diagnosis.measured.empty()) {
    options.diagnosis = diagnose_options(a.diagnosis, machine.file.machine);
    options.diagnosis->measured.observed = observed_system(a.identification.against, "none");
  }
  return options;
}

void run(const Arguments& a) {
  const bool page = choose_word("--format", a.format, {"html", "json"}) == 0;
  require_ending(page ? "report" : "report --format json", a.output, page ? ".html" : "json");
  auto asked = a.machine;
  if (!a.poses.empty()) asked.pose = a.poses.front();
  const auto machine = load(asked);
  const auto options = options_of(a, machine);
  auto result = with_progress("reporting", [&](const auto& progress) {
    return tasks::report_document(machine, options, progress);
  });
  print_diagnostics(result.warnings);
  result.document["reproduction"] = reproduction();
  write_output(a.output, page ? report::html_page(result.document, options.page.theme)
                              : result.document.dump(1) + "\n");
  const auto diagnosis = result.document.find("diagnosis");
  if (diagnosis != result.document.end() && diagnosis->value("interrupted", false))
    throw base::ComputationError("interrupted: the page contains the hypotheses tried so far");
}

}  // namespace

void add_report(Command app) {
  Command command = app.add_command(
      "report", "One HTML file with moving modes, Bode diagrams and all numbers",
      {{"report machine.toml -o report.html", "opens in any browser, without a network"},
       {"report machine.toml --pose neutral --pose \"z=100 mm, ry=5 deg\"",
        "two poses to switch between"},
       {"report machine.toml --modes 1,2,15-18 --title \"Before the new seals\"",
        "modes shown in print"},
       {"report machine.toml --command \"step z=5 mm\"",
        "with a simulated motion: time histories and 3D"},
       {"report machine.toml --measured run.h5",
        "measured modes: interactive stabilisation chart, fit, comparison"},
       {"report machine.toml --diagnose modes.csv",
        "hypotheses for measured modes, required stiffness of the guide sleeves"},
       {"report machine.toml --compare comparison.json",
        "with a result of `hydrapod compare A B -o comparison.json`"},
       {"report machine.toml --set environment.gravity=0 --theme light",
        "another value of a parameter, light colours"}});
  auto& arguments = command.calls(&run);
  add_machine_options(command, arguments.machine);
  add_model_option(command, arguments.machine);
  command.add_options(
      {{"--pose", arguments.poses,
        "Pose of the file, or displacements from the neutral pose: \"z=50 mm, ry=5 "
        "deg\"; may be repeated [neutral]",
        one_each_as("POSE")},
       {"--title", arguments.page.title, "Title of the page [the machine's name]"},
       {"--theme", arguments.theme, "auto (as the reader's system), light or dark"},
       {"--modes", arguments.modes,
        "Modes shown in print; the page opens with the first one: 1,2,15-18 [at most "
        "six, without local seal modes]"},
       {"--points", arguments.page.points, "Points of a Bode curve, besides those at resonances",
        range(2, 20000)},
       {"--command", arguments.commands,
        "Also simulate this at the first pose, as `hydrapod simulate` does; may be repeated",
        reads_each_as("COMMAND")},
       {"--until", arguments.until,
        "Simulated time, s or with a unit; default: until shortly after the commands"},
       {"--samples", arguments.samples, "Samples of each quantity of the simulated run in the page",
        range(2, 100000)},
       {"--measured", arguments.identification.measurement.files,
        "Also identify this record or these frequency responses, as `hydrapod identify` does, "
        "and compare with the machine at the first pose; may be repeated for records",
        reads_each_as("RECORD|FRF")},
       {"--from-drive", arguments.identification.measurement.from_drive,
        "Of the record: inputs are the drives (machine without controller)"},
       {"--from", arguments.identification.from, "Of the record: lowest frequency"},
       {"--to", arguments.identification.to, "Of the record: highest frequency"},
       {"--against", arguments.identification.against,
        "Model to compare the record with: auto, mechanics, plant, system or none"},
       {"--diagnose", arguments.diagnosis.measured,
        "Also diagnose from these modes, responses or records, as `hydrapod diagnose "
        "--measured` does; the page then shows the machine of the best hypothesis",
        reads_each_as("RECORD|FRF|MODES")},
       {"--compare", arguments.comparison,
        "Also show this result of `hydrapod compare`, as JSON: matched modes, differences, Bode "
        "diagrams one over the other",
        reads}});
  add_diagnosis_options(command, arguments.diagnosis);
  command.add_options(
      {{"--format", arguments.format, "html, or json: the numbers that the page shows"},
       {"-o,--output", arguments.output, "File to write; - prints", writes}});
}

}  // namespace hydrapod::cli
