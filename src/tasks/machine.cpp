#include "hydrapod/tasks/machine.hpp"
#include "hydrapod/base/error.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hydrapod/base/text.hpp"
#include "hydrapod/kinematics/check_machine.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::tasks {

namespace {

/// `z=50 mm, ry=5 deg` from the neutral pose.
spatial::Pose displaced_pose(const spatial::Pose& neutral, const std::string& text,
                             const std::string& argument) {
  base::KeyValues values(argument, text);
  spatial::Vector6 d;
  for (int i = 0; i < 6; ++i)
    d[i] = values.number(spatial::direction_name(i), i < 3 ? "m" : "rad").value_or(0.0);
  values.finish();
  return {spatial::rotation_from_rpy(d.tail<3>()) * neutral.R_BP, neutral.p_BP + d.head<3>()};
}

/// Throws base::InputError, which calls the pose `place`.
void refuse_unreachable(const model::Machine& machine, const spatial::Pose& X_BP,
                        const std::string& place) {
  std::vector<base::Diagnostic> errors;
  for (const auto& finding : kinematics::check_pose(machine, X_BP, ""))
    errors.push_back({.file = place, .message = finding.message});
  if (!errors.empty()) throw base::InputError(errors);
}

}  // namespace

Machine read_machine(const MachineOptions& options) {
  Machine machine{.path = options.file};
  machine.file = options.text ? model::parse_machine(*options.text, options.file, options.overrides,
                                                     kinematics::check_machine)
                              : model::read_machine_file(options.file, options.overrides,
                                                         kinematics::check_machine);
  machine.pose = pose_of(machine.file.machine, options.pose);
  machine.kind = model_of(machine.file.machine, options.model);
  return machine;
}

model::NamedPose pose_of(const model::Machine& machine, const std::string& text) {
  if (const auto* pose = find_pose(machine, text)) return *pose;
  const std::string place = "--pose " + text;
  if (text.find('=') == std::string::npos) {
    std::vector<std::string_view> names;
    for (const auto& pose : machine.poses) names.push_back(pose.name);
    const auto near = base::nearest(text, names);
    base::refuse(place, near
                            ? fmt::format("unknown pose; did you mean '{}'?", *near)
                            : fmt::format("unknown pose; the file has {}", fmt::join(names, ", ")));
  }
  const model::NamedPose pose{text, displaced_pose(machine.neutral(), text, place)};
  refuse_unreachable(machine, pose.X_BP, place);
  return pose;
}

dynamics::ModelKind model_of(const model::Machine& machine,
                             std::optional<dynamics::ModelKind> asked) {
  using dynamics::ModelKind;
  const bool rings = std::ranges::all_of(
      machine.legs, [](const model::Leg& leg) { return leg.piston_ring.has_value(); });
  if (!asked) return rings ? ModelKind::full : ModelKind::guide;
  if (*asked == ModelKind::full && !rings)
    base::refuse(
        "--model full",
        "not every leg has a piston ring; give legs.piston_ring.stiffness in the file or with "
        "--set legs.piston_ring.stiffness=\"… N/m\"");
  return *asked;
}

std::size_t add_pose(model::MachineFile& file, model::NamedPose& pose, const std::string& name) {
  auto& machine = file.machine;
  if (const auto* known = find_pose(machine, pose.name))
    return static_cast<std::size_t>(known - machine.poses.data());
  refuse_unreachable(machine, pose.X_BP, "--pose " + pose.name);
  pose.name = name;
  while (find_pose(machine, pose.name) != nullptr) pose.name += '_';
  const spatial::Vector3 p = pose.X_BP.p_BP, rpy = spatial::rpy_from_rotation(pose.X_BP.R_BP);
  file.overrides.push_back(fmt::format(
      "poses.{}={{ position = [{:.17g}, {:.17g}, {:.17g}], rotation = [{:.17g}, {:.17g}, "
      "{:.17g}] }}",
      pose.name, p.x(), p.y(), p.z(), rpy.x(), rpy.y(), rpy.z()));
  machine.poses.push_back({pose.name, {spatial::rotation_from_rpy(rpy), p}});
  for (const auto& [key, numbers] : {std::pair{"rotation", rpy}, {"position", p}})
    for (int k = 0; k < 3; ++k) {
      const std::string path = fmt::format("poses.{}.{}[{}]", pose.name, key, k);
      file.given.push_back({find_parameter(machine, path).value(), numbers[k], 0, path});
    }
  return machine.poses.size() - 1;
}

}  // namespace hydrapod::tasks
