/// What is compared, and modes of each of it. How modes are paired and differences are tested is in
/// mode_differences.cpp.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "compared_responses.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/tasks/linear.hpp"
#include "measured_files.hpp"

namespace hydrapod::tasks {

namespace {

using ThingKind = report::ComparedThing::Kind;
using observation::Observed;

/// One thing as it was asked for.
struct Wanted {
  std::string text{};  ///< as it was given
  std::string path{};
  std::string pose{};  ///< of a machine file
  std::vector<std::string> overrides{};
  bool is_machine{};
  bool says_pose{};
  bool follows{};  ///< no pose was asked for: it is at the one that the measurements state
};

Wanted wanted_from(const std::string& text) {
  Wanted one{.text = text, .path = text};
  const auto at = text.rfind('@');
  if (at != std::string::npos && !std::filesystem::exists(text)) {
    one.path = text.substr(0, at);
    one.pose = text.substr(at + 1);
    one.says_pose = true;
    if (one.path.empty() || one.pose.empty())
      base::refuse(text, "expected FILE, or FILE@POSE with a pose of the machine file");
  }
  one.is_machine = one.path == "-" || data::file_kind(one.path) == data::FileKind::toml;
  if (one.says_pose && !one.is_machine)
    base::refuse(text, fmt::format("{} was measured at the pose that it states; only machine files "
                                   "take a pose",
                                   one.path));
  return one;
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  return a == b || std::filesystem::equivalent(a, b, ignored);
}

/// A machine file alone: its poses, or without and with the overrides.
std::vector<Wanted> versions_of(const Wanted& file, const CompareOptions& options) {
  std::vector<Wanted> all;
  if (options.poses.size() > 1) {
    if (file.says_pose) base::refuse(file.text, "says its pose; leave the @POSE or --pose out");
    for (const auto& pose : options.poses) {
      all.push_back(file);
      all.back().pose = pose;
      all.back().text = fmt::format("{} at {}", file.path, pose);
      all.back().overrides = options.overrides;
    }
    return all;
  }
  if (options.overrides.empty())
    base::refuse(file.text,
                 "is one thing; add another file, or for this machine several --pose, or --set "
                 "PATH=VALUE, which is compared with the file as it is");
  for (const bool changed : {false, true}) {
    all.push_back(file);
    if (!changed) continue;
    all.back().overrides = options.overrides;
    all.back().text = fmt::format("{} with {}", file.text, fmt::join(options.overrides, ", "));
  }
  return all;
}

void refuse_repeats(const std::vector<Wanted>& all) {
  for (std::size_t k = 0; k < all.size(); ++k)
    for (std::size_t i = 0; i < k; ++i)
      if (same_file(all[i].path, all[k].path) && all[i].pose == all[k].pose &&
          all[i].overrides == all[k].overrides)
        base::refuse(all[k].text,
                     all[i].text == all[k].text
                         ? std::string("is given twice; expected two different things")
                         : fmt::format("is the same file as {}; expected two different things",
                                       all[i].text));
}

std::vector<Wanted> wanted_things(const CompareOptions& options) {
  std::vector<Wanted> all;
  for (const auto& text : options.files) all.push_back(wanted_from(text));
  const auto machines = std::ranges::count(all, true, &Wanted::is_machine);
  const auto refuse_without = [&](const char* option, bool given) {
    if (given && machines == 0)
      base::refuse(option, "is of machine files, and none is among the things to compare");
  };
  refuse_without("--set", !options.overrides.empty());
  refuse_without("--pose", !options.poses.empty());
  if (all.size() == 1 && machines == 1) {
    all = versions_of(all.front(), options);
  } else if (all.size() < 2) {
    base::refuse(all.empty() ? "compare" : all.front().text,
                 "is one thing; expected at least two: machine files, identified modes, responses "
                 "or records");
  } else if (options.poses.size() > 1) {
    base::refuse("--pose",
                 "is given several times; with several things it is given once, or each "
                 "machine file says its own: machine.toml@low");
  } else {
    for (auto& one : all)
      if (one.is_machine) one.overrides = options.overrides;
  }
  for (auto& one : all)
    if (one.is_machine && one.pose.empty()) {
      one.follows = options.poses.empty();
      one.pose = one.follows ? "neutral" : options.poses.front();
    }
  refuse_repeats(all);
  return all;
}

/// Outputs x … rz of the mass centre, as calculated modes have them.
std::vector<data::Channel> platform_outputs() {
  std::vector<data::Channel> outputs;
  for (int d = 0; d < 6; ++d)
    outputs.push_back({.name = std::string(spatial::direction_name(d)),
                       .unit = d < 3 ? "m" : "rad",
                       .direction = static_cast<data::Direction>(d + 1)});
  return outputs;
}

void add_mode(std::complex<double> pole, double omega, double damping, const std::string& label,
              const observation::Vector6c& ground, const observation::Vector6c& base, Side& side) {
  side.thing.modes.push_back({.omega = omega, .damping_ratio = damping, .label = label});
  side.modal.modes.push_back({.pole = pole, .shape = ground});
  side.base.push_back(base);
}

/// Those of `hydrapod modes` that move the platform.
void add_mechanics(const modal::ModeTable& table, Side& side) {
  for (const auto& entry : table.real.modes) {
    const auto& mode = entry.mode;
    if (!entry.moves_platform || !(mode.omega > 0.0)) continue;
    observation::Vector6c shape = mode.real.head<6>().cast<std::complex<double>>();
    if (mode.imaginary.size() > 0)
      shape += std::complex<double>(0.0, 1.0) * mode.imaginary.head<6>();
    add_mode(mode.pole, mode.omega, mode.damping_ratio, entry.label, shape, shape, side);
  }
}

/// Those of plant or controlled machine that identification would count as modes.
void add_observed(const observation::Observation& seen, Side& side) {
  const double highest = identification::IdentifyOptions{}.highest_damping;
  for (const auto& mode : seen.modes) {
    const auto energy = modal::energy_shares(seen.mechanics, mode.shape.real(), mode.shape.imag());
    if (mode.damping_ratio() > highest || energy.platform.sum() < modal::local_mode_energy)
      continue;
    add_mode(mode.pole, mode.omega(), mode.damping_ratio(),
             modal::mode_label(energy, mode.pole.real() < 0.0), mode.motion(),
             mode.motion(observation::MotionAgainst::base), side);
  }
}

/// A pose that a measurement states, and its file.
struct StatedPose {
  std::string path{};
  model::NamedPose pose{};
};

/// Of all measured things that state one.
std::vector<StatedPose> stated_poses(const std::vector<Wanted>& wanted,
                                     const model::Machine& machine) {
  std::vector<StatedPose> found;
  for (const auto& one : wanted)
    if (!one.is_machine && data::file_kind(one.path) != data::FileKind::modal_results)
      if (auto pose = stated_pose(one.path, machine)) found.push_back({one.path, *pose});
  return found;
}

bool at_one_place(const model::NamedPose& a, const model::NamedPose& b) {
  constexpr double same = 1e-6;  // [m] and [rad]
  return (a.X_BP.p_BP - b.X_BP.p_BP).norm() < same && (a.X_BP.R_BP - b.X_BP.R_BP).norm() < same;
}

bool reaches(const Machine& machine, model::NamedPose pose) {
  auto file = machine.file;
  try {
    add_pose(file, pose, pose.name);
  } catch (const base::InputError&) {
    return false;  // the record is of another machine
  }
  return true;
}

/// The machine goes to the pose that all measurements state, where none was asked for; what states
/// another than the machine's is a warning. Which file the pose is from; empty: of none.
std::string take_measured_pose(const Wanted& wanted, const std::vector<Wanted>& all,
                               Machine& machine, Diagnostics& warnings) {
  const auto stated = stated_poses(all, machine.file.machine);
  if (stated.empty()) return {};
  const auto& first = stated.front();
  const bool one = std::ranges::all_of(
      stated, [&](const auto& other) { return at_one_place(other.pose, first.pose); });
  if (one && wanted.follows && reaches(machine, first.pose)) {
    machine.pose = first.pose;
    return first.path;
  }
  for (const auto& other : stated) {
    if (at_one_place(other.pose, machine.pose)) continue;
    const bool known = find_pose(machine.file.machine, other.pose.name) != nullptr;
    add_warning(
        other.path,
        fmt::format("states {}, and {} is compared at pose {}",
                    known ? "pose " + other.pose.name : "a pose that is none of " + wanted.path,
                    wanted.path, machine.pose.name),
        warnings);
  }
  return {};
}

Side machine_side(const Wanted& wanted, const std::vector<Wanted>& all,
                  const std::vector<Side>& measured, const CompareOptions& options,
                  Observed observed, Diagnostics& warnings) {
  auto machine = read_machine({.file = wanted.path,
                               .overrides = wanted.overrides,
                               .pose = wanted.pose,
                               .model = options.model});
  append(machine.file.warnings, warnings);
  const std::string source = take_measured_pose(wanted, all, machine, warnings);
  Side side{.calculated = true};
  const auto& of = machine.file.machine;
  side.frame = {of, machine.pose.X_BP, kinematics::mass_center(of, machine.pose.X_BP)};
  side.thing = {.kind = ThingKind::machine,
                .name = wanted.text,
                .description = fmt::format(
                    "{}, pose {}{}, {} model of the {}; machine: {}", of.name, machine.pose.name,
                    source.empty() ? "" : fmt::format(" as {} states", source),
                    dynamics::name(machine.kind), observation::description(observed),
                    observed == Observed::mechanics ? report::mechanics_state_text(machine.file)
                                                    : report::state_text(machine.file))};
  side.modal.outputs = platform_outputs();
  const bool mechanics = observed == Observed::mechanics;
  if (mechanics) add_mechanics(tasks::modes(machine), side);
  const bool with_responses =
      std::ranges::any_of(measured, [](const auto& other) { return other.responses.has_value(); });
  if (!mechanics || with_responses) {
    const auto seen = observation::observe(of, machine.pose.X_BP, machine.kind, observed);
    if (!mechanics) add_observed(seen, side);
    for (const auto& other : measured) add_shown_responses(seen, other, side);
  }
  if (mechanics) add_calculated_responses(machine, options.points, side);
  return side;
}

void add_measured(const data::ModalResults& modes, const std::vector<std::string>& labels,
                  Side& side) {
  side.modal = modes;
  for (auto& output : side.modal.outputs) {  // tables do not say units
    const int code = std::abs(static_cast<int>(output.direction));
    if ((output.unit.empty() || output.unit == "1") && code >= 1 && code <= 6)
      output.unit = code <= 3 ? "m" : "rad";
  }
  for (std::size_t k = 0; k < modes.modes.size(); ++k) {
    const auto& mode = modes.modes[k];
    report::ComparedThing::Mode one{.omega = mode.omega(),
                                    .damping_ratio = mode.damping_ratio(),
                                    .label = k < labels.size() ? labels[k] : ""};
    if (mode.omega_deviation > 0.0)
      one.omega_deviation = frequency_deviation(mode, modes.line_spacing);
    if (mode.damping_deviation > 0.0) one.damping_deviation = mode.damping_deviation;
    side.thing.modes.push_back(std::move(one));
  }
}

/// The machine that a record is of, for the metric of its outputs.
void add_frame(const Measured& measured, Side& side) {
  if (!measured.machine) return;
  const auto& machine = measured.machine->file.machine;
  const auto& X_BP = measured.machine->pose.X_BP;
  side.frame = {machine, X_BP, kinematics::mass_center(machine, X_BP)};
}

Side side_of_responses(const std::string& path, const Progress& progress, Diagnostics& warnings) {
  Side side;
  constexpr double identified = 0.8;  // of the time
  const auto found = identify({.measure = {.files = {path}}, .compare = false},
                              numerics::part_of(progress, 0.0, identified));
  append(found.warnings, warnings);
  if (found.modes.modes.empty())
    base::refuse(path, "no mode was found in it; `hydrapod identify` shows why");
  const auto& measured = found.measured;
  add_frame(measured, side);
  side.observed = observed_in(measured);
  side.thing = {
      .kind = ThingKind::record,
      .name = path,
      .description = fmt::format(
          "{}{}", report::measurement_text(measured.responses()),
          measured.machine ? fmt::format("; {}, pose {}", measured.machine->file.machine.name,
                                         measured.machine->pose.name)
                           : "")};
  add_measured(identification::modal_results(found.modes), report::motion_words(found.modes), side);
  try {
    MeasuredResponses all{
        .responses = shared_responses(measured, numerics::part_of(progress, identified, 1.0))};
    if (measured.machine) all.p_PQ = measured.machine->file.machine.platform.mass_center;
    add_measured_responses(std::move(all), side);
  } catch (const std::invalid_argument&) {  // beside the axis, and no model brings them there
  }
  return side;
}

Side side_of_json(const std::string& path, const Progress& progress, Diagnostics& warnings) {
  const auto json = parsed_json(path, {"\"identified_modes\"", "\"modes\"", "\"frf\""});
  if (!json.is_object())
    base::refuse(path, "expected an object of `hydrapod modes`, `identify` or `frf`");
  Side side{.thing = {.kind = ThingKind::modes, .name = path}};
  if (json.contains("rigid_modes")) {
    side.calculated = true;
    side.modal.outputs = platform_outputs();
    side.thing.description =
        fmt::format("calculated modes at pose {}", report::pose_from_json(json, path).name);
    add_mechanics(report::modes_from_json(json, path), side);
    return side;
  }
  if (!json.contains("modes")) return side_of_responses(path, progress, warnings);
  Measured measured;
  measured.header = report::record_origin_from_json(json, path);
  const auto modes = report::identification_from_json(json, path);
  measured.measurement.responses.inputs = modes.responses.inputs;
  side.observed = observed_in(measured);
  side.thing.description = "identified modes";
  add_measured(identification::modal_results(modes), report::motion_words(modes), side);
  return side;
}

Side measured_side(const std::string& path, const Progress& progress, Diagnostics& warnings) {
  const auto kind = data::file_kind(path);
  if (kind == data::FileKind::json) return side_of_json(path, progress, warnings);
  Side side{.thing = {.kind = ThingKind::modes, .name = path}};
  if (kind == data::FileKind::mode_table) {
    if (!report::is_identified_modes_csv(path))
      base::refuse(path,
                   "is a list of targets, not a table of `hydrapod identify`; `calibrate "
                   "--targets` and `diagnose --measured` compare it with a machine");
    const auto list = report::identified_modes_from_csv(path);
    side.observed = list.observed;
    side.thing.description = "identified modes";
    add_measured(list.modes, {}, side);
    return side;
  }
  if (kind == data::FileKind::modal_results) {
    const auto read = data::read_modal_results(path);
    append(read.notes, warnings);
    side.thing.description = "modes of a Universal File, without uncertainties";
    add_measured(read.results, {}, side);
    return side;
  }
  return side_of_responses(path, progress, warnings);
}

/// The one system that all measured things are of; throws where there are several.
std::optional<Observed> common_system(const std::vector<Side>& sides) {
  const Side* first = nullptr;
  for (const auto& side : sides) {
    if (!side.observed) continue;
    if (first != nullptr && *first->observed != *side.observed)
      base::refuse(side.thing.name,
                   fmt::format("shows the {}, and {} the {}: these are different systems and have "
                               "other modes",
                               observation::description(*side.observed), first->thing.name,
                               observation::description(*first->observed)));
    first = &side;
  }
  return first == nullptr ? std::nullopt : first->observed;
}

}  // namespace

Compared compare(const CompareOptions& options, const Progress& progress) {
  const auto wanted = wanted_things(options);
  Compared compared;
  std::vector<Side> sides(wanted.size());
  const double share = 1.0 / static_cast<double>(wanted.size());
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const double done = share * static_cast<double>(k);
    if (!wanted[k].is_machine)
      sides[k] = measured_side(wanted[k].path, numerics::part_of(progress, done, done + share),
                               compared.warnings);
  }
  const auto measured = common_system(sides);
  const auto observed = options.observed.value_or(measured.value_or(Observed::mechanics));
  for (std::size_t k = 0; k < wanted.size(); ++k)
    if (wanted[k].is_machine)
      sides[k] = machine_side(wanted[k], wanted, sides, options, observed, compared.warnings);
  for (const auto& side : sides)
    if (side.thing.modes.empty())
      base::refuse(side.thing.name, "has no mode that moves the platform");
  auto& result = compared.result;
  result.level = options.level;
  for (std::size_t k = 1; k < sides.size(); ++k) {
    result.comparisons.push_back(compare_sides(sides.front(), sides[k], options.level));
    result.comparisons.back().thing = static_cast<int>(k);
  }
  for (auto& side : sides) result.things.push_back(std::move(side.thing));
  keep_shared_responses(result.things);
  return compared;
}

}  // namespace hydrapod::tasks
