#include "hydrapod/tasks/machine.hpp"
#include "hydrapod/base/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::tasks {

namespace {

/// `z=50 mm, ry=5 deg` as it was written: lengths and angles, with what a number without a unit, or
/// in m and rad, would be in millimetres and degrees.
struct Displacement {
  spatial::Vector6 d{};      ///< as it is read
  spatial::Vector6 in_mm{};  ///< numbers of SI in millimetres and degrees
  std::string in_mm_text{};  ///< that, as one would write it
  bool of_si{};              ///< is there any?
};

/// The number of "5" and of "5 m"; empty where it is 0, or too small with its unit to be
/// millimetres or degrees, or in another unit.
std::string number_of_si(std::string_view text, std::string_view unit) {
  if (text.ends_with(unit)) {
    const std::string number(base::trimmed(text.substr(0, text.size() - unit.size())));
    const auto read = base::read_plain_or_quantity(number, unit);
    const bool plain = read.ok() && !base::read_quantity(number, unit).ok();
    return plain && std::abs(read.value) >= 1.0 ? number : std::string{};
  }
  const bool plain = !base::read_quantity(text, unit).ok();
  return plain && base::read_plain_or_quantity(text, unit).value != 0.0 ? std::string(text)
                                                                        : std::string{};
}

Displacement displacement(const std::string& text, const std::string& argument) {
  base::KeyValues values(argument, text);
  Displacement result;
  std::vector<std::string> parts;
  for (int i = 0; i < 6; ++i) {
    const auto key = spatial::direction_name(i);
    const char* unit = i < 3 ? "m" : "rad";
    const auto written = values.text(key);
    result.d[i] = result.in_mm[i] = values.number(key, unit).value_or(0.0);
    if (!written) continue;
    std::string meant = number_of_si(*written, unit);
    if (!meant.empty()) {
      meant += i < 3 ? " mm" : " deg";
      result.in_mm[i] = base::quantity(meant, unit);
      result.of_si = true;
    }
    parts.push_back(fmt::format("{}={}", key, meant.empty() ? *written : meant));
  }
  values.finish();
  result.in_mm_text = fmt::format("{}", fmt::join(parts, ", "));
  return result;
}

/// As `--pose` says: angles of roll, pitch and yaw, not a rotation vector.
spatial::Pose moved(const spatial::Pose& from, const spatial::Vector6& d) {
  return {spatial::rotation_from_rpy(d.tail<3>()) * from.R_BP, from.p_BP + d.head<3>()};
}

/// Throws base::InputError, which calls the pose `place`; `guess` ends its messages.
void refuse_unreachable(const model::Machine& machine, const spatial::Pose& X_BP,
                        const std::string& place, const std::string& guess = {}) {
  std::vector<base::Diagnostic> errors;
  for (const auto& finding : kinematics::check_pose(machine, X_BP, ""))
    errors.push_back({.file = place, .message = finding.message + guess});
  if (!errors.empty()) throw base::InputError(errors);
}

}  // namespace

/// Where the legs would reach it with millimetres and degrees, that is the advice.
spatial::Vector6 displacement_of(const model::Machine& machine, const spatial::Pose& from,
                                 const std::string& text, const std::string& place) {
  const auto read = displacement(text, place);
  std::string guess;
  if (read.of_si && kinematics::check_pose(machine, moved(from, read.in_mm), "").empty())
    guess = fmt::format("; did you mean \"{}\"?", read.in_mm_text);
  const auto in_degrees =
      read.of_si ? fmt::format("; did you mean \"{}\"?", read.in_mm_text) : std::string{};
  for (const double angle : read.d.tail<3>())
    if (std::abs(angle) > std::numbers::pi)
      base::refuse(place, fmt::format("turns the platform by more than half a turn, {:g} rad{}",
                                      angle, in_degrees));
  refuse_unreachable(machine, moved(from, read.d), place, guess);
  return read.d;
}

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
  const auto& neutral = machine.neutral();
  return {text, moved(neutral, displacement_of(machine, neutral, text, place))};
}

dynamics::ModelKind model_of(const model::Machine& machine,
                             std::optional<dynamics::ModelKind> asked) {
  using dynamics::ModelKind;
  if (model::leg_type(machine) == model::LegType::strut) {
    if (asked && *asked != ModelKind::rigid)
      base::refuse(fmt::format("--model {}", dynamics::name(*asked)),
                   "plain struts have neither guide sleeves nor piston rings; expected --model "
                   "rigid, which is taken where none is asked for");
    return ModelKind::rigid;
  }
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
