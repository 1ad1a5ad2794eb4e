#include "hydrapod/identification_arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/base/units.hpp"
#include "hydrapod/interrupt.hpp"
#include "hydrapod/machine_arguments.hpp"
#include "hydrapod/rig/signal_text.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

namespace {

using identification::Estimator;

std::vector<std::string> names(const std::string& text) {
  std::vector<std::string> list;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    std::string name = text.substr(begin, end - begin);
    const auto first = name.find_first_not_of(' '), last = name.find_last_not_of(' ');
    if (first != std::string::npos) list.push_back(name.substr(first, last - first + 1));
    begin = end + 1;
  }
  return list;
}

double time_of(const std::string& option, const std::string& text) {
  const double value = plain_or_quantity(option + " " + text, text, "s");
  if (!(value >= 0.0)) bad_argument(option + " " + text, "a time cannot be negative");
  return value;
}

/// What brings leg lengths to the platform.
std::optional<identification::PlatformFrame> platform_frame(const MeasurementArguments& arguments,
                                                            const data::Experiment& experiment) {
  const auto found = measured_machine(arguments, &experiment);
  if (!found) return {};
  return identification::PlatformFrame{.machine = found->file.machine,
                                       .X_BP = found->pose.X_BP,
                                       .p_BQ = measured_point(arguments, *found)};
}

/// The sensors of --sensor, else those that the record notes; of these the ones that --outputs
/// names, if it does.
std::vector<data::PlacedSensor> chosen_sensors(const MeasurementArguments& a,
                                               const data::Experiment& experiment) {
  std::vector<data::PlacedSensor> all;
  for (const auto& text : a.sensors) {
    const auto sensor = rig::parse_accelerometer(text);
    all.push_back({sensor.name, sensor.p_P, sensor.e_P});
  }
  if (all.empty()) all = experiment.sensors;
  if (all.empty())
    bad_argument("--accelerometers",
                 "the record does not say where its accelerometers are: add --sensor \"NAME, at=X "
                 "Y Z, along=z\" for each, places in the platform's frame [m]");
  const auto wanted = names(a.outputs);
  if (wanted.empty()) return all;
  std::vector<data::PlacedSensor> some;
  for (const auto& name : wanted) {
    const auto found = std::ranges::find(all, name, &data::PlacedSensor::name);
    if (found == all.end()) bad_argument("--outputs " + name, "is no sensor whose place is known");
    some.push_back(*found);
  }
  return some;
}

/// Accelerometers as outputs, and what makes directions of the platform of them.
void use_accelerometers(const MeasurementArguments& a, const data::Experiment& experiment,
                        identification::MeasureOptions& o) {
  const auto machine = measured_machine(a, &experiment);
  if (!machine)
    bad_argument("--accelerometers",
                 "the pose of the platform is needed: add --machine FILE and --pose");
  std::vector<identification::LinearSensor> sensors;
  o.outputs.clear();
  for (const auto& s : chosen_sensors(a, experiment)) {
    o.outputs.push_back(s.name);
    sensors.push_back({machine->pose.X_BP * s.position, machine->pose.X_BP.R_BP * s.axis});
  }
  o.outputs_to_platform =
      identification::platform_from_accelerometers(sensors, measured_point(a, *machine));
}

identification::MeasureOptions options_of(const MeasurementArguments& a,
                                          const data::Experiment& experiment) {
  identification::MeasureOptions o;
  o.inputs = names(a.inputs);
  o.outputs = names(a.outputs);
  o.instruments = names(a.instruments);
  if (a.from_drive && a.from_excitation)
    bad_argument("--from-drive", "and --from-excitation exclude each other");
  if (a.from_drive) o.input_role = data::Role::drive;
  if (a.from_excitation) o.input_role = data::Role::excitation;
  const auto estimator = choose_word("--estimator", a.estimator, {"auto", "h1", "h2", "hv", "iv"});
  if (estimator > 0) o.estimator = static_cast<Estimator>(estimator - 1);
  o.window = static_cast<identification::Window>(choose_word(
      "--window", a.window, {"hann", "rectangular", "hamming", "blackman-harris", "flat-top"}));
  if (a.block && (*a.block < 16 || *a.block % 2 != 0))
    bad_argument(fmt::format("--block {}", *a.block),
                 "a block has an even number of samples, at least 16");
  o.block_length = a.block;
  if (a.overlap && !(*a.overlap >= 0.0 && *a.overlap < 100.0))
    bad_argument(fmt::format("--overlap {}", *a.overlap), "must be from 0 to below 100 per cent");
  if (a.overlap) o.overlap = *a.overlap / 100.0;
  if (!a.period.empty()) o.period = time_of("--period", a.period);
  if (!a.settling.empty()) o.settling = time_of("--settling", a.settling);
  if (a.accelerometers || !a.sensors.empty())
    use_accelerometers(a, experiment, o);
  else
    o.platform = platform_frame(a, experiment);
  return o;
}

}  // namespace

std::optional<RecordMachine> measured_machine(const MeasurementArguments& a,
                                              const data::Experiment* experiment) {
  if (a.known) return a.known;
  return record_machine(experiment, a.files[0], a.machine, a.pose, a.model);
}

spatial::Vector3 measured_point(const MeasurementArguments& a, const RecordMachine& machine) {
  const auto& X_BP = machine.pose.X_BP;
  if (a.p_PQ) return X_BP * *a.p_PQ;
  if (a.point.empty()) return kinematics::mass_center(machine.file.machine, X_BP);
  return X_BP * cli::point(a.point);
}

void add_measurement_options(Command command, MeasurementArguments& a) {
  command.add_option(
      "--inputs", a.inputs,
      "Input channels, names with commas; default by role: drive inside a loop, else excitation");
  command.add_option("--outputs", a.outputs, "Output channels; default: role response");
  command.add_flag("--from-drive", a.from_drive,
                   "Take the drives as inputs, the excitations as instruments: the machine without "
                   "its controller (default where the excitations are commands)");
  command.add_flag("--from-excitation", a.from_excitation,
                   "Take the excitations as inputs: the machine with its controller");
  command.add_flag(
      "--accelerometers", a.accelerometers,
      "Outputs: the accelerometers, as accelerations of the platform in six directions");
  command
      .add_option("--sensor", a.sensors,
                  "\"NAME, at=X Y Z, along=x\": where an accelerometer sits, in the platform frame "
                  "[m], for records that do not say it; may be repeated")
      .allow_extra_args(false);
  command.add_option("--instruments", a.instruments,
                     "External excitations of a closed loop; default: role excitation");
  command
      .add_option("--estimator", a.estimator,
                  "auto, h1, h2, hv or iv (instrumental, for inputs inside a closed loop)")
      .capture_default_str();
  command.add_option("--block", a.block, "Samples per block; default: from the record's length");
  command.add_option("--overlap", a.overlap, "Overlap of blocks in per cent; default: 50");
  command
      .add_option("--window", a.window, "hann, rectangular, hamming, blackman-harris or flat-top")
      .capture_default_str();
  command.add_option("--period", a.period,
                     "Period of the excitation, s or with a unit; 0: none; default: found out");
  command.add_option("--settling", a.settling, "Time at the beginning that is passed over");
  command.add_option("--sample-rate,--rate", a.sample_rate, "For files that do not tell it");
  command.add_option("--machine", a.machine,
                     "Machine file: turns leg lengths into platform directions, and is what modes "
                     "are compared with; default: the one in the record");
  command.add_option("--pose", a.pose,
                     "Pose of the record, for the machine; default: as the record says, else "
                     "neutral");
  command.add_option("--model", a.model,
                     "rigid, guide or full, for the machine; default: as the record says");
  command.add_option("--point", a.point,
                     "Point whose motion is meant, \"x,y,z\" in the platform's frame; default: the "
                     "mass centre");
}

data::RecordSet open_records(const MeasurementArguments& a) {
  if (a.sample_rate.empty()) return data::RecordSet(a.files);
  const double rate = plain_or_quantity("--sample-rate " + a.sample_rate, a.sample_rate, "Hz");
  if (!(rate > 0.0)) bad_argument("--sample-rate " + a.sample_rate, "must be positive");
  return data::RecordSet(a.files, {.sample_rate = rate});
}

identification::Measurement measure(data::RecordSet& records, const MeasurementArguments& arguments,
                                    bool output_only) {
  const auto options = options_of(arguments, records.experiment());
  const InterruptNote interrupt;
  ProgressLine line("reading");
  const auto going_on = [&](double share) {
    line.update(share);
    return !InterruptNote::noted();
  };
  auto result = output_only ? identification::measure_outputs(records, options, going_on)
                            : identification::measure_responses(records, options, going_on);
  print_diagnostics(result.notes);
  if (result.interrupted)
    result.responses.warnings.push_back(fmt::format(
        "interrupted: {} samples were read, and the result is of these", result.samples));
  print_warnings(arguments.files[0], result.responses.warnings);
  return result;
}

identification::GroupedSpectra measure_in_groups(data::RecordSet& records,
                                                 const MeasurementArguments& arguments,
                                                 int groups) {
  const auto options = options_of(arguments, records.experiment());
  ProgressLine line("reading again");
  return identification::measure_groups(records, options, groups, [&](double share) {
    line.update(share);
    return true;
  });
}

std::size_t result_format(const std::string& format, const std::string& output,
                          const std::vector<std::string_view>& words) {
  std::string word = format;
  if (word.empty()) {
    const auto dot = output.rfind('.');
    const std::string ending = dot == std::string::npos ? "" : output.substr(dot + 1);
    word = ending == "unv" || ending == "uf" ? "uff" : ending;
    if (std::ranges::find(words, word) == words.end()) word = words[0];
  }
  const auto chosen = choose_word("--format", word, words);
  if (output == "-" && (word == "uff" || word == "mat"))
    bad_argument("--format " + word, "such a file needs a name: add -o FILE." + word);
  return chosen;
}

void print_warnings(const std::string& file, const std::vector<std::string>& warnings) {
  std::vector<base::Diagnostic> list;
  for (const auto& text : warnings)
    list.push_back({.severity = base::Severity::warning, .file = file, .message = text});
  print_diagnostics(list);
}

std::string measurement_text(const identification::FrequencyResponses& r) {
  const auto counted = [](std::size_t n, const char* what) {
    return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
  };
  std::string text = fmt::format(
      "{}, {}, {} lines from {:.4g} Hz to {:.4g} Hz", counted(r.inputs.size(), "input"),
      counted(r.outputs.size(), "output"), r.lines(), r.frequency.front(), r.frequency.back());
  if (r.averages > 0.0)
    text += fmt::format(", {} with {:.1f} independent averages",
                        identification::estimator_text(r.estimator), r.averages);
  return text;
}

}  // namespace hydrapod::cli
