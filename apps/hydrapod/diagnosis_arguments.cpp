#include "hydrapod/identification_arguments.hpp"

#include "hydrapod/base/text.hpp"
#include "hydrapod/machine_arguments.hpp"

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
  const auto goal = tasks::read_goal(arguments.want, "--want " + arguments.want);
  auto poses = poses_of(machine, arguments.poses);
  return {.measured = {.files = arguments.measured, .observed = observed},
          .rules = arguments.options,
          .goal = goal,
          .poses = std::move(poses)};
}

}  // namespace hydrapod::cli
