#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/tasks/measurement.hpp"
#include "measured_files.hpp"

namespace hydrapod::tasks {

namespace {

/// Throws base::InputError where modes that `hydrapod modes` calculated are not those of a machine
/// that could be measured so: they are of mechanics, and of one that stands.
void require_measurable(const std::vector<modal::TabledMode>& modes, const std::string& path,
                        std::optional<observation::Observed> observed) {
  if (observed && *observed != observation::Observed::mechanics)
    base::refuse(fmt::format("--against {}", observation::name(*observed)),
                 fmt::format("{} holds modes that `hydrapod modes` calculated for the mechanics, "
                             "and they are compared with mechanics alone; expected --against "
                             "mechanics or auto",
                             path));
  if (std::ranges::any_of(modes, [](const auto& entry) { return !entry.mode.stable; }))
    base::refuse(path,
                 "holds the modes of a machine that does not stand (\"stable\": false), and such a "
                 "machine cannot be measured; `hydrapod check` says why it does not");
}

/// Modes that were calculated: of mechanics, those that the platform feels.
observation::Targets calculated_targets(const report::Json& json, const std::string& path,
                                        const model::Machine& machine,
                                        std::optional<observation::Observed> observed) {
  constexpr double shape_deviation = 0.05;  // as in lists of modes that do not say it
  observation::Targets targets{.title = path, .deviations_given = false};
  const auto pose = report::pose_from_json(json, path);
  if (find_pose(machine, pose.name) == nullptr)
    base::refuse(
        path,
        fmt::format("holds modes at pose \"{}\", which the machine file does not have", pose.name));
  const auto modes = report::modes_from_json(json, path).real.modes;
  require_measurable(modes, path, observed);
  for (const auto& entry : modes) {
    const auto& mode = entry.mode;
    if (!entry.moves_platform || !(mode.omega > 0.0)) continue;
    observation::ModeTarget target{.name = fmt::format("{:.3f} Hz", mode.omega / base::two_pi),
                                   .pose = pose.name,
                                   .omega = mode.omega,
                                   .damped = true,
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

/// Averages of blocks for a record that is short enough to be identified in one piece: noisy, but
/// with the deviations that a comparison needs. Nothing where it is too short for any.
std::optional<data::FrequencyResponses> averages_of(MeasureOptions options, const std::string& path,
                                                    const Progress& progress,
                                                    Diagnostics& warnings) {
  options.estimate.whole_record = false;
  bool stopped = false;
  try {
    return frf(options, [&](double share) { return stopped = progress && progress(share); })
        .responses();
  } catch (const base::ComputationError& error) {
    if (stopped) throw;
    add_warning(path,
                fmt::format("its modes alone are compared, not its responses: {}", error.what()),
                warnings);
    return {};
  }
}

/// Lines that hold no measurement are no targets either.
void leave_out_unmeasured(const std::vector<data::ResponseWarning>& said,
                          data::FrequencyResponses& responses) {
  using Kind = data::ResponseWarning::Kind;
  if (std::ranges::any_of(said, [](const auto& warning) {
        return warning.kind == Kind::lines_zero || warning.kind == Kind::two_sided;
      }))
    responses = identification::usable_responses(responses);
}

/// Modes of conjugates are none of the machine.
void refuse_conjugates(const std::string& path,
                       const std::vector<identification::ModeWarning>& said) {
  const auto at = std::ranges::find(said, identification::ModeWarning::Kind::conjugated,
                                    &identification::ModeWarning::kind);
  if (at != said.end()) base::refuse(path, report::warning_text(*at));
}

/// Targets of responses, by way of their modes. `options`: how they were measured, where that was
/// done here.
observation::Targets identified_targets(Measured measured, const MeasureOptions& options,
                                        const std::string& path, const Machine& machine,
                                        observation::MeasuredAt at, const Progress& progress,
                                        Diagnostics& warnings) {
  look_into(measured, at);
  const auto found = modes_of(measured, options, {}, [&](double share) {
    if (progress && progress(share)) throw base::ComputationError("interrupted");
  });
  refuse_conjugates(path, found.warnings);
  append(measured.warnings, warnings);
  add_new_warnings(path, found.responses.warnings, warnings);
  add_warnings(path, found.warnings, warnings);
  if (found.modes.empty())
    base::refuse(
        path,
        "no mode was found in it; use a longer record or a higher excitation (`hydrapod identify` "
        "shows details)");
  auto targets =
      observation::measured_modes(identification::modal_results(found), machine.file.machine, at);
  auto responses = measured.measurement.record == nullptr
                       ? std::optional(std::move(measured.measurement.responses))
                       : averages_of(options, path, progress, warnings);
  if (!responses) return targets;
  leave_out_unmeasured(found.responses.warnings, *responses);
  if (auto all = observation::measured_responses(*responses, machine.file.machine, at))
    targets.responses.push_back(std::move(*all));
  return targets;
}

/// "run.h5@low".
struct MeasuredFile {
  std::string option{};  ///< as messages call it
  std::string path{};
  std::string pose{};
  bool says_pose{};
  bool as_stated{};  ///< the pose is the one that the record states
};

/// What a record says of its experiment, or JSON or a table of modes that was made of one.
std::optional<data::Experiment> experiment_of(const std::string& path) {
  const auto kind = data::file_kind(path);
  if (kind == data::FileKind::record)
    return data::RecordSet({path}, data::ReadOptions{}).header().experiment;
  if (kind == data::FileKind::mode_table) return report::identified_modes_from_csv(path).experiment;
  if (kind != data::FileKind::json) return {};
  const auto json = parsed_json(path, {"\"identified_modes\"", "\"modes\"", "\"frf\""});
  const auto header = json.is_object() ? report::record_origin_from_json(json, path) : std::nullopt;
  return header ? std::optional(header->experiment) : std::nullopt;
}

bool same_pose(const spatial::Pose& a, const spatial::Pose& b) {
  constexpr double same = 1e-6;  // [m] and [rad]: less than any machine is placed to
  return (a.p_BP - b.p_BP).norm() < same && (a.R_BP - b.R_BP).norm() < same;
}

/// What the record states where another pose was asked for.
void warn_of_other_pose(const MeasuredFile& file, const Machine& machine, Diagnostics& warnings) {
  const auto stated = stated_pose(file.path, machine.file.machine);
  const auto* used = find_pose(machine.file.machine, file.pose);
  if (!stated || used == nullptr || same_pose(stated->X_BP, used->X_BP)) return;
  add_warning(file.path,
              fmt::format("states pose {}; it is taken at pose {} (--pose, or FILE@POSE)",
                          stated->name, file.pose),
              warnings);
}

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
      return calculated_targets(json, path, of, observed);
    if (!json.contains("modes"))
      return identified_targets(responses_from(json, path), {}, path, machine, at, progress,
                                warnings);
    Measured measured;
    measured.header = report::record_origin_from_json(json, path);
    auto modes = report::identification_from_json(json, path);
    measured.measurement.responses.inputs = modes.responses.inputs;
    refuse_conjugates(path, modes.warnings);
    add_warnings(path, modes.warnings, warnings);
    look_into(measured, at);
    return observation::measured_modes(identification::modal_results(modes), of, at);
  }
  refuse_modal_results(path);
  MeasureOptions options{.files = {path}, .known = machine};
  options.estimate.for_modes = true;
  options.known->pose = *find_pose(machine.file.machine, file.pose);
  options.p_PQ = at.point;
  return identified_targets(frf(options, progress), options, path, machine, at, progress, warnings);
}

}  // namespace

bool is_mode_list(const std::string& path) {
  const auto kind = data::file_kind(path);
  return kind == data::FileKind::toml ||
         (kind == data::FileKind::mode_table && !report::is_identified_modes_csv(path));
}

std::optional<model::NamedPose> stated_pose(const std::string& path,
                                            const model::Machine& machine) {
  if (is_mode_list(path)) return {};
  const auto experiment = experiment_of(path);
  if (!experiment || experiment->pose_name.empty()) return {};
  const auto* known = find_pose(machine, experiment->pose_name);
  if (!experiment->pose) return known == nullptr ? std::nullopt : std::optional(*known);
  const auto& p = *experiment->pose;
  const spatial::Pose X_BP{.R_BP = spatial::rotation_from_rpy({p[3], p[4], p[5]}),
                           .p_BP = {p[0], p[1], p[2]}};
  if (known != nullptr && same_pose(known->X_BP, X_BP)) return *known;
  for (const auto& pose : machine.poses)
    if (same_pose(pose.X_BP, X_BP)) return pose;
  std::string name = "as_recorded";
  while (find_pose(machine, name) != nullptr) name += '_';
  return model::NamedPose{name, X_BP};
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
    if (!one.says_pose && !options.pose_given)
      if (const auto stated = stated_pose(one.path, machine.file.machine)) {
        one.pose = stated->name;
        one.as_stated = true;
      }
    files.push_back(std::move(one));
  }
  MeasuredTargets result;
  auto& all = result.targets;
  for (const auto& file : files) {
    if (!file.as_stated && !is_mode_list(file.path))
      warn_of_other_pose(file, machine, result.warnings);
    auto one = read_one(file, machine, options.observed, progress, result.warnings);
    if (!is_mode_list(file.path))
      result.origins.push_back(fmt::format("{}: pose {}{}; {}", file.path, file.pose,
                                           file.as_stated ? ", as the record states" : "",
                                           observation::description(one.observed)));
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
