#include "hydrapod/record_machine.hpp"

#include <fmt/format.h>

#include <sstream>
#include <string_view>

#include "hydrapod/kinematics/check_machine.hpp"

namespace hydrapod::cli {

namespace {

constexpr std::string_view rig_mark = "test rig of hydrapod";
constexpr std::string_view pose_key = "pose: ", model_key = "model: ", set_key = "--set ",
                           sensor_key = "sensor: ";

struct Noted {
  std::string pose{}, model{};
  std::vector<std::string> overrides{};
};

Noted noted(const std::string& notes) {
  Noted found;
  std::istringstream lines(notes);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(pose_key)) found.pose = line.substr(pose_key.size());
    if (line.starts_with(model_key)) found.model = line.substr(model_key.size());
    if (line.starts_with(set_key)) found.overrides.push_back(line.substr(set_key.size()));
  }
  return found;
}

}  // namespace

std::string rig_notes(const std::string& pose, dynamics::ModelKind kind,
                      const std::vector<std::string>& overrides,
                      const std::vector<PlacedSensor>& sensors) {
  std::string text =
      fmt::format("{}\n{}{}\n{}{}", rig_mark, pose_key, pose, model_key, dynamics::name(kind));
  for (const auto& change : overrides) text += fmt::format("\n{}{}", set_key, change);
  const auto numbers = [](const spatial::Vector3& v) {
    return fmt::format("{:.9g} {:.9g} {:.9g}", v.x(), v.y(), v.z());
  };
  for (const auto& s : sensors)
    text +=
        fmt::format("\n{}{} at={} along={}", sensor_key, s.name, numbers(s.p_P), numbers(s.e_P));
  return text;
}

std::vector<PlacedSensor> placed_sensors(const data::RecordHeader& header) {
  std::vector<PlacedSensor> sensors;
  std::istringstream lines(header.notes);
  for (std::string line; std::getline(lines, line);) {
    // names may hold anything, so what follows them is looked for from the end
    const auto at = line.rfind(" at="), along = line.rfind(" along=");
    if (!line.starts_with(sensor_key) || at == std::string::npos || along == std::string::npos ||
        at < sensor_key.size() || along < at)
      continue;
    PlacedSensor sensor{.name = line.substr(sensor_key.size(), at - sensor_key.size())};
    std::istringstream place(line.substr(at + 4, along - at - 4)), axis(line.substr(along + 7));
    for (int d = 0; d < 3; ++d) {
      place >> sensor.p_P[d];
      axis >> sensor.e_P[d];
    }
    if (place && axis) sensors.push_back(sensor);
  }
  return sensors;
}

bool is_rig_record(const data::RecordHeader& header) {
  return header.notes.starts_with(rig_mark) && !noted(header.notes).pose.empty();
}

std::optional<RecordMachine> record_machine(const data::RecordHeader* header,
                                            const std::string& record, const std::string& machine,
                                            const std::string& pose, const std::string& kind) {
  const Noted notes = header != nullptr ? noted(header->notes) : Noted{};
  RecordMachine found;
  std::string model = kind;
  if (!machine.empty()) {
    found.name = machine;
    found.file = load({.file = machine}).file;
  } else if (header != nullptr && !header->machine.empty()) {
    found.name = record + " (machine)";
    found.file = model::parse_machine(header->machine, found.name, notes.overrides,
                                      kinematics::check_machine);
    if (model.empty()) model = notes.model;
  } else {
    return {};
  }
  found.pose = tasks::pose_of(found.file.machine, !pose.empty()         ? pose
                                                  : !notes.pose.empty() ? notes.pose
                                                                        : "neutral");
  found.kind = tasks::model_of(found.file.machine, model_kind(model));
  return found;
}

}  // namespace hydrapod::cli
