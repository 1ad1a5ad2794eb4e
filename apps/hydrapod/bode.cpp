#include "hydrapod/command.hpp"

#include <algorithm>

#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/reports.hpp"
#include "hydrapod/spatial/pose.hpp"

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

/// A frequency: a number in Hz, or a quantity ("30 rad/s", "2 kHz"), in rad/s.
std::optional<double> frequency(const std::string& option, const std::string& text) {
  if (text.empty()) return {};
  const auto hertz = base::read_plain_or_quantity(text, "Hz");
  const auto radians = base::read_quantity(text, "rad/s");
  if (!hertz.ok() && !radians.ok()) base::refuse(option + " " + text, hertz.problem);
  const double value = hertz.ok() ? two_pi * hertz.value : radians.value;
  if (!(value > 0.0)) base::refuse(option + " " + text, "a frequency must be positive");
  return value;
}

/// "x,ry/x": direct responses and output/input pairs.
std::vector<report::Entry> entries(const std::string& text) {
  std::vector<report::Entry> list;
  for (const auto& part : base::split(text, ",")) {
    const auto pair = base::split(part, "/");
    if (pair.size() > 2)
      base::refuse("--entries " + text,
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
  if (!arguments.point.empty()) options.p_PQ = point(arguments.point);
  options.points = arguments.points;
  if (options.from && options.to && *options.from >= *options.to)
    base::refuse("--from " + arguments.from, "must be less than --to " + arguments.to);
  return options;
}

/// A response that grows without bound is no response: it is shown, but not without a word.
void warn_unstable(const char* what) {
  print_warning(fmt::format(
      "{}, so that no steady vibration exists; the response is that of its linear equations",
      what));
}

/// The response of the whole machine from commanded to true pose.
std::string command_output(const Arguments& arguments, const report::BodeOptions& options,
                           std::size_t format) {
  if (arguments.output != "displacement")
    base::refuse("--output " + arguments.output,
                 "with input command the output is the displacement only");
  if (!arguments.point.empty())
    base::refuse("--point " + arguments.point,
                 "with input command the point is the origin of the platform frame");
  const auto machine = load(arguments.machine);
  const auto result = tasks::command_response(
      machine, {.from = options.from, .to = options.to, .points = options.points});
  if (!result.system.poles.sampled_stable) warn_unstable("the loop is unstable");
  const auto& response = result.response;
  const char* model = dynamics::name(machine.kind);
  draw(arguments.plot, [&](const auto& path) {
    report::plot_command_response(
        response, machine.file.machine.name,
        fmt::format("from command to pose; pose {}, {} model", machine.pose.name, model), path);
  });
  if (format == 2) return report::command_response_csv(response);
  if (format == 0)
    return fmt::format("{}, pose {}: from command to pose, {} model\n{}\n\n",
                       machine.file.machine.name, machine.pose.name, model,
                       report::verdict_text(result.system.poles)) +
           command_text(response, table_style(arguments.file));
  auto json = head_of_model("bode", machine);
  json.update({{"input", "command"}, {"output", "displacement"}});
  return json_text(json, report::command_response_json(response), -1);
}

std::string mechanics_output(const Arguments& arguments, const report::BodeOptions& options,
                             std::size_t format) {
  const auto shown = entries(arguments.entries);
  const auto machine = load(arguments.machine);
  const auto bode = tasks::bode(machine, options);
  if (!std::ranges::all_of(bode.table.real.modes, [](const auto& m) { return m.mode.stable; }))
    warn_unstable("the machine is unstable at this pose");
  draw(arguments.plot,
       [&](const auto& path) { report::plot_bode(bode, shown, plot_text(machine, bode), path); });
  if (format == 2) return report::bode_csv(bode);
  if (format != 0)
    return json_text(report::head_json("bode", machine), report::bode_json(bode), -1);
  const auto style = table_style(arguments.file);
  return heading(machine, style) + peak_text(bode, style);
}

void run(const Arguments& arguments) {
  const size_t format = choose_word("--format", arguments.format, {"table", "json", "csv"});
  const auto options = options_of(arguments);
  base::write_file_whole(arguments.file, arguments.input == "command"
                                             ? command_output(arguments, options, format)
                                             : mechanics_output(arguments, options, format));
}

}  // namespace

void add_bode(Command app) {
  Command command = add_command(
      app, "bode", "Bode diagrams of the platform with rigid and with flexible legs",
      {{"bode machine.toml --plot bode.svg",
        "the six direct responses as a picture, peaks as a table"},
       {"bode machine.toml --entries x,ry/x --plot coupling.pdf", "x, and ry due to a force in x"},
       {"bode machine.toml --point \"0,0,0.5 m\" --output acceleration",
        "at another point of the platform"},
       {"bode machine.toml --input command --plot loop.svg",
        "from commanded to true pose, hydraulics and controller included"},
       {"bode machine.toml --from 1 --to \"200 Hz\" --format csv -o bode.csv",
        "the whole 6×6 response"}});
  auto& arguments = command.calls(&run);
  add_subject_options(command, arguments.machine);
  command.add_options(
      {{"--input", arguments.input,
        "wrench at the point, actuator forces mapped to its directions, or command: the "
        "commanded pose, with hydraulics and controller"},
       {"--output", arguments.output, "displacement, velocity or acceleration of the point"},
       {"--point", arguments.point,
        "Point of the platform, \"x,y,z\" in its frame; default: its mass centre"},
       {"--from", arguments.from, "Lowest frequency, Hz or with a unit; default: from the modes"},
       {"--to", arguments.to, "Highest frequency, Hz or with a unit; default: from the modes"},
       {"--points", arguments.points, "Frequencies, evenly spaced on a logarithmic axis",
        range(2, 100000)},
       {"--plot", arguments.plot, "Picture to write, .svg, .png or .pdf (needs gnuplot)"},
       {"--entries", arguments.entries, "Entries to plot, as directions or output/input pairs"},
       {"--format", arguments.format, "table (the peaks), json or csv (the 6×6 response)"},
       {"-o", arguments.file, "File to write; - prints"}});
}

}  // namespace hydrapod::cli
