#include "hydrapod/identification_arguments.hpp"

#include <fmt/format.h>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/machine_arguments.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::cli {

namespace {

/// Names with commas, "all" or "workspace".
std::vector<model::NamedPose> poses_of(const model::Machine& machine, const std::string& text) {
  if (text.empty() || text == "all") return {};  // all of the file
  if (text == "workspace") return diagnosis::workspace_poses(machine);
  std::vector<model::NamedPose> poses;
  for (const auto& name : base::split(text, ";")) poses.push_back(tasks::pose_of(machine, name));
  return poses;
}

/// "2 %", "drop 2 %", "5.2 Hz", "x=5.2 Hz", "x=3 %"; and as requirements of studies are written,
/// "x >= 5.2 Hz", "lowest >= 5.2 Hz", "drop <= 2 %".
diagnosis::RemedyGoal remedy_goal(const std::string& text) {
  diagnosis::RemedyGoal goal;
  std::string_view amount = base::trimmed(text);
  const std::string argument = "--want " + text;
  if (const auto equals = amount.find('='); equals != std::string::npos) {
    const char before = equals > 0 ? amount[equals - 1] : ' ';
    const bool compares = before == '<' || before == '>';
    const std::string direction(base::trimmed(amount.substr(0, equals - (compares ? 1 : 0))));
    amount = base::trimmed(amount.substr(equals + 1));
    if (compares && (before == '<') != amount.ends_with('%'))
      base::refuse(argument,
                   "a frequency is at least what is wanted (\"x >= 5 Hz\") and a drop at most "
                   "(\"x <= 2 %\")");
    if (direction == (amount.ends_with('%') ? "lowest" : "drop"))
      base::refuse(
          argument,
          "a drop is wanted in % (\"drop <= 2 %\"), a lowest frequency in Hz (\"lowest >= 5 Hz\")");
    if (!compares || (direction != "lowest" && direction != "drop"))
      goal.direction = static_cast<int>(choose_word(
          argument, direction, {spatial::direction_names.begin(), spatial::direction_names.end()}));
  }
  if (amount.starts_with("drop")) amount = base::trimmed(amount.substr(4));
  if (amount.ends_with('%')) {
    const auto drop = base::read_quantity(amount, "1");
    if (!(drop.value > 0.0 && drop.value < 1.0))
      base::refuse(argument, "expected a drop above 0 % and below 100 %, such as \"2 %\"");
    goal.drop = drop.value;
    return goal;
  }
  const double frequency = plain_or_quantity(argument, std::string(amount), "Hz");
  if (!(frequency > 0.0))
    base::refuse(argument,
                 "expected a frequency above 0 (\"5 Hz\", \"x=5 Hz\") or a largest drop "
                 "(\"2 %\")");
  goal.omega = base::two_pi * frequency;
  return goal;
}

}  // namespace

void add_diagnosis_options(Command command, DiagnosisArguments& arguments) {
  command.add_options(
      {{"--want", arguments.want,
        "Goal for the guide sleeves: a largest drop \"2 %\" below the rigid-leg model, "
        "or a lowest frequency \"5 Hz\"; in one direction \"x=5 Hz\" or \"x >= 5 Hz\""},
       {"--poses", arguments.poses,
        "Poses for the goal and for further measurements: names or displacements "
        "separated by semicolons, all, or workspace [all of the file]"}});
}

tasks::DiagnoseOptions diagnose_options(const DiagnosisArguments& arguments,
                                        const model::Machine& machine) {
  // What can throw comes first: GCC 12 destroys the nested list of files twice where a later member
  // of the braces throws.
  const auto observed = observed_system(arguments.against);
  const auto goal = remedy_goal(arguments.want);
  auto poses = poses_of(machine, arguments.poses);
  return {.measured = {.files = arguments.measured, .observed = observed},
          .rules = arguments.options,
          .goal = goal,
          .poses = std::move(poses)};
}

}  // namespace hydrapod::cli
