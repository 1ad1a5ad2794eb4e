#include "hydrapod/tasks/measurement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "measured_files.hpp"

namespace hydrapod::tasks {

namespace {

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

/// What is in volts, or in another unit for each sensor, makes no motion of the platform.
void require_acceleration(const std::string& file, const data::RecordHeader& header,
                          const std::string& sensor) {
  const auto at = data::find_channel(header, sensor);
  if (!at) return;  // said where channels are looked up
  const std::string& unit = header.channels[*at].unit;
  const bool stated = !unit.empty() && unit != "1";
  if (stated && base::read_quantity("1 " + unit, "m/s^2").ok()) return;
  base::refuse(file,
               fmt::format("--accelerometers: {} {}; accepted are accelerations (m/s^2, g): state "
                           "the unit in the file (a title such as \"{} [g]\"), and divide volts by "
                           "the sensitivity of the sensor first",
                           base::printable(sensor),
                           stated ? "is in " + base::printable(unit, 30) : "has no unit",
                           base::printable(sensor)));
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
    require_acceleration(options.files.front(), *measured.header, sensor.name);
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
  const data::ReadOptions read{.sample_rate = options.sample_rate};
  if (options.records.empty())
    measured.records.emplace(options.files, read);
  else
    measured.records.emplace(options.records, options.files, read);
  measured.from_accelerometers = options.accelerometers || !options.sensors.empty();
  measured.header = measured.records->header();
  measured.machine = measured_machine(options, measured.experiment());
  return measured;
}

/// The geometry of the record, if an output is at one of its nodes: not after a change of outputs.
void keep_geometry(const data::Geometry& geometry, data::FrequencyResponses& responses) {
  const auto is_placed = [&](const data::Channel& channel) {
    return std::ranges::find(geometry.nodes, channel.point, &data::Node::number) !=
           geometry.nodes.end();
  };
  if (std::ranges::any_of(responses.outputs, is_placed)) responses.geometry = geometry;
}

void note_reading(const MeasureOptions& options, Measured& measured) {
  auto& m = measured.measurement;
  keep_geometry(measured.header->geometry, m.responses);
  append(m.notes, measured.warnings);
  if (m.interrupted)
    m.responses.warnings.push_back(
        {.kind = data::ResponseWarning::Kind::interrupted, .count = m.samples});
  add_warnings(options.files.front(), m.responses.warnings, measured.warnings);
}

/// What is said of responses for modes, where the file does not say it already.
void check_motions(const std::string& path, Measured& measured) {
  auto& responses = measured.measurement.responses;
  for (const auto& warning :
       identification::check_inputs(path, responses.inputs, responses.outputs)) {
    if (std::ranges::find(responses.warnings, warning.kind, &data::ResponseWarning::kind) !=
        responses.warnings.end())
      continue;
    responses.warnings.push_back(warning);
    add_warnings(path, std::vector{warning}, measured.warnings);
  }
}

Measured responses_of_file(const std::string& path) {
  auto read = data::read_frequency_responses(path);
  Measured measured{.warnings = read.notes};
  measured.measurement.responses = std::move(read.responses);
  return measured;
}

/// The time constant of the window that an analyser applied [s]: as asked, else by a line of the
/// notes of the record, "exponential window: 0.35 s"; none: there was none.
std::optional<double> window_of(const MeasureOptions& options, const Measured& measured) {
  if (options.exponential_window || !measured.header) return options.exponential_window;
  constexpr std::string_view key = "exponential window:";
  for (const std::string& line : base::split(measured.header->notes, "\n")) {
    if (!line.starts_with(key)) continue;
    const auto read = base::read_plain_or_quantity(line.substr(key.size()), "s");
    if (!read.ok())
      base::refuse(options.files.front(), fmt::format("note \"{}\": {}", line, read.problem));
    return read.value;
  }
  return {};
}

/// The window that was taken out of responses [s].
std::optional<double> window_taken_out(const data::FrequencyResponses& responses) {
  const auto said =
      std::ranges::find(responses.warnings, data::ResponseWarning::Kind::exponential_window,
                        &data::ResponseWarning::kind);
  if (said == responses.warnings.end()) return {};
  return said->value;
}

/// E[e_k e*_{k+d}] of noise times e^(−at), by E|e_k|²: the transform of e^(−2at) at d·Δω.
std::complex<double> covariance_under(double a, double turn) {
  return 2.0 * a / std::complex(2.0 * a, -turn);
}

/// The same of lines whose samples were multiplied by e^(−from·t), and now are by e^(−to·t).
/// Without a decay errors of lines are independent.
void change_decay(double from, double to, data::FrequencyResponses& r) {
  constexpr std::size_t most = 100;
  constexpr double least = 0.2;
  auto& covariance = r.line_covariance;
  if (!(to > 0.0)) covariance = {1.0};
  const bool known = covariance.size() > 1;
  for (std::size_t d = 1; to > 0.0 && d < std::min(known ? covariance.size() : most, r.lines());
       ++d) {
    const double turn = base::two_pi * (r.frequency[d] - r.frequency[0]);
    const auto now = covariance_under(to, turn);
    if (known)
      covariance[d] *= now / (from > 0.0 ? covariance_under(from, turn) : 1.0);
    else if (std::abs(now) > least)
      covariance.push_back(now);
  }
}

/// What samples times e^(−at) show is H(a + iω).
void take_out_window(const MeasureOptions& options, Measured& measured) {
  if (const auto known = window_taken_out(measured.responses())) {
    if (options.exponential_window)
      base::refuse("--exponential-window",
                   fmt::format("{} says that a window of {:.4g} s was taken out of it already",
                               options.files.front(), *known));
    return;
  }
  const auto window = window_of(options, measured);
  if (!window) return;
  const std::string where =
      options.exponential_window ? "--exponential-window" : options.files.front();
  if (!(*window > 0.0) || !std::isfinite(*window))
    base::refuse(where,
                 fmt::format("the time constant of an exponential window is {} s: it must be "
                             "positive",
                             *window));
  auto& m = measured.measurement;
  if (options.output_only || (measured.records && m.reading != nullptr))
    base::refuse(where, fmt::format("an exponential window begins with a hit, and {} is no hammer "
                                    "test: only responses and records of hits are corrected",
                                    options.files.front()));
  auto& responses = m.responses;
  change_decay(responses.shift, responses.shift + 1.0 / *window, responses);
  responses.shift += 1.0 / *window;
  responses.on_axis.clear();
  const data::ResponseWarning warning{.kind = data::ResponseWarning::Kind::exponential_window,
                                      .value = *window,
                                      .count = options.exponential_window ? 0 : 1};
  responses.warnings.push_back(warning);
  add_warnings(options.files.front(), std::vector{warning}, measured.warnings);
}

/// Under a window everything decays at least as fast as the window does: throws where a mode does
/// not, for then the window was another.
void check_window(const IdentifyOptions& options, const Measured& measured) {
  const auto window = window_taken_out(measured.responses());
  if (!window) return;
  auto as_recorded = measured.responses();
  as_recorded.shift -= 1.0 / *window;
  if (as_recorded.shift < 1e-9 / *window) as_recorded.shift = 0.0;
  change_decay(measured.responses().shift, as_recorded.shift, as_recorded);
  auto modes = options.modes;
  modes.fit.deviations = identification::Deviations::poles;
  double longest = 0.0, frequency = 0.0;
  for (const auto& mode : identification::identify_modes(as_recorded, modes).modes) {
    constexpr double sure = 4.0;  // standard deviations
    const double decay = mode.fit.damping_ratio() * mode.fit.omega() +
                         sure * mode.fit.damping_deviation * mode.fit.omega();
    if (!(decay < 1.0 / *window) || 1.0 / decay < longest) continue;
    longest = 1.0 / decay;
    frequency = mode.fit.omega() / base::two_pi;
  }
  if (longest > 0.0)
    base::refuse(
        options.measure.exponential_window ? fmt::format("--exponential-window {} s", *window)
                                           : options.measure.files.front(),
        fmt::format("a window with a time constant of {:.4g} s would leave no mode that "
                    "decays more slowly, and that at {:.4g} Hz has a time constant of {:.4g} "
                    "s or more: the window was longer, or there was none",
                    *window, frequency, longest));
}

void add_bootstrap(const IdentifyOptions& options, const Progress& progress, Identified& found) {
  if (found.modes.modes.empty()) return;
  auto& measured = found.measured;
  if (!measured.records)
    base::refuse("--bootstrap", fmt::format("resamples the blocks of a record; {} is not one",
                                            options.measure.files.front()));
  constexpr int groups = 24;
  const auto grouped = identification::measure_groups(
      *measured.records, measured.measurement, estimate_options(options.measure, measured), groups,
      [&](double) { return progress && progress(0.0); }, found.modes.to);
  found.bootstrap = identification::bootstrap_modes(
      grouped.groups, grouped.choice, grouped.estimator, found.modes,
      {.resamples = options.bootstrap, .identify = options.modes}, progress);
}

/// Do the modes stay where they are, and the channels as they are? Not asked of periods and of
/// outputs alone.
void test_steadiness(const IdentifyOptions& options, const Progress& progress, Identified& found) {
  auto& measured = found.measured;
  if (!measured.records || options.measure.output_only || measured.measurement.interrupted ||
      measured.measurement.spectra.options.periodic)
    return;
  bool stopped = false;
  try {
    const auto finding = identification::compare_parts(
        *measured.records, measured.measurement, estimate_options(options.measure, measured),
        found.modes, options.modes, {},
        [&](double) { return stopped = progress && progress(1.0); });
    identification::add_wandering(finding.wandering, found.modes);
    found.modes.needed_duration = finding.needed_duration;
    if (finding.changed) {
      identification::add_changed_channel(*finding.changed, found.modes);
      add_warnings(options.measure.files.front(), std::vector{*finding.changed}, found.warnings);
    }
  } catch (const base::ComputationError&) {  // the parts are too short
  }
  if (stopped) throw base::ComputationError("interrupted");
}

void compare_with(const Machine& machine, const IdentifyOptions& options, Identified& found) {
  const auto& measured = found.measured;
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

/// What the machine lacks for it is a warning: the modes were found all the same.
void add_comparison(const IdentifyOptions& options, Identified& found) {
  const auto& machine = found.measured.machine;
  if (!machine) {
    if (options.against)
      base::refuse(fmt::format("--against {}", observation::name(*options.against)),
                   "there is no machine to compare with: add --machine FILE");
    return;
  }
  try {
    compare_with(*machine, options, found);
  } catch (const base::InputError& error) {
    for (const auto& lacks : error.diagnostics())
      add_warning(machine->path,
                  fmt::format("not compared with the model: {} {}",
                              lacks.key.empty() ? lacks.file : lacks.key, lacks.message),
                  found.warnings);
  }
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

/// A record or responses. Throws base::InputError where the file holds neither.
data::FileKind kind_of_measurement(const std::string& path) {
  const auto kind = data::file_kind(path);
  if (kind == data::FileKind::mode_table || kind == data::FileKind::toml)
    base::refuse(path, fmt::format("holds {}; expected records, or responses of `hydrapod frf`",
                                   kind == data::FileKind::toml ? "no measurement, as TOML"
                                                                : "a table of frequencies"));
  refuse_modal_results(path);
  return kind;
}

/// The file of responses.
Measured responses_read(const MeasureOptions& options, data::FileKind kind) {
  const auto& path = options.files.front();
  if (options.files.size() > 1)
    base::refuse(options.files[1],
                 "only records are averaged: give one file of frequency responses");
  const auto needs_record = [&](const char* option) {
    base::refuse(option, fmt::format("needs a record; {} holds responses", path));
  };
  if (options.output_only) needs_record("--output-only");
  if (options.estimate.whole_record.value_or(false)) needs_record("--whole-record");
  auto measured = kind == data::FileKind::json
                      ? responses_from(parsed_json(path, {"\"frf\""}), path)
                      : responses_of_file(path);
  if (options.estimate.for_modes) check_motions(path, measured);
  measured.machine = measured_machine(options, measured.experiment());
  take_out_window(options, measured);
  return measured;
}

}  // namespace

Measured frf(const MeasureOptions& options, const Progress& progress) {
  if (options.estimate.whole_record.value_or(false) && !options.estimate.for_modes)
    base::refuse("--whole-record",
                 "is for modes, with `hydrapod identify`; responses are averages of blocks");
  if (options.records.empty())
    if (const auto kind = kind_of_measurement(options.files.at(0)); kind != data::FileKind::record)
      return responses_read(options, kind);
  auto measured = opened(options);
  const auto estimate = estimate_options(options, measured);
  measured.measurement =
      options.output_only
          ? identification::measure_outputs(*measured.records, estimate, progress)
          : identification::measure_responses(*measured.records, estimate, progress);
  note_reading(options, measured);
  take_out_window(options, measured);
  return measured;
}

std::optional<observation::Observed> observed_in(const Measured& measured) {
  if (measured.experiment() == nullptr || !measured.experiment()->excitation) return {};
  return observation::from_drives(measured.responses().inputs) ? observation::Observed::plant
                                                               : observation::Observed::system;
}

identification::Identification modes_of(Measured& measured, const MeasureOptions& measure,
                                        const identification::IdentifyOptions& options,
                                        const std::function<void(double)>& progress) {
  auto& m = measured.measurement;
  bool stopped = false;
  std::string reason;
  try {
    auto found = identification::identify_modes(m, options, [&](double share) {
      stopped = true;  // unless it returns
      if (progress) progress(share);
      stopped = false;
    });
    if (m.record != nullptr) m.responses = found.responses;
    return found;
  } catch (const base::ComputationError& error) {
    if (stopped || m.record == nullptr || measure.estimate.whole_record) throw;
    reason = error.what();
  }
  auto averaged = measure;
  averaged.estimate.whole_record = false;
  measured = frf(averaged, [&](double share) {
    if (progress) progress(0.5 * share);
    return false;
  });
  auto found = identification::identify_modes(measured.measurement, options, [&](double share) {
    if (progress) progress(0.5 + 0.5 * share);
  });
  add_warning(measure.files.front(),
              "the whole record at once gives no modes (" + reason + "); averages of blocks do",
              measured.warnings);
  return found;
}

Identified identify(const IdentifyOptions& options, const Progress& progress) {
  Identified found;
  auto measure = options.measure;
  measure.estimate.for_modes = true;
  if (options.bootstrap > 0 && !measure.estimate.whole_record)
    measure.estimate.whole_record = false;  // it resamples blocks
  found.measured = frf(measure, numerics::part_of(progress, 0.0, 0.4));
  const auto& file = options.measure.files.front();
  check_window(options, found.measured);
  auto& measurement = found.measured.measurement;
  if (!(measurement.responses.shift > 0.0)) {  // they are large, and nothing needs them any more
    auto& spectra = measurement.spectra;
    spectra.re = spectra.im = spectra.noise_re = spectra.noise_im = {};
  }
  found.modes = modes_of(found.measured, measure, options.modes, [&](double share) {
    // who has stopped the reading wants the modes of what was read
    if (progress && progress(0.4 + 0.6 * share) && !measurement.interrupted)
      throw base::ComputationError("interrupted");
  });
  found.warnings = found.measured.warnings;
  add_new_warnings(file, found.modes.responses.warnings, found.warnings);
  test_steadiness(options, progress, found);
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

}  // namespace hydrapod::tasks
