#include "hydrapod/diagnosis_arguments.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hydrapod/base/constants.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/interrupt.hpp"
#include "hydrapod/measured_modes.hpp"
#include "hydrapod/spatial/directions.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

namespace {

/// Names with commas, "all" or "workspace".
std::vector<model::NamedPose> poses_of(const model::Machine& machine, const std::string& text) {
  if (text.empty() || text == "all") return machine.poses;
  if (text == "workspace") return diagnosis::workspace_poses(machine);
  std::vector<model::NamedPose> poses;
  for (const auto& name : base::split(text, ";")) poses.push_back(tasks::pose_of(machine, name));
  return poses;
}

}  // namespace

diagnosis::RemedyGoal remedy_goal(const std::string& text) {
  diagnosis::RemedyGoal goal;
  std::string_view amount = base::trimmed(text);
  const std::string argument = "--want " + text;
  if (const auto equals = amount.find('='); equals != std::string::npos) {
    const std::string direction(base::trimmed(amount.substr(0, equals)));
    goal.direction = static_cast<int>(choose_word(
        argument, direction, {spatial::direction_names.begin(), spatial::direction_names.end()}));
    amount = base::trimmed(amount.substr(equals + 1));
  }
  if (amount.starts_with("drop")) amount = base::trimmed(amount.substr(4));
  if (amount.ends_with('%')) {
    const auto drop = base::read_quantity(amount, "1");
    if (!(drop.value > 0.0 && drop.value < 1.0))
      bad_argument(argument, "expected a drop above 0 % and below 100 %, such as \"2 %\"");
    goal.drop = drop.value;
    return goal;
  }
  const double frequency = plain_or_quantity(argument, std::string(amount), "Hz");
  if (!(frequency > 0.0))
    bad_argument(argument,
                 "expected a frequency above 0 (\"5 Hz\", \"x=5 Hz\") or a largest drop "
                 "(\"2 %\")");
  goal.omega = base::two_pi * frequency;
  return goal;
}

void add_diagnosis_options(Command command, DiagnosisArguments& arguments) {
  command
      .add_option("--want", arguments.want,
                  "What the guide sleeves are to reach: a largest drop \"2 %\" below rigid, or a "
                  "frequency \"5 Hz\"; in one direction \"x=5 Hz\"")
      .capture_default_str();
  command.add_option("--poses", arguments.poses,
                     "Where it is to be reached, and where could be measured: names or "
                     "displacements with semicolons, all, or workspace [all of the file]");
}

int guilty_mode(const diagnosis::Diagnosis& found, const std::string& pose) {
  if (found.alike.empty()) return 0;
  const auto& fit = found.explanations[found.alike.front()].fit;
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

diagnosis::CaseFile investigate(const DiagnosisArguments& arguments, const MachineArguments& asked,
                                tasks::Machine machine) {
  tasks::add_pose(machine.file, machine.pose, "as_measured");
  const auto& [file, path, named, kind] = machine;
  const auto& pose = named.name;
  diagnosis::CaseFile result{
      .machine = file.machine, .kind = kind, .pose = pose, .goal = remedy_goal(arguments.want)};
  const auto poses = poses_of(file.machine, arguments.poses);
  const InterruptNote interrupt;
  if (!arguments.measured.empty()) {
    const auto measured = read_measured(arguments.measured, asked, file, pose, arguments.against);
    ProgressLine line("diagnosing");
    result.diagnosis =
        diagnosis::diagnose(file, measured, kind, poses, arguments.options, [&](double share) {
          line.update(share);
          return InterruptNote::noted();
        });
    const auto& d = *result.diagnosis;
    if (d.alike.empty() || d.interrupted) return result;
    const auto& best = d.explanations[d.alike.front()];
    result.machine = diagnosis::machine_of(file, best);
    result.kind = best.kind;
  }
  const auto X_BP = std::ranges::find(result.machine.poses, pose, &model::NamedPose::name)->X_BP;
  if (result.kind == dynamics::ModelKind::rigid) return result;  // nothing to give way
  for (auto& drop : diagnosis::attribute_drops(result.machine, X_BP, result.kind))
    result.drops.push_back(std::move(drop));
  ProgressLine line("looking for a remedy");
  result.remedy =
      diagnosis::find_remedy(result.machine, poses, result.kind, result.goal, [&](double share) {
        line.update(share);
        return InterruptNote::noted();
      });
  return result;
}

}  // namespace hydrapod::cli
