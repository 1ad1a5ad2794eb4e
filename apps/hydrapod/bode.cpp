#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "hydrapod/base/constants.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/bode_report.hpp"
#include "hydrapod/commands.hpp"
#include "hydrapod/machine_arguments.hpp"
#include "hydrapod/mode_report.hpp"
#include "hydrapod/report/bode.hpp"
#include "hydrapod/report/system.hpp"
#include "hydrapod/simulation/tuning.hpp"
#include "hydrapod/spatial/directions.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

namespace {

using base::two_pi;
const std::vector<std::string_view> directions(spatial::direction_names.begin(),
                                               spatial::direction_names.end());

struct Arguments {
  MachineArguments machine{};
  std::string input{"wrench"}, output{"displacement"};
  std::string from{}, to{}, point{}, plot{};
  std::string entries{"x,y,z,rx,ry,rz"};
  int points{2000};
  std::string format{"table"};
  std::string file{"-"};
};

std::vector<std::string> parts_of(const std::string& text, char separator) {
  std::vector<std::string> parts;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

/// A frequency: a number in Hz, or a quantity ("30 rad/s", "2 kHz"), in rad/s.
std::optional<double> frequency(const std::string& option, const std::string& text) {
  if (text.empty()) return {};
  double value = 0.0;
  if (const auto plain = plain_number(text)) {
    value = two_pi * *plain;
  } else if (const auto hertz = base::read_quantity(text, "Hz"); hertz.ok()) {
    value = two_pi * hertz.value;
  } else if (const auto radians = base::read_quantity(text, "rad/s"); radians.ok()) {
    value = radians.value;
  } else {
    bad_argument(option + " " + text, hertz.problem);
  }
  if (!(value > 0.0)) bad_argument(option + " " + text, "a frequency must be positive");
  return value;
}

/// "x,y,z" in the platform frame, each SI or with a unit.
std::optional<spatial::Vector3> point(const std::string& text) {
  if (text.empty()) return {};
  const auto parts = parts_of(text, ',');
  const std::string argument = "--point " + text;
  if (parts.size() != 3)
    bad_argument(argument, "a point is three lengths, for instance \"0,0,0.2 m\"");
  return spatial::Vector3(plain_or_quantity(argument, parts[0], "m"),
                          plain_or_quantity(argument, parts[1], "m"),
                          plain_or_quantity(argument, parts[2], "m"));
}

/// "x,ry/x": direct responses and output/input pairs.
std::vector<report::Entry> entries(const std::string& text) {
  std::vector<report::Entry> list;
  for (const auto& part : parts_of(text, ',')) {
    const auto pair = parts_of(part, '/');
    if (pair.size() > 2)
      bad_argument("--entries " + text,
                   fmt::format("'{}' is no output/input pair such as ry/x", part));
    const auto out = static_cast<int>(choose_word("--entries", pair[0], directions));
    const auto in =
        pair.size() == 2 ? static_cast<int>(choose_word("--entries", pair[1], directions)) : out;
    list.push_back({out, in});
  }
  return list;
}

report::BodeOptions options_of(const Arguments& arguments) {
  report::BodeOptions options;
  options.input = static_cast<response::Input>(
      choose_word("--input", arguments.input, {"wrench", "actuator", "command"}));
  options.output = static_cast<response::Output>(
      choose_word("--output", arguments.output, {"displacement", "velocity", "acceleration"}));
  options.from = frequency("--from", arguments.from);
  options.to = frequency("--to", arguments.to);
  options.p_PQ = point(arguments.point);
  options.points = arguments.points;
  if (options.from && options.to && *options.from >= *options.to)
    bad_argument("--from " + arguments.from, "must be less than --to " + arguments.to);
  return options;
}

std::string json_text(const Arguments& arguments, const model::MachineFile& file,
                      const report::PoseChoice& pose, const report::Bode& bode) {
  report::Json json{{"kind", "bode"},
                    {"machine", report::machine_json(file, arguments.machine.file)},
                    {"assumptions", report::assumptions_json(file.machine)},
                    {"pose", report::pose_json(pose)}};
  json.update(report::bode_json(bode));
  return json.dump() + "\n";
}

std::string table_text(const Arguments& arguments, const model::MachineFile& file,
                       const report::PoseChoice& pose, const report::Bode& bode) {
  const bool printed = arguments.file == "-";
  const bool colour = printed && has_colour(stdout);
  const size_t width = printed ? terminal_width() : Table::unlimited;
  return heading(file.machine, pose, bode.table, colour) + peak_text(bode, colour, width);
}

/// A response that grows without bound is no response: it is shown, but not without a word.
void warn_if_unstable(const report::Bode& bode) {
  const auto& modes = bode.table.real.modes;
  if (std::all_of(modes.begin(), modes.end(), [](const auto& m) { return m.mode.stable; })) return;
  print_diagnostics(
      {{.severity = base::Severity::warning,
        .message = "the machine is unstable at this pose, so that no steady vibration "
                   "exists; the response is that of its linear equations"}});
}

/// The response of the whole machine from commanded to true pose.
void run_command(const Arguments& arguments, size_t format) {
  if (arguments.output != "displacement")
    bad_argument("--output " + arguments.output,
                 "from command to pose there is the displacement only");
  if (!arguments.point.empty())
    bad_argument("--point " + arguments.point,
                 "from command to pose, the point is the origin of the platform frame");
  const auto file = load(arguments.machine);
  const auto pose = choose_pose(file.machine, arguments.machine.pose);
  const auto kind = choose_model(file.machine, arguments.machine.model);
  const auto system = simulation::linear_system(file.machine, pose.X_BP, {.kind = kind});
  const auto poles = simulation::system_poles(system);
  if (!poles.sampled_stable)
    print_diagnostics({{.severity = base::Severity::warning,
                        .message = "the loop is unstable, so that no steady vibration exists; the "
                                   "response is that of its linear equations"}});
  const double lowest = simulation::tune_controller(file.machine, pose.X_BP).lowest_oil_mode;
  const double from = frequency("--from", arguments.from).value_or(0.01 * lowest);
  const double to = frequency("--to", arguments.to).value_or(20.0 * lowest);
  const auto response = report::command_response(system, from, to, arguments.points);
  if (!arguments.plot.empty()) {
    report::plot_command_response(
        response, file.machine.name,
        fmt::format("from command to pose; pose {}, {} model", pose.name, dynamics::name(kind)),
        arguments.plot);
    fmt::print(stderr, "wrote {}\n", arguments.plot);
  }
  if (format == 2) {
    base::write_file_whole(arguments.file, report::command_response_csv(response));
  } else if (format == 1) {
    report::Json json{{"kind", "bode"},
                      {"machine", report::machine_json(file, arguments.machine.file)},
                      {"assumptions", report::assumptions_json(file.machine)},
                      {"pose", report::pose_json(pose)},
                      {"model", dynamics::name(kind)},
                      {"input", "command"},
                      {"output", "displacement"}};
    json.update(report::command_response_json(response));
    base::write_file_whole(arguments.file, json.dump() + "\n");
  } else {
    const bool printed = arguments.file == "-";
    base::write_file_whole(
        arguments.file,
        fmt::format("{}, pose {}: from command to pose, {} model\n{}\n\n", file.machine.name,
                    pose.name, dynamics::name(kind), report::verdict_text(system, poles)) +
            command_text(response, printed && has_colour(stdout),
                         printed ? terminal_width() : Table::unlimited));
  }
}

void run(const Arguments& arguments) {
  const size_t format = choose_word("--format", arguments.format, {"table", "json", "csv"});
  const auto options = options_of(arguments);
  if (arguments.input == "command") return run_command(arguments, format);
  const auto shown = entries(arguments.entries);
  const auto file = load(arguments.machine);
  const auto pose = choose_pose(file.machine, arguments.machine.pose);
  const auto kind = choose_model(file.machine, arguments.machine.model);
  const auto bode = report::bode(file.machine, pose, kind, options);
  warn_if_unstable(bode);
  if (!arguments.plot.empty()) {
    report::plot_bode(bode, shown, plot_text(file.machine, pose, bode), arguments.plot);
    fmt::print(stderr, "wrote {}\n", arguments.plot);
  }
  base::write_file_whole(arguments.file, format == 0   ? table_text(arguments, file, pose, bode)
                                         : format == 1 ? json_text(arguments, file, pose, bode)
                                                       : report::bode_csv(bode));
}

void add_options(Command command, Arguments& arguments) {
  add_machine_options(command, arguments.machine);
  add_pose_option(command, arguments.machine);
  add_model_option(command, arguments.machine);
  command
      .add_option("--input", arguments.input,
                  "wrench at the point, actuator forces mapped to its directions, or command: the "
                  "commanded pose, with hydraulics and controller")
      .capture_default_str();
  command
      .add_option("--output", arguments.output,
                  "displacement, velocity or acceleration of the point")
      .capture_default_str();
  command.add_option("--point", arguments.point,
                     "Point of the platform, \"x,y,z\" in its frame; default: its mass centre");
  command.add_option("--from", arguments.from,
                     "Lowest frequency, Hz or with a unit; default: from the modes");
  command.add_option("--to", arguments.to,
                     "Highest frequency, Hz or with a unit; default: from the modes");
  command
      .add_option("--points", arguments.points, "Frequencies, evenly spaced on a logarithmic axis")
      .range(2, 100000)
      .capture_default_str();
  command.add_option("--plot", arguments.plot,
                     "Picture to write, .svg, .png or .pdf (needs gnuplot)");
  command
      .add_option("--entries", arguments.entries,
                  "Entries to plot, as directions or output/input pairs")
      .capture_default_str();
  command
      .add_option("--format", arguments.format, "table (the peaks), json or csv (the 6×6 response)")
      .capture_default_str();
  command.add_option("-o", arguments.file, "File to write; - prints").capture_default_str();
}

}  // namespace

void add_bode(Command app) {
  Command command =
      add_command(app, "bode", "Bode diagram of the platform, rigid beside rigid-flexible",
                  {{"bode machine.toml --plot bode.svg",
                    "the six direct responses as a picture, peaks as a table"},
                   {"bode machine.toml --entries x,ry/x --plot coupling.pdf",
                    "x, and ry caused by a force in x"},
                   {"bode machine.toml --point \"0,0,0.5 m\" --output acceleration",
                    "at another point of the platform"},
                   {"bode machine.toml --input command --plot loop.svg",
                    "from commanded to true pose, hydraulics and controller included"},
                   {"bode machine.toml --from 1 --to \"200 Hz\" --format csv -o bode.csv",
                    "the whole 6×6 response"}});
  auto arguments = std::make_shared<Arguments>();
  add_options(command, *arguments);
  command.callback([arguments] { run(*arguments); });
}

}  // namespace hydrapod::cli
