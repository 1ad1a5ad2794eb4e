#include "hydrapod/tasks/measurement.hpp"
#include "hydrapod/base/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/kinematics/check_machine.hpp"
#include "hydrapod/report/measured_results.hpp"

namespace hydrapod::tasks {

namespace {

using Diagnostics = std::vector<base::Diagnostic>;

void add_warning(const std::string& file, const std::string& text, Diagnostics& warnings) {
  warnings.push_back({.severity = base::Severity::warning, .file = file, .message = text});
}

/// Those of responses or of identified modes, in words.
template <class Warning>
void add_warnings(const std::string& file, const std::vector<Warning>& found,
                  Diagnostics& warnings) {
  for (const auto& warning : found) add_warning(file, report::warning_text(warning), warnings);
}

void append(const Diagnostics& more, Diagnostics& all) {
  all.insert(all.end(), more.begin(), more.end());
}

/// A pose of the machine by its name, else by its numbers, else by what its name says.
model::NamedPose recorded_pose(const model::Machine& machine, const data::Experiment* e) {
  if (e == nullptr || e->pose_name.empty()) return pose_of(machine, "neutral");
  if (find_pose(machine, e->pose_name) != nullptr || !e->pose)
    return pose_of(machine, e->pose_name);
  const auto& p = *e->pose;
  return {e->pose_name,
          {.R_BP = spatial::rotation_from_rpy({p[3], p[4], p[5]}), .p_BP = {p[0], p[1], p[2]}}};
}

dynamics::ModelKind recorded_model(const model::Machine& machine, const data::Experiment* e) {
  for (const auto kind :
       {dynamics::ModelKind::rigid, dynamics::ModelKind::guide, dynamics::ModelKind::full})
    if (e != nullptr && e->model == dynamics::name(kind)) return model_of(machine, kind);
  return model_of(machine);
}

/// The machine that was measured, where one is known.
std::optional<Machine> measured_machine(const MeasureOptions& options,
                                        const data::Experiment* experiment) {
  if (options.known) return options.known;
  Machine found;
  if (!options.machine.empty()) {
    found.path = options.machine;
    found.file = model::read_machine_file(found.path, {}, kinematics::check_machine);
  } else if (experiment != nullptr && !experiment->machine.empty()) {
    found.path = options.files.front() + " (machine)";
    found.file = model::parse_machine(experiment->machine, found.path, experiment->overrides,
                                      kinematics::check_machine);
  } else {
    return {};
  }
  const auto& machine = found.file.machine;
  found.pose =
      options.pose.empty() ? recorded_pose(machine, experiment) : pose_of(machine, options.pose);
  found.kind = options.model             ? model_of(machine, options.model)
               : options.machine.empty() ? recorded_model(machine, experiment)
                                         : model_of(machine);
  return found;
}

/// The point whose motion is meant, in B [m].
spatial::Vector3 measured_point(const MeasureOptions& options, const Machine& machine) {
  const auto& X_BP = machine.pose.X_BP;
  return options.p_PQ ? X_BP * *options.p_PQ : kinematics::mass_center(machine.file.machine, X_BP);
}

/// The sensors given, else those of the record; of these the ones that `outputs` names, if it does.
std::vector<data::PlacedSensor> chosen_sensors(const MeasureOptions& options,
                                               const data::Experiment& experiment) {
  const auto& all = options.sensors.empty() ? experiment.sensors : options.sensors;
  if (all.empty())
    base::refuse(
        "--accelerometers",
        "the record does not state the positions of its accelerometers: add --sensor \"NAME, at=X "
        "Y Z, along=z\" for each, in the platform frame [m]");
  const auto& wanted = options.estimate.outputs;
  if (wanted.empty()) return all;
  std::vector<data::PlacedSensor> some;
  for (const auto& name : wanted) {
    const auto found = std::ranges::find(all, name, &data::PlacedSensor::name);
    if (found == all.end())
      base::refuse("--outputs " + name, "is not a sensor with a known position");
    some.push_back(*found);
  }
  return some;
}

/// Accelerometers as outputs, and what makes directions of the platform of them.
void use_accelerometers(const MeasureOptions& options, const Measured& measured,
                        identification::MeasureOptions& estimate) {
  if (!measured.machine)
    base::refuse("--accelerometers",
                 "the pose of the platform is needed: add --machine FILE and --pose");
  const auto& X_BP = measured.machine->pose.X_BP;
  std::vector<identification::LinearSensor> sensors;
  const auto chosen = chosen_sensors(options, *measured.experiment());
  estimate.outputs.clear();
  for (const auto& sensor : chosen) {
    estimate.outputs.push_back(sensor.name);
    sensors.push_back({X_BP * sensor.position, X_BP.R_BP * sensor.axis});
  }
  estimate.outputs_to_platform = identification::platform_from_accelerometers(
      sensors, measured_point(options, *measured.machine));
}

identification::MeasureOptions estimate_options(const MeasureOptions& options,
                                                const Measured& measured) {
  auto estimate = options.estimate;
  if (measured.from_accelerometers)
    use_accelerometers(options, measured, estimate);
  else if (measured.machine)
    estimate.platform =
        identification::PlatformFrame{.machine = measured.machine->file.machine,
                                      .X_BP = measured.machine->pose.X_BP,
                                      .p_BQ = measured_point(options, *measured.machine)};
  return estimate;
}

/// The records opened, the machine that was measured found.
Measured opened(const MeasureOptions& options) {
  Measured measured;
  measured.records.emplace(options.files, data::ReadOptions{.sample_rate = options.sample_rate});
  measured.from_accelerometers = options.accelerometers || !options.sensors.empty();
  measured.header = measured.records->header();
  measured.machine = measured_machine(options, measured.experiment());
  return measured;
}

void note_reading(const MeasureOptions& options, Measured& measured) {
  auto& m = measured.measurement;
  append(m.notes, measured.warnings);
  if (m.interrupted)
    m.responses.warnings.push_back(
        {.kind = data::ResponseWarning::Kind::interrupted, .count = m.samples});
  add_warnings(options.files.front(), m.responses.warnings, measured.warnings);
}

/// The JSON in `path`, whose kind must be one of `kinds`.
report::Json parsed_json(const std::string& path, const std::vector<std::string>& kinds) {
  constexpr std::size_t largest = std::size_t{1} << 31;
  report::Json json;
  try {
    json = report::Json::parse(base::read_file(path, largest, "JSON of hydrapod"));
  } catch (const nlohmann::json::parse_error& error) {
    base::refuse(path, fmt::format("is not JSON: {}", error.what()));
  }
  const auto kind = json.is_object() ? json.find("kind") : json.end();
  if (kind == json.end() || std::ranges::count(kinds, kind->dump()) > 0) return json;
  throw base::InputError({{.file = path,
                           .key = "kind",
                           .message = fmt::format("is {}; accepted here are {}", kind->dump(),
                                                  fmt::join(kinds, ", "))}});
}

void refuse_modal_results(const std::string& path) {
  if (data::file_kind(path) == data::FileKind::modal_results)
    base::refuse(
        path,
        "holds modes (dataset 55) without their uncertainties; JSON or CSV of `hydrapod identify` "
        "has them");
}

/// Responses and their experiment.
Measured responses_from(const report::Json& json, const std::string& path) {
  Measured measured;
  measured.measurement.responses = report::responses_from_json(json, path);
  measured.header = report::record_origin_from_json(json, path);
  add_warnings(path, measured.measurement.responses.warnings, measured.warnings);
  return measured;
}

Measured responses_of_universal_file(const std::string& path) {
  auto read = data::read_frequency_responses(path);
  Measured measured{.warnings = read.notes};
  measured.measurement.responses = std::move(read.responses);
  return measured;
}

void add_bootstrap(const IdentifyOptions& options, const Progress& progress, Identified& found) {
  if (found.modes.modes.empty()) return;
  auto& measured = found.measured;
  if (!measured.records)
    base::refuse("--bootstrap", fmt::format("resamples the blocks of a record; {} is not one",
                                            options.measure.files.front()));
  constexpr int groups = 24;
  const auto grouped = identification::measure_groups(
      *measured.records, estimate_options(options.measure, measured), groups);
  found.bootstrap = identification::bootstrap_modes(
      grouped.groups, grouped.choice, grouped.estimator, found.modes,
      {.resamples = options.bootstrap, .identify = options.modes}, progress);
}

/// Do the modes stay where they are? Not asked of periods, outputs alone, and closed loops, of
/// which errors of parts are not known well enough (docs/validation/identification.md).
void test_steadiness(const IdentifyOptions& options, Identified& found) {
  constexpr int parts = 4;
  auto& measured = found.measured;
  if (!measured.records || options.measure.output_only || measured.measurement.interrupted ||
      measured.measurement.spectra.options.periodic || found.modes.modes.empty() ||
      measured.responses().estimator == data::Estimator::instrumental)
    return;
  try {
    const auto grouped = identification::measure_groups(
        *measured.records, estimate_options(options.measure, measured), parts);
    identification::add_wandering(
        identification::wandering_modes(grouped.groups, grouped.choice, grouped.estimator,
                                        found.modes, options.modes),
        found.modes);
  } catch (const base::ComputationError&) {  // the parts are too short
  }
}

void add_comparison(const IdentifyOptions& options, Identified& found) {
  const auto& measured = found.measured;
  if (!measured.machine) {
    if (options.against)
      base::refuse(fmt::format("--against {}", observation::name(*options.against)),
                   "there is no machine to compare with: add --machine FILE");
    return;
  }
  const auto& machine = *measured.machine;
  const auto source = options.against         ? *options.against
                      : observed_in(measured) ? *observed_in(measured)
                                              : observation::Observed::mechanics;
  auto compared = report::compared_with(
      found.modes,
      {machine.file.machine, machine.pose.X_BP, measured_point(options.measure, machine)},
      machine.kind, source, options.modes.highest_damping);
  compared.machine = machine.file.machine.name;
  compared.pose = machine.pose.name;
  found.compared = std::move(compared);
}

/// Runs `extra`; that it cannot be had is a warning: the modes were found all the same.
template <class Extra>
void or_warn(const std::string& file, const char* what, Diagnostics& warnings, const Extra& extra) {
  try {
    extra();
  } catch (const base::ComputationError& error) {
    add_warning(file, fmt::format("{}: {}", what, error.what()), warnings);
  } catch (const std::invalid_argument& error) {
    add_warning(file, fmt::format("{}: {}", what, error.what()), warnings);
  }
}

/// Modes that were calculated: of mechanics, those that the platform feels.
observation::Targets calculated_targets(const report::Json& json, const std::string& path,
                                        const model::Machine& machine) {
  constexpr double shape_deviation = 0.05;  // as in lists of modes that do not say it
  observation::Targets targets{.title = path, .deviations_given = false};
  const auto pose = report::pose_from_json(json, path);
  if (find_pose(machine, pose.name) == nullptr)
    base::refuse(
        path,
        fmt::format("holds modes at pose \"{}\", which the machine file does not have", pose.name));
  for (const auto& entry : report::modes_from_json(json, path).real.modes) {
    const auto& mode = entry.mode;
    if (!entry.moves_platform || !(mode.omega > 0.0)) continue;
    observation::ModeTarget target{.name = fmt::format("{:.3f} Hz", mode.omega / base::two_pi),
                                   .pose = pose.name,
                                   .omega = mode.omega,
                                   .deviation = observation::default_deviation * mode.omega};
    int direction = 0;
    entry.energy.platform.maxCoeff(&direction);
    target.direction = direction;
    if (!mode.is_complex()) {
      target.shape = mode.real.head<6>();
      target.shape_deviation = shape_deviation;
    }
    targets.modes.push_back(target);
  }
  if (targets.modes.empty()) base::refuse(path, "contains no mode with platform motion");
  return targets;
}

/// Where a record says it: what its inputs see, and the point that forces of the rig act at.
void look_into(const Measured& measured, observation::MeasuredAt& at) {
  if (!at.observed) at.observed = observed_in(measured);
  const auto* experiment = measured.experiment();
  if (experiment == nullptr || !experiment->excitation || experiment->machine.empty()) return;
  at.force_point = model::parse_machine(experiment->machine, "the record", experiment->overrides)
                       .machine.platform.mass_center;
}

/// Targets of responses, by way of their modes.
observation::Targets identified_targets(const Measured& measured, const std::string& path,
                                        const Machine& machine, observation::MeasuredAt at,
                                        const Progress& progress, Diagnostics& warnings) {
  look_into(measured, at);
  append(measured.warnings, warnings);
  const auto found = identification::identify_modes(measured.responses(), {}, [&](double share) {
    if (progress) progress(share);
  });
  add_warnings(path, found.warnings, warnings);
  if (found.modes.empty())
    base::refuse(
        path,
        "no mode was found in it; use a longer record or a higher excitation (`hydrapod identify` "
        "shows details)");
  auto targets =
      observation::measured_modes(identification::modal_results(found), machine.file.machine, at);
  if (auto all = observation::measured_responses(measured.responses(), machine.file.machine, at))
    targets.responses.push_back(std::move(*all));
  return targets;
}

/// "run.h5@low".
struct MeasuredFile {
  std::string option{};  ///< as messages call it
  std::string path{};
  std::string pose{};
  bool says_pose{};
};

/// The file and the pose; a file whose own name has an @ is taken as it is.
MeasuredFile file_and_pose(const std::string& text, const Machine& machine) {
  MeasuredFile file{.option = "--measured " + text, .path = text, .pose = machine.pose.name};
  const auto at = text.rfind('@');
  if (at == std::string::npos || std::filesystem::exists(text)) return file;
  file.path = text.substr(0, at);
  file.pose = text.substr(at + 1);
  file.says_pose = true;
  if (file.path.empty()) base::refuse(file.option, "names no file; expected FILE or FILE@POSE");
  std::vector<std::string_view> names;
  for (const auto& known : machine.file.machine.poses) names.push_back(known.name);
  if (std::ranges::find(names, file.pose) != names.end()) return file;
  const auto near = base::nearest(file.pose, names);
  base::refuse(
      file.option,
      fmt::format("expected the name of a pose of the machine file after the @; {}it has {}",
                  near ? fmt::format("did you mean '{}'? ", *near) : "", fmt::join(names, ", ")));
}

const char* origin(observation::Observed observed) {
  constexpr std::array words{"contains modes or responses of the mechanics",
                             "was measured with the valve drives as inputs",
                             "was measured on the controlled machine"};
  return words[static_cast<std::size_t>(observed)];
}

/// Of one file.
observation::Targets read_one(const MeasuredFile& file, const Machine& machine,
                              std::optional<observation::Observed> observed,
                              const Progress& progress, Diagnostics& warnings) {
  const auto& path = file.path;
  observation::MeasuredAt at{
      .pose = file.pose, .point = machine.file.machine.platform.mass_center, .observed = observed};
  if (is_mode_list(path)) {
    auto targets = calibration::read_targets(path).targets;
    targets.observed = observed.value_or(targets.observed);
    return targets;
  }
  const auto& of = machine.file.machine;
  const auto kind = data::file_kind(path);
  if (kind == data::FileKind::mode_table) {
    const auto list = report::identified_modes_from_csv(path);
    at.against = list.against;
    if (!at.observed) at.observed = list.observed;
    return observation::measured_modes(list.modes, of, at);
  }
  if (kind == data::FileKind::json) {
    const auto json = parsed_json(path, {"\"identified_modes\"", "\"modes\"", "\"frf\""});
    if (!json.is_object())
      base::refuse(path, "expected an object of `hydrapod identify` or `hydrapod frf`");
    if (json.contains("matrices") || json.contains("rigid_modes"))
      return calculated_targets(json, path, of);
    if (!json.contains("modes"))
      return identified_targets(responses_from(json, path), path, machine, at, progress, warnings);
    Measured measured;
    measured.header = report::record_origin_from_json(json, path);
    auto modes = report::identification_from_json(json, path);
    measured.measurement.responses.inputs = modes.responses.inputs;
    add_warnings(path, modes.warnings, warnings);
    look_into(measured, at);
    return observation::measured_modes(identification::modal_results(modes), of, at);
  }
  refuse_modal_results(path);
  MeasureOptions options{.files = {path}, .known = machine};
  options.known->pose = *find_pose(machine.file.machine, file.pose);
  options.p_PQ = at.point;
  return identified_targets(frf(options, progress), path, machine, at, progress, warnings);
}

}  // namespace

bool is_mode_list(const std::string& path) {
  const auto kind = data::file_kind(path);
  return kind == data::FileKind::toml ||
         (kind == data::FileKind::mode_table && !report::is_identified_modes_csv(path));
}

Measured frf(const MeasureOptions& options, const Progress& progress) {
  const auto& first = options.files.at(0);
  const auto kind = data::file_kind(first);
  if (kind == data::FileKind::json || kind == data::FileKind::frequency_responses) {
    if (options.files.size() > 1)
      base::refuse(options.files[1],
                   "only records are averaged: give one file of frequency responses");
    if (options.output_only)
      base::refuse("--output-only", fmt::format("needs a record; {} holds responses", first));
    auto measured = kind == data::FileKind::json
                        ? responses_from(parsed_json(first, {"\"frf\""}), first)
                        : responses_of_universal_file(first);
    measured.machine = measured_machine(options, measured.experiment());
    return measured;
  }
  if (kind == data::FileKind::mode_table || kind == data::FileKind::toml)
    base::refuse(
        first, fmt::format("holds {}; expected records, JSON of `hydrapod frf` or a Universal File",
                           kind == data::FileKind::toml ? "no measurement, as TOML"
                                                        : "a table of frequencies"));
  refuse_modal_results(first);
  auto measured = opened(options);
  const auto estimate = estimate_options(options, measured);
  measured.measurement =
      options.output_only
          ? identification::measure_outputs(*measured.records, estimate, progress)
          : identification::measure_responses(*measured.records, estimate, progress);
  note_reading(options, measured);
  return measured;
}

std::optional<observation::Observed> observed_in(const Measured& measured) {
  if (measured.experiment() == nullptr || !measured.experiment()->excitation) return {};
  return observation::from_drives(measured.responses().inputs) ? observation::Observed::plant
                                                               : observation::Observed::system;
}

Identified identify(const IdentifyOptions& options, const Progress& progress) {
  Identified found;
  found.measured = frf(options.measure, numerics::part_of(progress, 0.0, 0.4));
  const auto& file = options.measure.files.front();
  found.modes =
      identification::identify_modes(found.measured.responses(), options.modes, [&](double share) {
        if (progress) progress(0.4 + 0.6 * share);
      });
  test_steadiness(options, found);
  found.warnings = found.measured.warnings;
  add_warnings(file, found.modes.warnings, found.warnings);
  if (found.modes.modes.empty()) return found;
  if (options.compare)
    or_warn(found.measured.machine ? found.measured.machine->path : file,
            "not compared with the model", found.warnings, [&] { add_comparison(options, found); });
  if (options.cross_check)
    or_warn(file, "no ERA modes", found.warnings, [&] {
      found.cross_checks = identification::cross_check(found.modes, found.measured.responses());
    });
  if (options.bootstrap > 0)
    or_warn(file, "no bootstrap", found.warnings, [&] { add_bootstrap(options, progress, found); });
  return found;
}

MeasuredTargets read_measured(const Machine& machine, const MeasuredOptions& options,
                              const Progress& progress) {
  std::vector<MeasuredFile> files;  // all looked at before the first, which may take long
  for (const auto& text : options.files) {
    auto one = file_and_pose(text, machine);
    if (std::ranges::count(files, one.path, &MeasuredFile::path) > 0)
      base::refuse(one.option, fmt::format("{} is given twice; it would count twice", one.path));
    if (one.says_pose && is_mode_list(one.path))
      base::refuse(
          one.option,
          "a list of modes states the pose of each mode (pose = \"low\", or a column \"pose\"); "
          "give the file without @POSE");
    files.push_back(std::move(one));
  }
  MeasuredTargets result;
  auto& all = result.targets;
  for (const auto& file : files) {
    auto one = read_one(file, machine, options.observed, progress, result.warnings);
    if (&file == &files.front()) {
      all = std::move(one);
      continue;
    }
    if (one.observed != all.observed)
      base::refuse(
          file.option,
          fmt::format("it {}, and {} {}: these are different systems; diagnose from one of them",
                      origin(one.observed), options.files.front(), origin(all.observed)));
    all.deviations_given = all.deviations_given && one.deviations_given;
    std::ranges::move(one.modes, std::back_inserter(all.modes));
    std::ranges::move(one.responses, std::back_inserter(all.responses));
  }
  return result;
}

}  // namespace hydrapod::tasks
