#pragma once
/// Modes of a machine from whatever holds them: a list (TOML, CSV), JSON of `hydrapod identify`,
/// frequency responses (JSON of `hydrapod frf`, Universal File), or records.

#include <string>
#include <vector>

#include "hydrapod/machine_arguments.hpp"
#include "hydrapod/observation/targets.hpp"

namespace hydrapod::cli {

/// `files`: each may say its pose, `FILE@POSE`, by its name in the machine file; else `machine`
/// stands at `pose`, one of its own, in records, responses and identified modes; lists say it
/// themselves. Responses are read beside their modes. `against`: the system that was measured,
/// "mechanics", "plant", "system" or "auto". Progress and warnings go to stderr. At least one file.
/// Throws base::InputError and base::ComputationError.
observation::Targets read_measured(const std::vector<std::string>& files,
                                   const MachineArguments& arguments,
                                   const model::MachineFile& machine, const std::string& pose,
                                   const std::string& against);

}  // namespace hydrapod::cli
