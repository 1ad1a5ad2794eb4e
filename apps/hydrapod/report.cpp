#include "hydrapod/tasks/report.hpp"
#include "hydrapod/base/error.hpp"

#include <fmt/format.h>

#include <charconv>
#include <memory>

#include "hydrapod/base/file.hpp"
#include "hydrapod/commands.hpp"
#include "hydrapod/diagnosis_arguments.hpp"
#include "hydrapod/identification_arguments.hpp"
#include "hydrapod/interrupt.hpp"
#include "hydrapod/machine_arguments.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

namespace {

struct Arguments {
  MachineArguments machine{};
  std::vector<std::string> poses{};
  std::string output{"report.html"};
  std::string theme{"auto"};
  std::string modes{};
  std::vector<std::string> commands{};
  std::string until{};
  IdentificationArguments identification{};
  DiagnosisArguments diagnosis{};
  report::HtmlOptions page{};
};

/// A mode's number, all of `text`.
int mode_number(const std::string& all, std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
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
  for (size_t begin = 0; !text.empty() && begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view part = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    const size_t dash = part.find('-');
    const int first = mode_number(text, part.substr(0, dash));
    const int last =
        dash == std::string_view::npos ? first : mode_number(text, part.substr(dash + 1));
    if (first < 1 || last > count || first > last)
      base::refuse("--modes " + text, fmt::format("the modes of this model are 1 to {}", count));
    for (int mode = first; mode <= last; ++mode) modes.push_back(mode);
  }
  return modes;
}

tasks::ReportOptions options_of(const Arguments& a, const tasks::Machine& machine) {
  constexpr std::array themes{report::Theme::automatic, report::Theme::light, report::Theme::dark};
  tasks::ReportOptions options{.page = a.page};
  options.page.theme = themes[choose_word("--theme", a.theme, {"auto", "light", "dark"})];
  options.page.modes = mode_list(a.modes, dynamics::degrees_of_freedom(machine.kind));
  for (const auto& pose : a.poses)
    options.poses.push_back(tasks::pose_of(machine.file.machine, pose));
  if (a.commands.empty() && !a.until.empty()) base::refuse("--until", "needs --command");
  if (!a.commands.empty()) {
    auto& simulation = options.simulation.emplace();
    simulation.commands = a.commands;
    simulation.trace_samples = 1500;
    auto& integrator = simulation.loop.integrator;
    integrator.relative_tolerance = integrator.absolute_tolerance = 1e-6;  // as `simulate` has it
    if (!a.until.empty()) {
      simulation.until = plain_or_quantity("--until " + a.until, a.until, "s");
      if (!(*simulation.until > 0.0)) base::refuse("--until " + a.until, "expected a time above 0");
    }
  }
  if (!a.identification.measurement.files.empty())
    options.identification = identify_options(a.identification);
  if (!a.diagnosis.measured.empty()) {
    options.diagnosis = diagnose_options(a.diagnosis, machine.file.machine);
    options.diagnosis->measured.observed = observed_system(a.identification.against, "none");
  }
  return options;
}

void run(const Arguments& a) {
  auto asked = a.machine;
  if (!a.poses.empty()) asked.pose = a.poses.front();
  const auto machine = load(asked);
  const auto options = options_of(a, machine);
  const auto result = with_progress("reporting", [&](const auto& progress) {
    return tasks::report_document(machine, options, progress);
  });
  print_diagnostics(result.warnings);
  base::write_file_whole(a.output, report::html_page(result.document, options.page.theme));
  if (a.output != "-") fmt::print(stderr, "wrote {}\n", a.output);
}

}  // namespace

void add_report(Command app) {
  Command command = add_command(
      app, "report", "One HTML file with moving modes, Bode diagrams and all numbers",
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
       {"report machine.toml --set environment.gravity=0 --theme light",
        "another value of a parameter, light colours"}});
  auto arguments = std::make_shared<Arguments>();
  add_machine_options(command, arguments->machine);
  add_model_option(command, arguments->machine);
  command
      .add_option("--pose", arguments->poses,
                  "Pose of the file, or displacements from the neutral pose: \"z=50 mm, ry=5 "
                  "deg\"; may be repeated [neutral]")
      .allow_extra_args(false)
      .type_name("POSE");
  command.add_option("--title", arguments->page.title, "Title of the page [the machine's name]");
  command.add_option("--theme", arguments->theme, "auto (as the reader's system), light or dark")
      .capture_default_str();
  command.add_option("--modes", arguments->modes,
                     "Modes shown in print; the page opens with the first one: 1,2,15-18 [at most "
                     "six, without local seal modes]");
  command
      .add_option("--points", arguments->page.points,
                  "Points of a Bode curve, besides those at resonances")
      .capture_default_str()
      .range(2, 20000);
  command
      .add_option(
          "--command", arguments->commands,
          "Also simulate this at the first pose, as `hydrapod simulate` does; may be repeated")
      .allow_extra_args(false)
      .type_name("COMMAND");
  command.add_option("--until", arguments->until,
                     "Simulated time, s or with a unit; default: until shortly after the commands");
  auto& identification = arguments->identification;
  command
      .add_option(
          "--measured", identification.measurement.files,
          "Also identify this record or these frequency responses, as `hydrapod identify` does, "
          "and compare with the machine at the first pose; may be repeated for records")
      .allow_extra_args(false)
      .type_name("RECORD|FRF");
  command.add_flag("--from-drive", identification.measurement.from_drive,
                   "Of the record: inputs are the drives (machine without controller)");
  command.add_option("--from", identification.from, "Of the record: lowest frequency");
  command.add_option("--to", identification.to, "Of the record: highest frequency");
  command
      .add_option("--against", identification.against,
                  "Model to compare the record with: auto, mechanics, plant, system or none")
      .capture_default_str();
  command
      .add_option("--diagnose", arguments->diagnosis.measured,
                  "Also diagnose from these modes, responses or records, as `hydrapod diagnose "
                  "--measured` does; the page then shows the machine of the best hypothesis")
      .type_name("RECORD|FRF|MODES")
      .allow_extra_args(false);
  add_diagnosis_options(command, arguments->diagnosis);
  command.add_option("-o,--output", arguments->output, "File to write; - prints")
      .capture_default_str();
  command.callback([arguments] { run(*arguments); });
}

}  // namespace hydrapod::cli
