#include "hydrapod/command.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/reports.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::cli {

namespace {

using base::two_pi;
using spatial::direction_names;

/// Bandwidths, peaks and couplings of the response from command to pose.
std::string command_text(const report::CommandResponse& response, const TableStyle& style) {
  const auto cell = [](const std::optional<double>& omega) {
    return omega ? hertz(*omega) : std::string("–");
  };
  Table table({"<", "-3 dB Hz", "-90° Hz", "peak dB", "at Hz"});
  for (int i = 0; i < 6; ++i) {
    const auto found = report::command_bandwidth(response, i);
    table.add_row({direction_names[static_cast<size_t>(i)], cell(found.magnitude),
                   cell(found.phase), fmt::format("{:.2f}", 20.0 * std::log10(found.peak)),
                   hertz(found.peak_omega)});
  }
  return table.text(style);
}

const std::vector<std::string_view> directions(direction_names.begin(), direction_names.end());

struct Arguments {
  MachineArguments machine{};
  std::string input{"wrench"}, output{"displacement"};
  std::string from{}, to{}, point{}, plot{};
  std::string entries{"x,y,z,rx,ry,rz"};
  int points{2000};
  std::string format{};
  std::string file{"-"};
};

/// A frequency: a number in Hz, or a quantity ("30 rad/s", "2 kHz"), in rad/s.
constexpr double highest_frequency = 1e9;  // [Hz], far beyond any mechanism

std::optional<double> frequency(const std::string& option, const std::string& text) {
  if (text.empty()) return {};
  const auto in_hertz = base::read_plain_or_quantity(text, "Hz");
  const auto in_radians = base::read_quantity(text, "rad/s");
  if (!in_hertz.ok() && !in_radians.ok()) base::refuse(option + " " + text, in_hertz.problem);
  const double value = in_hertz.ok() ? two_pi * in_hertz.value : in_radians.value;
  if (!(value > 0.0)) base::refuse(option + " " + text, "a frequency must be positive");
  if (!(value <= two_pi * highest_frequency))
    base::refuse(option + " " + text,
                 fmt::format("expected a frequency up to {:g} Hz", highest_frequency));
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
  if (!arguments.point.empty()) options.p_PQ = point("--point", arguments.point);
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
        fmt::format("from command to pose; pose {}, {} model; machine: {}", machine.pose.name,
                    model, report::state_text(machine.file)),
        path);
  });
  if (format == 2) return report::command_response_csv(response);
  if (format == 0)
    return fmt::format("{}, pose {}: from command to pose, {} model\n{}damping: {}\n{}\n\n",
                       machine.file.machine.name, machine.pose.name, model,
                       state_line(machine.file), report::plant_damping_text(machine.file.machine),
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
  const size_t format = result_format(arguments.format, arguments.file, {"table", "json", "csv"});
  const auto options = options_of(arguments);
  write_result(arguments.file, format,
               arguments.input == "command" ? command_output(arguments, options, format)
                                            : mechanics_output(arguments, options, format));
}

}  // namespace

void add_bode(Command app) {
  Command command = app.add_command(
      "bode", "Bode diagrams of the platform with rigid and with flexible legs",
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
        "wrench: forces and moments at the point; actuator: forces of the legs, mapped to its "
        "directions; command: the commanded pose, with hydraulics and controller"},
       {"--output", arguments.output, "displacement, velocity or acceleration of the point"},
       {"--point", arguments.point,
        "Point of the platform, \"x,y,z\" in its frame; default: its mass centre"},
       {"--from", arguments.from, "Lowest frequency, Hz or with a unit; default: from the modes"},
       {"--to", arguments.to, "Highest frequency, Hz or with a unit; default: from the modes"},
       {"--points", arguments.points, "Frequencies, evenly spaced on a logarithmic axis",
        range(2, 100000)},
       {"--plot", arguments.plot, "Picture to write, .svg, .png or .pdf (needs gnuplot)", writes},
       {"--entries", arguments.entries, "Entries to plot, as directions or output/input pairs"},
       {"--format", arguments.format,
        "table (the peaks), json or csv (the 6×6 response); default: by the ending of -o, else "
        "table"},
       {"-o", arguments.file, "File to write; - prints", writes}});
}

}  // namespace hydrapod::cli
