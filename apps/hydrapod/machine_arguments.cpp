#include "hydrapod/machine_arguments.hpp"
#include "hydrapod/base/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/reproduction.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

double plain_or_quantity(const std::string& argument, const std::string& text, const char* unit) {
  const auto read = base::read_plain_or_quantity(text, unit);
  if (!read.ok()) base::refuse(argument, read.problem);
  return read.value;
}

double positive_quantity(const std::string& option, const std::string& text, const char* unit,
                         const char* expected) {
  const std::string argument = option + " " + text;
  const double value = plain_or_quantity(argument, text, unit);
  if (!(value > 0.0)) base::refuse(argument, expected);
  return value;
}

namespace {
/// "300 m" is soon written for 300 mm. What a file may hold at the same place is judged by the
/// table of parameters: a point of the platform is that of a swinging mass. Less than 1 m is no
/// mistake.
void warn_of_unusual(const std::string& argument, const spatial::Vector3& p_PQ) {
  model::Machine machine;
  machine.payload_modes.push_back({.position = p_PQ});
  for (auto& length : machine.payload_modes.front().position)
    if (std::abs(length) < 1.0) length = 0.0;
  for (const auto& finding : model::unusual_numbers(machine).findings) {
    if (!finding.key.starts_with("payload_modes.")) continue;
    const char axis = "xyz"[finding.key.at(finding.key.size() - 2) - '0'];  // …position[2]
    return print_warning(fmt::format("{} {}", axis, finding.message), argument);
  }
}
}  // namespace

spatial::Vector3 point(const std::string& option, const std::string& text) {
  const auto parts = base::split(text, ",");
  const std::string argument = option + " " + text;
  if (parts.size() != 3)
    base::refuse(argument, "a point is three lengths, for instance \"0,0,0.2 m\"");
  const spatial::Vector3 p_PQ{plain_or_quantity(argument, parts[0], "m"),
                              plain_or_quantity(argument, parts[1], "m"),
                              plain_or_quantity(argument, parts[2], "m")};
  warn_of_unusual(argument, p_PQ);
  return p_PQ;
}

void add_machine_options(Command command, MachineArguments& arguments) {
  command.add_options(
      {{"FILE", arguments.file, "Machine file (TOML); - reads the standard input", reads_required},
       {"--set", arguments.overrides,
        "PATH=VALUE overrides a value of the file, units allowed; may be repeated",
        one_each_as("PATH=VALUE")}});
}

void add_pose_option(Command command, MachineArguments& arguments) {
  command.add_options(
      {{"--pose", arguments.pose,
        "Pose of the file, or displacements from the neutral pose: \"z=50 mm, ry=5 deg\""}});
}

void add_model_option(Command command, MachineArguments& arguments) {
  command.add_options(
      {{"--model", arguments.model,
        "rigid (6 modes), guide (18: compliant guide sleeves) or full (30: piston rings "
        "too); default: full where the file has piston rings, else guide",
        shown_as("MODEL")}});
}

void add_subject_options(Command command, MachineArguments& arguments) {
  add_machine_options(command, arguments);
  add_pose_option(command, arguments);
  add_model_option(command, arguments);
}

tasks::Machine load(const MachineArguments& arguments) {
  auto machine = tasks::read_machine({.file = arguments.file,
                                      .overrides = arguments.overrides,
                                      .pose = arguments.pose,
                                      .model = model_kind(arguments.model)});
  print_diagnostics(machine.file.warnings);
  return machine;
}

std::vector<model::NamedPose> poses_of(const std::vector<std::string>& named,
                                       const std::string& all, const model::Machine& machine) {
  std::vector<model::NamedPose> poses;
  const auto is_given = [&](const std::string& name) {
    return std::ranges::any_of(poses, [&](const auto& pose) { return pose.name == name; });
  };
  for (const auto& text : named) {
    auto pose = tasks::pose_of(machine, text);
    if (is_given(pose.name)) base::refuse("--pose " + text, "is given twice");
    poses.push_back(std::move(pose));
  }
  if (all.empty()) return poses;
  choose_word("--poses", all, {"all"});
  for (const auto& pose : machine.poses)
    if (!is_given(pose.name)) poses.push_back(pose);
  return poses;
}

std::optional<dynamics::ModelKind> model_kind(const std::string& word) {
  if (word.empty()) return {};
  return static_cast<dynamics::ModelKind>(choose_word("--model", word, {"rigid", "guide", "full"}));
}

size_t choose_word(const std::string& option, const std::string& word,
                   const std::vector<std::string_view>& words) {
  const auto at = std::find(words.begin(), words.end(), word);
  if (at != words.end()) return static_cast<size_t>(at - words.begin());
  const auto near = base::nearest(word, words);
  base::refuse(
      option + " " + word,
      fmt::format("unknown value; {}accepted are {}",
                  near ? fmt::format("did you mean '{}'? ", *near) : "", fmt::join(words, ", ")));
}

report::Json head_of_model(const char* kind, const tasks::Machine& machine) {
  auto json = report::head_json(kind, machine);
  json["model"] = dynamics::name(machine.kind);
  return json;
}

std::string json_text(report::Json head, const report::Json& result, int indent) {
  head.update(result);
  head["reproduction"] = reproduction();
  return head.dump(indent) + "\n";
}

}  // namespace hydrapod::cli
