#include "hydrapod/identification_arguments.hpp"
#include "hydrapod/base/error.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hydrapod/base/text.hpp"
#include "hydrapod/machine_arguments.hpp"
#include "hydrapod/record_arguments.hpp"
#include "hydrapod/rig/rig.hpp"

namespace hydrapod::cli {

namespace {

/// Names separated by commas; none for an empty text.
std::vector<std::string> names(const char* option, const std::string& text) {
  if (text.empty()) return {};
  auto list = base::split(text, ",");
  for (auto at = list.begin(); at != list.end(); ++at) {
    if (at->empty())
      base::refuse(fmt::format("{} {}", option, text),
                   "a name is empty; names of channels are separated by commas");
    if (std::find(list.begin(), at, *at) != at)
      base::refuse(fmt::format("{} {}", option, text),
                   fmt::format("the channel '{}' is named twice", *at));
  }
  return list;
}

/// A quantity that must not be negative; none for an empty text.
std::optional<double> optional_quantity(const char* option, const std::string& text,
                                        const char* unit, const char* what) {
  if (text.empty()) return {};
  const std::string argument = std::string(option) + " " + text;
  const double value = plain_or_quantity(argument, text, unit);
  if (!(value >= 0.0)) base::refuse(argument, fmt::format("{} cannot be negative", what));
  return value;
}

identification::MeasureOptions estimate_options(const MeasurementArguments& a) {
  identification::MeasureOptions o{.inputs = names("--inputs", a.inputs),
                                   .outputs = names("--outputs", a.outputs),
                                   .instruments = names("--instruments", a.instruments)};
  if (a.from_drive && a.from_excitation)
    base::refuse("--from-drive", "and --from-excitation exclude each other");
  if (a.from_drive) o.input_role = data::Role::drive;
  if (a.from_excitation) o.input_role = data::Role::excitation;
  const auto estimator = choose_word("--estimator", a.estimator, {"auto", "h1", "h2", "hv", "iv"});
  if (estimator > 0) o.estimator = static_cast<identification::Estimator>(estimator - 1);
  o.window = static_cast<identification::Window>(
      choose_word("--window", a.window,
                  {"hann", "rectangular", "hamming", "blackman-harris", "flat-top", "blackman"}));
  if (a.block && (*a.block < 16 || *a.block % 2 != 0))
    base::refuse(fmt::format("--block {}", *a.block),
                 "a block has an even number of samples, at least 16");
  o.block_length = a.block;
  if (a.overlap && !(*a.overlap >= 0.0 && *a.overlap < 100.0))
    base::refuse(fmt::format("--overlap {}", *a.overlap), "must be from 0 to below 100 per cent");
  if (a.overlap && *a.overlap > 0.0 && *a.overlap < 1.0)
    base::refuse(fmt::format("--overlap {}", *a.overlap),
                 fmt::format("is in per cent: write {:g} for {:g} of a block", 100.0 * *a.overlap,
                             *a.overlap));
  if (a.overlap) o.overlap = *a.overlap / 100.0;
  o.period = optional_quantity("--period", a.period, "s", "a time");
  if (a.whole_record) o.whole_record = true;
  if (a.whole_record && (a.block || a.overlap || !a.period.empty() || estimator > 0 ||
                         o.window != identification::Window::hann))
    base::refuse(
        "--whole-record",
        "takes no blocks: leave --block, --overlap, --window, --estimator and --period out");
  o.settling = optional_quantity("--settling", a.settling, "s", "a time").value_or(0.0);
  return o;
}

}  // namespace

void add_measurement_options(Command command, MeasurementArguments& a) {
  command.add_options(
      {{"--inputs", a.inputs,
        "Input channels, names separated by commas; default by role: drive in a "
        "closed loop, else excitation"},
       {"--outputs", a.outputs, "Output channels; default: role response"},
       {"--from-drive", a.from_drive,
        "Inputs are the drives, instruments the excitations: the machine without its "
        "controller (default where the excitations are commands)"},
       {"--from-excitation", a.from_excitation,
        "Inputs are the excitations: the machine with its controller"},
       {"--accelerometers", a.accelerometers,
        "Outputs: the accelerometers, as accelerations of the platform in six directions"},
       {"--sensor", a.sensors,
        "\"NAME, at=X Y Z, along=x\": position of an accelerometer in the platform frame "
        "[m], for records that do not state it; may be repeated",
        one_each},
       {"--instruments", a.instruments,
        "External excitations of a closed loop; default: role excitation"},
       {"--estimator", a.estimator,
        "auto, h1, h2, hv or iv (instrumental, for inputs in a closed loop)"},
       {"--block", a.block, "Samples per block; default: from the record's length"},
       {"--whole-record", a.whole_record,
        "Modes of a short record with inputs, no hits, from the whole record at once, or an error "
        "where that cannot be; default: where it can, else from averages of blocks"},
       {"--overlap", a.overlap, "Overlap of blocks in per cent; default: 50"},
       {"--window", a.window, "hann, rectangular, hamming, blackman-harris, flat-top or blackman"},
       {"--period", a.period,
        "Period of the excitation, s or with a unit; 0: none; default: detected"},
       {"--exponential-window", a.exponential_window,
        "Time constant of the exponential window that an analyser applied after a hit, s or with a "
        "unit: its damping is taken out; default: as the file says, else none"},
       {"--settling", a.settling, "Time at the beginning that is left out"},
       {"--rate", a.rate, "Sample rate, Hz or with a unit, for files that do not state it"},
       {"--sample-rate,--file-rate", a.rate, "", hidden},
       {"--machine", a.machine,
        "Machine file for the transformation of leg lengths and the comparison of "
        "modes; default: the one in the record",
        reads},
       {"--pose", a.pose, "Pose of the record; default: that of the record, else neutral"},
       {"--model", a.model, "rigid, guide or full; default: that of the record"},
       {"--point", a.point,
        "Point of the platform, \"x,y,z\" in its frame; default: the mass centre"}});
}

void add_identification_options(Command command, IdentificationArguments& a) {
  add_measurement_options(command, a.measurement);
  command.add_options(
      {{"--from", a.from, "Lowest frequency, Hz or with a unit; default: from the record"},
       {"--to", a.to, "Highest frequency, Hz or with a unit; default: from the record"},
       {"--order", a.order, "Highest model order; default: from the number of references",
        range(4, 200)},
       {"--highest-damping", a.highest_damping,
        "Damping ratio in % above which a pole is not counted as a mode", range(0.1, 90.0)},
       {"--against", a.against,
        "Model to compare with: auto, mechanics (on oil springs), plant (with "
        "hydraulics), system (with controller too) or none"}});
}

tasks::MeasureOptions measure_options(const MeasurementArguments& a) {
  tasks::MeasureOptions options{.files = a.files,
                                .sample_rate = sample_rate("--rate", a.rate),
                                .estimate = estimate_options(a),
                                .accelerometers = a.accelerometers,
                                .machine = a.machine,
                                .pose = a.pose,
                                .model = model_kind(a.model)};
  if (!a.exponential_window.empty())
    options.exponential_window =
        positive_quantity("--exponential-window", a.exponential_window, "s", "must be positive");
  for (const auto& text : a.sensors) {
    const auto sensor = rig::parse_accelerometer(text);
    options.sensors.push_back({sensor.name, sensor.p_P, sensor.e_P});
  }
  if (!a.point.empty()) options.p_PQ = point("--point", a.point);
  return options;
}

tasks::IdentifyOptions identify_options(const IdentificationArguments& a) {
  tasks::IdentifyOptions options{.measure = measure_options(a.measurement),
                                 .compare = a.against != "none",
                                 .against = observed_system(a.against, "none")};
  auto& modes = options.modes;
  modes.from = optional_quantity("--from", a.from, "Hz", "a frequency");
  modes.to = optional_quantity("--to", a.to, "Hz", "a frequency");
  if (modes.from && modes.to && *modes.from >= *modes.to)
    base::refuse("--from " + a.from, "must be less than --to " + a.to);
  modes.orders.highest = a.order;
  modes.highest_damping = a.highest_damping / 100.0;
  return options;
}

report::PlotText measured_plot_text(const std::vector<std::string>& files,
                                    const tasks::Measured& measured,
                                    const identification::FrequencyResponses& responses) {
  const auto of_responses = report::measurement_text(responses);
  const std::string file =
      files.front() +
      (files.size() > 1 ? fmt::format(" and {} more", files.size() - 1) : std::string());
  const bool titled = measured.header && !measured.header->title.empty();
  if (!titled) return {file, of_responses};
  return {measured.header->title, file + "; " + of_responses};
}

std::optional<observation::Observed> observed_system(const std::string& word,
                                                     const std::string& also) {
  std::vector<std::string_view> words{"auto", "mechanics", "plant", "system"};
  if (!also.empty()) words.push_back(also);
  const auto chosen = choose_word("--against", word, words);
  if (chosen == 0 || chosen > 3) return {};
  return static_cast<observation::Observed>(chosen - 1);
}

}  // namespace hydrapod::cli
