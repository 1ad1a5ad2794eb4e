#include <fmt/format.h>

#include <Eigen/Geometry>

#include "hydrapod/base/error.hpp"
#include "hydrapod/model/section.hpp"
#include "hydrapod/tasks/linear.hpp"

namespace hydrapod::tasks {

namespace {

using model::FileEdit;
using spatial::Matrix3;
using spatial::Vector3;

constexpr const char* label = "attached";
constexpr int digits = 12;

exchange::PayloadElement element_of(const AttachOptions& options) {
  if (options.universal) return exchange::read_universal_element(options.stiffness, options.grid);
  if (options.mass.empty()) return exchange::read_dmig_punch(options.stiffness, options.grid);
  exchange::PayloadElement element;
  element.K = exchange::read_matrix_market(options.stiffness);
  element.M = exchange::read_matrix_market(options.mass);
  if (!options.damping.empty()) element.C = exchange::read_matrix_market(options.damping);
  return element;
}

std::string list_text(const Vector3& v) {
  return fmt::format("[{:.{}g}, {:.{}g}, {:.{}g}]", v.x(), digits, v.y(), digits, v.z(), digits);
}

/// As a table at the end of a file.
std::string mode_text(const model::PayloadMode& mode) {
  std::string text = fmt::format("\n[payload_modes.{}]\nfrequency = \"{:.{}g} Hz\"\n",
                                 model::written_key(mode.name), mode.frequency, digits);
  if (mode.damping_ratio != 0.0)
    text += fmt::format("damping_ratio = {:.{}g}\n", mode.damping_ratio, digits);
  return text + fmt::format("participation = {}\nparticipation_moment = {}\n",
                            list_text(*mode.participation), list_text(mode.participation_moment));
}

/// The platform with a structure of this mass matrix about `p_PI`, axes of P.
model::Platform heavier(const model::Platform& platform, const spatial::Matrix6& M,
                        const Vector3& p_PI) {
  const double m = M.topLeftCorner<3, 3>().trace() / 3.0;
  const Matrix3 moment = M.bottomLeftCorner<3, 3>();  // m [r]×
  const Vector3 r = Vector3(moment(2, 1) - moment(1, 2), moment(0, 2) - moment(2, 0),
                            moment(1, 0) - moment(0, 1)) /
                    (2.0 * m);
  const auto steiner = [](double mass, const Vector3& d) -> Matrix3 {
    return mass * (d.squaredNorm() * Matrix3::Identity() - d * d.transpose());
  };
  const Matrix3 own = M.bottomRightCorner<3, 3>() - steiner(m, r);
  model::Platform sum;
  sum.mass = platform.mass + m;
  sum.mass_center = (platform.mass * platform.mass_center + m * (p_PI + r)) / sum.mass;
  sum.inertia = platform.inertia + steiner(platform.mass, platform.mass_center - sum.mass_center) +
                own + steiner(m, p_PI + r - sum.mass_center);
  return sum;
}

/// Numbers of the platform where they stand in the file.
void change_platform(const model::MachineFile& file, const model::Platform& platform,
                     std::vector<FileEdit>& edits) {
  model::Machine changed = file.machine;
  changed.platform = platform;
  for (const auto& id : model::parameters(changed)) {
    const auto path = model::path(changed, id);
    if (path != "platform.mass" && !path.starts_with("platform.mass_center") &&
        !path.starts_with("platform.inertia"))
      continue;
    const double value = *model::value(changed, id);
    if (value == model::value(file.machine, id)) continue;
    std::vector<std::string> places;
    for (const auto& given : file.given)
      if (given.id == id) places.push_back(given.written);
    if (places.empty()) places.push_back(path);
    for (const auto& at : places) {
      const auto unit = model::written_unit(file.text, at, std::string(model::unit(changed, id)));
      edits.push_back({at, model::written(value, unit, digits)});
    }
  }
}

/// A machine has `there` modes of the payload already.
void require_room(int there, int modes) {
  const int room = model::most_payload_modes - there;
  if (room < 1)
    base::refuse("payload_modes",
                 fmt::format("the machine file has {} modes already, expected fewer than {}", there,
                             model::most_payload_modes));
  if (modes < 1 || modes > room)
    base::refuse(fmt::format("--modes {}", modes),
                 fmt::format("expected 1 to {}: a machine has up to {} modes of the payload, and "
                             "its file has {} already",
                             room, model::most_payload_modes, there));
}

/// The first failure of the machine that would be written, as one of the superelement.
void require_sound(const model::MachineFile& file, const AttachOptions& options) {
  for (const auto& finding : model::validate(file.machine))
    if (finding.severity == base::Severity::error)
      base::refuse(
          options.stiffness,
          fmt::format("the machine with its modes is not sound: {}: {}{}", finding.key,
                      finding.message,
                      options.add_mass ? "" : "; add the structure's mass with --add-mass"));
}

/// Tables cannot follow modes that a file gives between braces.
void require_readable(const std::string& text) {
  try {
    model::parse_machine(text, "attached machine");
  } catch (const base::InputError& error) {
    base::refuse("payload_modes", fmt::format("tables with the modes cannot be added to this file "
                                              "({}); expected its own modes as tables "
                                              "[payload_modes.NAME]",
                                              error.what()));
  }
}

}  // namespace

Attached attach_payload(const Machine& machine, const AttachOptions& options) {
  Attached attached{.file = machine.file};
  auto& file = attached.file;
  require_room(static_cast<int>(file.machine.payload_modes.size()), options.modes);
  attached.payload = exchange::payload_modes(
      element_of(options),
      {.p_PI = options.p_PI, .modes = options.modes, .damping_ratio = options.damping_ratio});
  auto edits = model::edits_of_overrides(file.text, file.overrides);
  if (options.add_mass) {
    const auto platform = heavier(file.machine.platform, attached.payload.mass, options.p_PI);
    change_platform(file, platform, edits);
    file.machine.platform = platform;
  }
  std::string tables;
  for (auto& mode : attached.payload.modes) {
    mode.name =
        model::next_payload_mode(file.machine, static_cast<int>(file.machine.payload_modes.size()));
    file.machine.payload_modes.push_back(mode);
    tables += mode_text(mode);
  }
  require_sound(file, options);
  file.text = model::edited_file(file.text, edits, label);
  if (!file.text.ends_with('\n')) file.text += '\n';
  file.text += tables;
  require_readable(file.text);
  file.overrides.clear();
  return attached;
}

}  // namespace hydrapod::tasks
