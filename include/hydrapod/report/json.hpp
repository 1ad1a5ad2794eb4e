#pragma once
/// The JSON that the command line writes and the web pages read. Field names are documented in
/// docs/howto/json.md and stable: new fields may come, none changes its meaning.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/report/pose_choice.hpp"
#include "hydrapod/response/peaks.hpp"

namespace hydrapod::report {

using Json = nlohmann::ordered_json;

/// What a result was computed from: name, source, file, overrides.
Json machine_json(const model::MachineFile& file, const std::string& path);

Json pose_json(const PoseChoice& pose);

/// Gravity, axes, damping: everything a reader must know to reproduce the numbers.
Json assumptions_json(const model::Machine& machine);

/// `modes[]`, `rigid_modes[]`, `coordinates[]`.
Json modes_json(const modal::ModeTable& table);

/// `matrices`: M, K, C of the model asked for and of the rigid one, row by row.
Json matrices_json(const modal::ModeTable& table);

/// A 6×6 response over frequency: `omega_rad_s[]`, `frequency_hz[]`, `response[output][input]` with
/// `re[]` and `im[]`.
Json response_json(const std::vector<double>& omega, const std::vector<response::Matrix6c>& H);

Json peaks_json(const std::vector<response::Peak>& peaks, const modal::ModeTable& table,
                bool rigid);

/// "2 % of critical in every mode (default, the machine file gives no damping)".
std::string damping_text(const model::Machine& machine);

/// "gravity 9.81 m/s² downwards", "no gravity".
std::string gravity_text(const model::Machine& machine);

}  // namespace hydrapod::report
