#include "hydrapod/identification_run.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hydrapod/base/file.hpp"
#include "hydrapod/diagnosis/measured.hpp"
#include "hydrapod/identification/exchange.hpp"
#include "hydrapod/interrupt.hpp"
#include "hydrapod/machine_arguments.hpp"
#include "hydrapod/report/identification_json.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

namespace {

const std::vector<std::string_view> against_words{"auto", "mechanics", "plant", "system", "none"};

std::optional<double> frequency(const std::string& option, const std::string& text) {
  if (text.empty()) return {};
  const double value = plain_or_quantity(option + " " + text, text, "Hz");
  if (!(value >= 0.0)) bad_argument(option + " " + text, "a frequency cannot be negative");
  return value;
}

identification::IdentifyOptions options_of(const IdentificationArguments& a) {
  identification::IdentifyOptions o;
  o.from = frequency("--from", a.from);
  o.to = frequency("--to", a.to);
  if (o.from && o.to && *o.from >= *o.to)
    bad_argument("--from " + a.from, "must be less than --to " + a.to);
  o.orders.highest = a.order;
  o.highest_damping = a.highest_damping / 100.0;
  return o;
}

IdentifiedSource read_responses(const std::string& path) {
  constexpr std::size_t largest = std::size_t{1} << 31;
  const std::string text = base::read_file(path, largest, "frequency responses of `hydrapod frf`");
  report::Json json;
  try {
    json = report::Json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    bad_argument(path, fmt::format("is no JSON: {}", error.what()));
  }
  IdentifiedSource source{.responses = report::responses_from_json(json, path)};
  if (const auto header = report::record_origin_from_json(json, path)) {
    source.date = header->date;
    source.experiment = header->experiment;
  }
  return source;
}

observation::Source model_source(const IdentificationArguments& a, const IdentifiedSource& source) {
  const auto word = choose_word("--against", a.against, against_words);
  if (word > 0) return static_cast<observation::Source>(word - 1);
  return seen_in_rig(source.responses, source.experiment ? &*source.experiment : nullptr)
      .value_or(observation::Source::mechanics);
}

}  // namespace

std::optional<observation::Observed> seen_in_rig(
    const identification::FrequencyResponses& responses, const data::Experiment* experiment) {
  if (experiment == nullptr || !experiment->excitation) return std::nullopt;
  return diagnosis::from_drives(responses) ? observation::Observed::plant
                                           : observation::Observed::system;
}

void add_identification_options(Command command, IdentificationArguments& a) {
  add_measurement_options(command, a.measurement);
  command.add_option("--from", a.from, "Lowest frequency, Hz or with a unit; default: found out");
  command.add_option("--to", a.to, "Highest frequency, Hz or with a unit; default: found out");
  command.add_option("--order", a.order, "Highest model order").range(4, 100).capture_default_str();
  command
      .add_option("--highest-damping", a.highest_damping,
                  "Damping in per cent of critical above which a pole is no mode")
      .range(0.1, 90.0)
      .capture_default_str();
  command
      .add_option("--against", a.against,
                  "Model to compare with: auto, mechanics (on oil springs), plant (with "
                  "hydraulics), system (with controller too) or none")
      .capture_default_str();
}

void check_identification(const IdentificationArguments& a) {
  choose_word("--against", a.against, against_words);
  options_of(a);
}

std::optional<double> upper_frequency(const IdentificationArguments& a) {
  return frequency("--to", a.to);
}

IdentifiedSource identified_source(const IdentificationArguments& a) {
  const std::string& first = a.measurement.files[0];
  const bool alone = a.measurement.files.size() == 1;
  const auto kind = data::file_kind(first);
  if (kind == data::FileKind::json) {
    if (!alone)
      bad_argument(a.measurement.files[1],
                   "frequency responses stand alone: only records are "
                   "averaged together");
    return read_responses(first);
  }
  if (kind == data::FileKind::frequency_responses && alone) {
    auto read = data::read_frequency_response(first);
    print_diagnostics(read.notes);
    return {.responses = identification::from_exchange(read.response, first)};
  }
  IdentifiedSource source{.records = open_records(a.measurement)};
  auto m = measure(*source.records, a.measurement);
  source.responses = std::move(m.responses);
  source.date = m.header.date;
  source.experiment = std::move(m.header.experiment);
  if (m.from_legs) source.frame = "leg lengths brought to platform directions";
  if (a.measurement.accelerometers || !a.measurement.sensors.empty())
    source.frame = "accelerometers brought to platform directions";
  return source;
}

identification::Identification identified_modes(const IdentificationArguments& a,
                                                const IdentifiedSource& source) {
  identification::Identification result;
  {
    ProgressLine line("identifying");
    result = identification::identify_modes(source.responses, options_of(a),
                                            [&](double share) { line.update(share); });
  }
  print_warnings(a.measurement.files[0], result.warnings);
  return result;
}

std::optional<identification::BootstrapScatter> bootstrap_scatter(
    const IdentificationArguments& a, IdentifiedSource& source,
    const identification::Identification& result, int resamples) {
  if (result.modes.empty()) return {};
  const std::string& first = a.measurement.files[0];
  if (!source.records)
    bad_argument("--bootstrap", "draws from the blocks of a record; " + first + " is none");
  constexpr int groups = 24;
  try {
    const auto grouped = measure_in_groups(*source.records, a.measurement, groups);
    const InterruptNote interrupt;
    ProgressLine line("bootstrap");
    return identification::bootstrap_modes(
        grouped.groups, grouped.choice, grouped.estimator, result,
        {.resamples = resamples, .identify = options_of(a)}, [&](double share) {
          line.update(share);
          return !InterruptNote::noted();
        });
  } catch (const base::ComputationError& error) {
    print_warnings(first, {fmt::format("no bootstrap: {}", error.what())});
  } catch (const std::invalid_argument& error) {
    print_warnings(first, {fmt::format("no bootstrap: {}", error.what())});
  }
  return {};
}

std::vector<std::optional<identification::SecondOpinion>> second_opinions(
    const IdentificationArguments& a, const IdentifiedSource& source,
    const identification::Identification& result) {
  if (result.modes.empty()) return {};
  try {
    return identification::second_opinion(result, source.responses);
  } catch (const base::ComputationError& error) {
    print_warnings(a.measurement.files[0], {fmt::format("no second opinion: {}", error.what())});
    return {};
  }
}

std::optional<report::ComparedModes> compared_modes(const IdentificationArguments& a,
                                                    const IdentifiedSource& source,
                                                    const identification::Identification& result) {
  if (a.against == "none" || result.modes.empty()) return {};
  const auto machine =
      measured_machine(a.measurement, source.experiment ? &*source.experiment : nullptr);
  if (!machine) {
    if (a.against != "auto")
      bad_argument("--against " + a.against,
                   "there is no machine to compare with: add --machine FILE");
    return {};
  }
  report::ComparedModes compared{.source = model_source(a, source),
                                 .kind = machine->kind,
                                 .machine = machine->file.machine.name,
                                 .pose = machine->pose.name};
  try {
    compared.result = comparison::compare_modes(
        result,
        observation::model_modes(machine->file.machine, machine->pose.X_BP, machine->kind,
                                 compared.source),
        {machine->file.machine, machine->pose.X_BP, measured_point(a.measurement, *machine)},
        a.highest_damping / 100.0);
  } catch (const base::ComputationError& error) {
    print_warnings(machine->name, {fmt::format("not compared with the model: {}", error.what())});
    return {};
  }
  return compared;
}

}  // namespace hydrapod::cli
