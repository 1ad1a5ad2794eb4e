#include "hydrapod/record_machine.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hydrapod/base/version.hpp"
#include "hydrapod/commands.hpp"
#include "hydrapod/kinematics/check_machine.hpp"

namespace hydrapod::cli {

namespace {

/// A pose of the machine by its name, else by its numbers, else by what its name says.
report::PoseChoice recorded_pose(const model::Machine& machine, const data::Experiment* e) {
  if (e == nullptr || e->pose_name.empty()) return choose_pose(machine, "neutral");
  const bool named = std::ranges::find(machine.poses, e->pose_name, &model::NamedPose::name) !=
                     machine.poses.end();
  if (named || !e->pose) return choose_pose(machine, e->pose_name);
  const auto& p = *e->pose;
  return {e->pose_name,
          {.R_BP = spatial::rotation_from_rpy({p[3], p[4], p[5]}), .p_BP = {p[0], p[1], p[2]}}};
}

}  // namespace

data::Experiment experiment_of(const model::MachineFile& file, const report::PoseChoice& pose,
                               dynamics::ModelKind kind, std::uint64_t seed) {
  const spatial::Vector3 rpy = spatial::rpy_from_rotation(pose.X_BP.R_BP), &p = pose.X_BP.p_BP;
  return {.program = fmt::format("hydrapod {}", base::version),
          .command = command_line(),
          .machine = file.text,
          .overrides = file.overrides,
          .pose_name = pose.name,
          .pose = {{p.x(), p.y(), p.z(), rpy.x(), rpy.y(), rpy.z()}},
          .model = std::string(dynamics::name(kind)),
          .seed = seed};
}

std::optional<RecordMachine> record_machine(const data::Experiment* experiment,
                                            const std::string& record, const std::string& machine,
                                            const std::string& pose, const std::string& kind) {
  RecordMachine found;
  std::string model = kind;
  if (!machine.empty()) {
    found.name = machine;
    found.file = load({.file = machine});
  } else if (experiment != nullptr && !experiment->machine.empty()) {
    found.name = record + " (machine)";
    found.file = model::parse_machine(experiment->machine, found.name, experiment->overrides,
                                      kinematics::check_machine);
    if (model.empty()) model = experiment->model;
  } else {
    return {};
  }
  found.pose = pose.empty() ? recorded_pose(found.file.machine, experiment)
                            : choose_pose(found.file.machine, pose);
  found.kind = choose_model(found.file.machine, model);
  return found;
}

}  // namespace hydrapod::cli
