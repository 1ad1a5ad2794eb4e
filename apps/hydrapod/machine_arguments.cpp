#include "hydrapod/machine_arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "hydrapod/base/key_values.hpp"
#include "hydrapod/base/nearest.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/kinematics/check_machine.hpp"
#include "hydrapod/spatial/directions.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

namespace {

/// `z=50 mm, ry=5 deg` over the neutral pose.
spatial::Pose displaced_pose(const spatial::Pose& neutral, const std::string& text) {
  base::KeyValues values("--pose " + text, text);
  spatial::Vector6 d;
  for (int i = 0; i < 6; ++i)
    d[i] = values.number(spatial::direction_name(i), i < 3 ? "m" : "rad").value_or(0.0);
  values.finish();
  return {spatial::rotation_from_rpy(d.tail<3>()) * neutral.R_BP, neutral.p_BP + d.head<3>()};
}

void require_sound(const model::Machine& machine, const report::PoseChoice& pose) {
  std::vector<base::Diagnostic> errors;
  for (const auto& finding : kinematics::check_pose(machine, pose.X_BP, ""))
    errors.push_back({.file = "--pose " + pose.name, .message = finding.message});
  if (!errors.empty()) throw base::InputError(errors);
}

}  // namespace

void bad_argument(const std::string& argument, const std::string& message) {
  throw base::InputError({{.file = argument, .message = message}});
}

std::optional<double> plain_number(const std::string& text) {
  const auto last = text.find_last_not_of(" \t");
  const bool has_unit = last == std::string::npos ||
                        std::string_view("0123456789.").find(text[last]) == std::string_view::npos;
  const auto read = base::read_quantity(text, "1");
  if (!read.ok() || has_unit) return {};  // "2 %" is a pure number, but not a plain one
  return read.value;
}

double plain_or_quantity(const std::string& argument, const std::string& text, const char* unit) {
  const auto read = base::read_plain_or_quantity(text, unit);
  if (!read.ok()) bad_argument(argument, read.problem);
  return read.value;
}

void add_machine_options(Command command, MachineArguments& arguments) {
  command.add_option("FILE", arguments.file, "Machine file (TOML); - reads the standard input")
      .required();
  command
      .add_option("--set", arguments.overrides,
                  "PATH=VALUE lays a value over the file, units allowed; may be repeated")
      .allow_extra_args(false)
      .type_name("PATH=VALUE");
}

void add_pose_option(Command command, MachineArguments& arguments) {
  command
      .add_option("--pose", arguments.pose,
                  "Pose of the file, or displacements from the neutral one: \"z=50 mm, ry=5 deg\"")
      .capture_default_str();
}

void add_model_option(Command command, MachineArguments& arguments) {
  command
      .add_option(
          "--model", arguments.model,
          "rigid (6 modes), guide (18: guide sleeves give way) or full (30: piston rings too); "
          "default: full where the file gives piston rings, else guide")
      .type_name("MODEL");
}

model::MachineFile load(const MachineArguments& arguments) {
  auto file =
      model::read_machine_file(arguments.file, arguments.overrides, kinematics::check_machine);
  print_diagnostics(file.warnings);
  return file;
}

report::PoseChoice choose_pose(const model::Machine& machine, const std::string& text) {
  for (const auto& pose : machine.poses)
    if (pose.name == text) return {pose.name, pose.X_BP};
  if (text.find('=') == std::string::npos) {
    std::vector<std::string_view> names;
    for (const auto& pose : machine.poses) names.push_back(pose.name);
    const auto near = base::nearest(text, names);
    bad_argument("--pose " + text,
                 near ? fmt::format("unknown pose; did you mean '{}'?", *near)
                      : fmt::format("unknown pose; the file has {}", fmt::join(names, ", ")));
  }
  report::PoseChoice choice{text, displaced_pose(machine.neutral(), text)};
  require_sound(machine, choice);
  return choice;
}

size_t choose_word(const std::string& option, const std::string& word,
                   const std::vector<std::string_view>& words) {
  const auto at = std::find(words.begin(), words.end(), word);
  if (at != words.end()) return static_cast<size_t>(at - words.begin());
  const auto near = base::nearest(word, words);
  bad_argument(
      option + " " + word,
      fmt::format("unknown value; {}accepted are {}",
                  near ? fmt::format("did you mean '{}'? ", *near) : "", fmt::join(words, ", ")));
}

dynamics::ModelKind choose_model(const model::Machine& machine, const std::string& text) {
  using dynamics::ModelKind;
  const bool rings = std::all_of(machine.legs.begin(), machine.legs.end(),
                                 [](const model::Leg& leg) { return leg.piston_ring.has_value(); });
  if (text.empty()) return rings ? ModelKind::full : ModelKind::guide;
  constexpr std::array kinds{ModelKind::rigid, ModelKind::guide, ModelKind::full};
  const ModelKind kind = kinds[choose_word("--model", text, {"rigid", "guide", "full"})];
  if (kind == ModelKind::full && !rings)
    bad_argument(
        "--model full",
        "not every leg has a piston ring; give legs.piston_ring.stiffness in the file or with "
        "--set legs.piston_ring.stiffness=\"… N/m\"");
  return kind;
}

}  // namespace hydrapod::cli
