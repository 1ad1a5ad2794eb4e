#include "hydrapod/record_machine.hpp"

#include <fmt/format.h>

#include <sstream>
#include <string_view>

#include "hydrapod/kinematics/check_machine.hpp"

namespace hydrapod::cli {

namespace {

constexpr std::string_view rig_mark = "test rig of hydrapod";
constexpr std::string_view pose_key = "pose: ", model_key = "model: ", set_key = "--set ";

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
                      const std::vector<std::string>& overrides) {
  std::string text =
      fmt::format("{}\n{}{}\n{}{}", rig_mark, pose_key, pose, model_key, dynamics::name(kind));
  for (const auto& change : overrides) text += fmt::format("\n{}{}", set_key, change);
  return text;
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
    found.file = load({.file = machine});
  } else if (header != nullptr && !header->machine.empty()) {
    found.name = record + " (machine)";
    found.file = model::parse_machine(header->machine, found.name, notes.overrides,
                                      kinematics::check_machine);
    if (model.empty()) model = notes.model;
  } else {
    return {};
  }
  found.pose = choose_pose(found.file.machine, !pose.empty()         ? pose
                                               : !notes.pose.empty() ? notes.pose
                                                                     : "neutral");
  found.kind = choose_model(found.file.machine, model);
  return found;
}

}  // namespace hydrapod::cli
