#include "hydrapod/report/html.hpp"

#include <fmt/format.h>

#include <charconv>
#include <memory>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/commands.hpp"
#include "hydrapod/diagnosis_arguments.hpp"
#include "hydrapod/identification_run.hpp"
#include "hydrapod/interrupt.hpp"
#include "hydrapod/machine_arguments.hpp"
#include "hydrapod/report/diagnosis.hpp"
#include "hydrapod/report/identification_section.hpp"
#include "hydrapod/report/simulation.hpp"
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
  report::HtmlOptions options{};
};

[[noreturn]] void bad_modes(const std::string& text, const std::string& message) {
  throw base::InputError({{.file = "--modes " + text, .message = message}});
}

/// A mode's number, all of `text`.
int mode_number(const std::string& all, std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  int value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size())
    bad_modes(all, fmt::format("'{}' is no mode's number; a list looks like 1,2,15-18", text));
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
      bad_modes(text, fmt::format("the modes of this model are 1 to {}", count));
    for (int mode = first; mode <= last; ++mode) modes.push_back(mode);
  }
  return modes;
}

/// The run that `--command` asks for, at the first pose.
report::Json simulated(const Arguments& arguments, const model::MachineFile& file,
                       const model::NamedPose& pose) {
  report::SimulationOptions options{.commands = arguments.commands, .trace_samples = 1500};
  options.loop.kind = arguments.options.kind;
  auto& integrator = options.loop.integrator;
  integrator.relative_tolerance = integrator.absolute_tolerance = 1e-6;  // as `simulate` has it
  if (!arguments.until.empty())
    options.until = plain_or_quantity("--until " + arguments.until, arguments.until, "s");
  if (options.until && !(*options.until > 0.0))
    bad_argument("--until " + arguments.until, "expected a time above 0");
  auto prepared = report::prepare_simulation(file.machine, pose, options);
  report::Simulation result;
  {
    const InterruptNote interrupt;
    ProgressLine progress("simulating");
    result = report::run_simulation(prepared, {}, [&](double time) {
      progress.update(time / *prepared.options.until);
      return !InterruptNote::noted();
    });
  }
  return report::simulation_section(
      result, file.machine, pose,
      dynamics::linear_model(file.machine, pose.X_BP, arguments.options.kind));
}

/// The modes that `--measured` asks for, beside those of the machine at the first pose.
report::Json measured(Arguments& arguments, const model::MachineFile& file,
                      const model::NamedPose& pose) {
  auto& a = arguments.identification;
  check_identification(a);
  a.measurement.known = RecordMachine{
      .name = arguments.machine.file, .file = file, .pose = pose, .kind = arguments.options.kind};
  const auto source = identified_source(a);
  const auto result = identified_modes(a, source);
  return report::identification_section(
      result, compared_modes(a, source, result),
      {a.measurement.files, measurement_text(source.responses), source.frame});
}

/// The diagnosis that `--diagnose` asks for; from here on the page shows the machine that explains
/// the measurement best, its guilty mode first.
report::Json diagnosed(Arguments& arguments, const tasks::Machine& machine,
                       model::MachineFile& file) {
  auto given = arguments.machine;
  given.pose = arguments.poses.front();
  auto& options = arguments.options;
  // no model to compare modes with says nothing of what was measured
  auto asked = arguments.diagnosis;
  if (arguments.identification.against != "none") asked.against = arguments.identification.against;
  const auto found = investigate(asked, given, machine);
  const auto& d = *found.diagnosis;
  if (!d.alike.empty()) {
    file = diagnosis::file_of(file, d.explanations[d.alike.front()]);
    options.kind = d.explanations[d.alike.front()].kind;
    const int guilty = guilty_mode(d, found.pose);
    if (options.modes.empty() && guilty > 0) options.modes = {guilty};
  }
  return report::diagnosis_json(found);
}

void run(Arguments& arguments) {
  constexpr std::array themes{report::Theme::automatic, report::Theme::light, report::Theme::dark};
  auto& options = arguments.options;
  options.theme = themes[choose_word("--theme", arguments.theme, {"auto", "light", "dark"})];
  if (arguments.poses.empty()) arguments.poses.push_back(arguments.machine.pose);
  auto asked = arguments.machine;
  asked.pose = arguments.poses.front();
  const auto machine = load(asked);
  auto file = machine.file;
  options.kind = machine.kind;
  options.modes = mode_list(arguments.modes, dynamics::degrees_of_freedom(options.kind));
  std::vector<model::NamedPose> poses;
  for (const auto& pose : arguments.poses) poses.push_back(tasks::pose_of(file.machine, pose));
  if (arguments.commands.empty() && !arguments.until.empty())
    bad_argument("--until", "says how long to simulate; add --command");
  report::Json diagnosis;
  if (!arguments.diagnosis.measured.empty()) {
    diagnosis = diagnosed(arguments, machine, file);
    poses.clear();
    for (const auto& pose : arguments.poses) poses.push_back(tasks::pose_of(file.machine, pose));
  }
  auto document = report::report_json(file, arguments.machine.file, poses, options);
  if (!arguments.commands.empty())
    document["simulation"] = simulated(arguments, file, poses.front());
  if (!arguments.identification.measurement.files.empty())
    document["identification"] = measured(arguments, file, poses.front());
  if (!diagnosis.is_null()) document["diagnosis"] = diagnosis;
  base::write_file_whole(arguments.output, report::html_page(document, options.theme));
  if (arguments.output != "-") fmt::print(stderr, "wrote {}\n", arguments.output);
}

}  // namespace

void add_report(Command app) {
  Command command = add_command(
      app, "report",
      "One HTML file to look at and to mail: moving modes, Bode diagrams, all numbers",
      {{"report machine.toml -o report.html", "opens in any browser, without a network"},
       {"report machine.toml --pose neutral --pose \"z=100 mm, ry=5 deg\"",
        "two poses to switch between"},
       {"report machine.toml --modes 1,2,15-18 --title \"Before the new seals\"",
        "modes pictured in print"},
       {"report machine.toml --command \"step z=5 mm\"",
        "and what the machine does when it is told to move: over time, and in 3D"},
       {"report machine.toml --measured run.h5",
        "measured modes: live stabilisation chart, fit, comparison"},
       {"report machine.toml --diagnose modes.csv",
        "what explains measured modes, how stiff the sleeves must be, the guilty mode moving"},
       {"report machine.toml --set environment.gravity=0 --theme light",
        "a what-if, light colours only"}});
  auto arguments = std::make_shared<Arguments>();
  add_machine_options(command, arguments->machine);
  add_model_option(command, arguments->machine);
  command
      .add_option(
          "--pose", arguments->poses,
          "Pose of the file, or displacements from the neutral one: \"z=50 mm, ry=5 deg\"; may be "
          "repeated [neutral]")
      .allow_extra_args(false)
      .type_name("POSE");
  command.add_option("--title", arguments->options.title, "Title of the page [the machine's name]");
  command.add_option("--theme", arguments->theme, "auto (as the reader's system is), light or dark")
      .capture_default_str();
  command.add_option(
      "--modes", arguments->modes,
      "Modes pictured in print, the first one shown at once: 1,2,15-18 [those the platform "
      "feels, at most six]");
  command
      .add_option("--points", arguments->options.points,
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
                     "Simulated time, s or with a unit; default: what the commands need");
  auto& identification = arguments->identification;
  command
      .add_option("--measured", identification.measurement.files,
                  "Also show the modes that `hydrapod identify` finds in this record or these "
                  "frequency responses, beside those of the machine at the first pose; records "
                  "may be repeated")
      .allow_extra_args(false)
      .type_name("RECORD|FRF");
  command.add_flag("--from-drive", identification.measurement.from_drive,
                   "Of the record: from the drives on, without the controller");
  command.add_option("--from", identification.from, "Of the record: lowest frequency");
  command.add_option("--to", identification.to, "Of the record: highest frequency");
  command
      .add_option("--against", identification.against,
                  "Model to compare the record with: auto, mechanics, plant, system or none")
      .capture_default_str();
  command
      .add_option("--diagnose", arguments->diagnosis.measured,
                  "Also diagnose from these modes, responses or records, as `hydrapod diagnose "
                  "--measured` does; the page then shows the machine that explains them best")
      .type_name("RECORD|FRF|MODES")
      .allow_extra_args(false);
  add_diagnosis_options(command, arguments->diagnosis);
  command.add_option("-o,--output", arguments->output, "File to write; - prints")
      .capture_default_str();
  command.callback([arguments] { run(*arguments); });
}

}  // namespace hydrapod::cli
