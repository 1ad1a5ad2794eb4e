#pragma once
/// The JSON that the command line writes and the web pages read. Field names are documented in
/// docs/howto/json.md and stable: new fields may come, none changes its meaning.
///
/// A reader stands beside its writer. It throws base::InputError with file and key; `file` is what
/// messages call the JSON.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/model/machine_file.hpp"

namespace hydrapod::report {

using Json = nlohmann::ordered_json;

/// A machine as a result is of it.
struct Subject {
  model::MachineFile file{};
  std::string path{};  ///< of the file, as messages and JSON call it
  model::NamedPose pose{};
  dynamics::ModelKind kind{};
};

/// What a result was computed from: name, source, file, overrides.
Json machine_json(const model::MachineFile& file, const std::string& path);

Json pose_json(const model::NamedPose& pose);
/// `pose` of a result.
model::NamedPose pose_from_json(const Json& json, const std::string& file);

/// Gravity, axes, damping: everything a reader must know to reproduce the numbers.
Json assumptions_json(const model::Machine& machine);

/// How a result's JSON begins: `kind`, `machine`, `assumptions`, and for a result at one pose
/// `pose`.
Json head_json(const char* kind, const model::MachineFile& file, const std::string& path);
Json head_json(const char* kind, const Subject& subject);

/// `modes[]`, `rigid_modes[]`, `coordinates[]`.
Json modes_json(const modal::ModeTable& table);
/// Reads it. Models (`linear`, `normal`) stay empty.
modal::ModeTable modes_from_json(const Json& json, const std::string& file);

/// `matrices`: M, K, C of the model asked for and of the rigid one, row by row.
Json matrices_json(const modal::ModeTable& table);

/// "2 % of critical in every mode (default, the machine file gives no damping)".
std::string damping_text(const model::Machine& machine);

/// "gravity 9.81 m/s² downwards", "no gravity".
std::string gravity_text(const model::Machine& machine);

}  // namespace hydrapod::report
