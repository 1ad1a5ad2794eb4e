#include "hydrapod/tasks/measurement.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/spatial/pose.hpp"
#include "measured_files.hpp"

namespace hydrapod::tasks {

namespace {

/// Positions of the profiled paths among the free parameters. Throws base::InputError.
std::vector<int> profiled(const std::vector<std::string>& paths, const calibration::Plan& plan) {
  std::vector<int> positions;
  for (const auto& path : paths) {
    const auto found = std::ranges::find_if(
        plan.free, [&](const auto& free) { return std::ranges::count(free.paths, path) > 0; });
    if (found == plan.free.end())
      base::refuse("--profile " + path, "is not one of the free parameters");
    positions.push_back(static_cast<int>(found - plan.free.begin()));
  }
  return positions;
}

void add_prior(const KnownParameter& known, calibration::Plan& plan) {
  const auto free = std::ranges::find_if(
      plan.free, [&](const auto& one) { return one.paths.front() == known.path; });
  if (free == plan.free.end())
    base::refuse("--prior " + known.path,
                 fmt::format("`{0}` is not free; add --free {0}", known.path));
  free->prior = known.prior;
}

/// Poses that records state join those of the machine's file; the machine is at the first of them
/// where no pose was asked for.
void take_stated_poses(const MeasuredOptions& options, Machine& machine) {
  if (options.pose_given) return;
  bool first = true;
  for (const auto& path : options.files) {
    if (!std::filesystem::exists(path)) continue;  // says its pose, or is refused later
    auto stated = stated_pose(path, machine.file.machine);
    if (!stated) continue;
    add_pose(machine.file, *stated, stated->name);
    if (std::exchange(first, false)) machine.pose = *stated;
  }
}

/// The targets, and what their file says of the fit. Poses that the file states join those of the
/// machine.
Calibrated prepared(Machine& machine, const CalibrateOptions& options, const Progress& progress) {
  Calibrated result;
  if (!std::filesystem::exists(options.targets) || is_mode_list(options.targets)) {
    std::vector<std::string> poses;
    for (const auto& pose : machine.file.machine.poses) poses.push_back(pose.name);
    auto file = calibration::read_targets(options.targets, poses);
    result.targets = std::move(file.targets);
    result.plan = std::move(file.plan);
  } else {
    const MeasuredOptions measured_options{.files = {options.targets}, .pose_given = false};
    take_stated_poses(measured_options, machine);
    auto measured = read_measured(machine, measured_options, progress);
    result.targets = std::move(measured.targets);
    result.warnings = std::move(measured.warnings);
  }
  auto& plan = result.plan;
  std::ranges::copy(options.plan.free, std::back_inserter(plan.free));
  std::ranges::copy(options.plan.alternatives, std::back_inserter(plan.alternatives));
  for (const auto& known : options.priors) add_prior(known, plan);
  plan.options.threads = options.plan.options.threads;
  plan.options.starts = options.starts.value_or(plan.options.starts);
  plan.options.seed = options.seed.value_or(plan.options.seed);
  plan.options.loss = options.loss.value_or(plan.options.loss);
  return result;
}

}  // namespace

Calibrated calibrate(const Machine& given, const CalibrateOptions& options,
                     const Progress& progress) {
  auto machine = given;
  auto result = prepared(machine, options, progress);
  const auto positions = profiled(options.profiles, result.plan);
  bool stopped = false;
  const Progress watched = [&](double share) {
    stopped = progress && progress(share);
    return stopped;
  };
  result.result =
      calibration::calibrate(machine.file, result.targets, result.plan, machine.kind, watched);
  for (const int position : positions) {
    auto profile = calibration::profile(machine.file, result.targets, result.plan, machine.kind,
                                        result.result.best(), position, watched);
    if (stopped) break;  // half a profile has no interval
    result.profiles.push_back(std::move(profile));
  }
  result.interrupted = stopped;
  return result;
}

namespace {

/// Friction in the file that the linear model, with which records are compared, leaves out; empty:
/// none.
std::string friction_in(const model::Machine& machine) {
  const auto any = [&](const auto& has) { return std::ranges::any_of(machine.legs, has); };
  if (any([](const auto& leg) { return leg.screw && leg.screw->friction_torque > 0.0; }))
    return "legs.screw.friction_torque";
  if (any([](const auto& leg) { return leg.hydraulics.friction.coulomb.value_or(0.0) > 0.0; }))
    return "legs.friction.coulomb";
  return {};
}

void warn_of_friction(const Machine& machine, const std::string& path,
                      const diagnosis::Diagnosis& d, Diagnostics& warnings) {
  using diagnosis::Finding;
  if (d.finding != Finding::unexplained && d.finding != Finding::do_not_belong) return;
  if (d.targets.observed == observation::Observed::mechanics && !d.substitution) return;
  using Slip = diagnosis::Objection::Slip;
  if (std::ranges::any_of(d.objections, [](const auto& one) { return one.slip != Slip::none; }))
    return;  // a unit
  const auto key = friction_in(machine.file.machine);
  if (key.empty()) return;
  add_warning(path,
              fmt::format("{} acts in the record, and the linear model that it is compared with "
                          "leaves it out; frequencies and damping then change with the "
                          "amplitude: compare records of smaller and of larger excitation",
                          key),
              warnings);
}

}  // namespace

Diagnosed diagnose(const Machine& given, const DiagnoseOptions& options, const Progress& progress) {
  Diagnosed result{.machine = given};
  auto& [file, path, pose, kind] = result.machine;
  take_stated_poses(options.measured, result.machine);
  add_pose(file, pose, "as_measured");
  auto& found = result.file;
  found = {.machine = file.machine,
           .nominal_sleeves = diagnosis::sleeves_of(file.machine),
           .kind = kind,
           .pose = pose.name,
           .goal = options.goal};
  const auto poses = options.poses.empty() ? file.machine.poses : options.poses;
  if (!options.measured.files.empty()) {
    auto measured =
        read_measured(result.machine, options.measured, numerics::part_of(progress, 0.0, 0.2));
    result.warnings = std::move(measured.warnings);
    result.origins = std::move(measured.origins);
    result.measured = std::move(measured.targets);
    found.diagnosis = diagnosis::diagnose(file, result.measured, kind, poses, options.rules,
                                          numerics::part_of(progress, 0.2, 0.9));
    const auto& d = *found.diagnosis;
    warn_of_friction(result.machine, options.measured.files.front(), d, result.warnings);
    if (d.equivalent.empty() || d.interrupted) return result;
    const auto& best = d.hypotheses[d.equivalent.front()];
    // legs that do not bend have no sleeves to speak of
    found.fitted = !best.causes.empty();
    if (found.fitted) {
      found.machine = diagnosis::machine_of(file, best);
      found.kind = best.kind;
    }
  }
  if (found.kind == dynamics::ModelKind::rigid) return result;  // nothing to give way
  const auto X_BP = find_pose(found.machine, pose.name)->X_BP;
  found.drops = diagnosis::attribute_drops(found.machine, X_BP, found.kind);
  found.remedy = diagnosis::find_remedy(found.machine, poses, found.kind, found.goal,
                                        numerics::part_of(progress, 0.9, 1.0));
  return result;
}

int identified_mode(const diagnosis::Diagnosis& found, const std::string& pose) {
  if (found.equivalent.empty()) return 0;
  const auto& fit = found.hypotheses[found.equivalent.front()].fit;
  int number = 0;
  double most = 0.0;
  for (std::size_t i = 0; i < found.modes.size(); ++i) {
    const auto& mode = found.modes[i];
    const double share = 1.0 - mode.oil;
    if (mode.pose != pose || share <= most) continue;
    most = share;
    number = fit.targets[i].mode + 1;
  }
  return number;
}

namespace {

/// What stands before "=", ">=" or "<="; none: the lowest mode, or the drop of any.
std::optional<int> direction_of_goal(std::string_view word, bool compares, bool drop,
                                     const std::string& argument) {
  if (word == (drop ? "lowest" : "drop"))
    base::refuse(argument,
                 "a drop is wanted in % (\"drop <= 2 %\"), a lowest frequency in Hz (\"lowest >= 5 "
                 "Hz\")");
  if (compares && (word == "lowest" || word == "drop")) return {};
  if (const auto direction = spatial::direction_from_name(word)) return direction;
  const std::vector<std::string_view> known(spatial::direction_names.begin(),
                                            spatial::direction_names.end());
  const auto near = base::nearest(word, known);
  base::refuse(
      fmt::format("{} {}", argument, base::printable(word)),
      fmt::format("unknown value; {}accepted are {}",
                  near ? fmt::format("did you mean '{}'? ", *near) : "", fmt::join(known, ", ")));
}

}  // namespace

diagnosis::RemedyGoal read_goal(std::string_view text, const std::string& argument) {
  diagnosis::RemedyGoal goal;
  std::string_view amount = base::trimmed(text);
  const bool drop = amount.ends_with('%');
  if (const auto equals = amount.find('='); equals != std::string_view::npos) {
    const char before = equals > 0 ? amount[equals - 1] : ' ';
    const bool compares = before == '<' || before == '>';
    if (compares && (before == '<') != drop)
      base::refuse(argument,
                   "a frequency is at least what is wanted (\"x >= 5 Hz\") and a drop at most "
                   "(\"x <= 2 %\")");
    goal.direction = direction_of_goal(base::trimmed(amount.substr(0, equals - (compares ? 1 : 0))),
                                       compares, drop, argument);
    amount = base::trimmed(amount.substr(equals + 1));
  }
  if (amount.starts_with("drop")) amount = base::trimmed(amount.substr(4));
  const auto read =
      drop ? base::read_quantity(amount, "1") : base::read_plain_or_quantity(amount, "Hz");
  const auto radians = base::read_quantity(amount, "rad/s");
  if (!read.ok() && (drop || !radians.ok())) base::refuse(argument, read.problem);
  if (drop && !(read.value > 0.0 && read.value < 1.0))
    base::refuse(argument, "expected a drop above 0 % and below 100 %, such as \"2 %\"");
  if (drop) {
    goal.drop = read.value;
    return goal;
  }
  goal.omega = read.ok() ? base::two_pi * read.value : radians.value;
  if (!(*goal.omega > 0.0))
    base::refuse(argument,
                 "expected a frequency above 0 (\"5 Hz\", \"x=5 Hz\") or a largest drop (\"2 %\")");
  return goal;
}

}  // namespace hydrapod::tasks
