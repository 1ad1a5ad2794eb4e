#pragma once
/// Modes of a machine from whatever holds them: a list (TOML, CSV), JSON of `hydrapod identify`,
/// frequency responses (JSON of `hydrapod frf`, Universal File), or records.

#include <string>

#include "hydrapod/calibration/targets.hpp"
#include "hydrapod/machine_arguments.hpp"

namespace hydrapod::cli {

/// `machine` stands at `pose`, one of its own, in records, responses and identified modes; lists
/// say it themselves. Progress and warnings go to stderr. Throws base::InputError and
/// base::ComputationError.
calibration::Targets read_measured(const std::string& path, const MachineArguments& arguments,
                                   const model::MachineFile& machine, const std::string& pose);

}  // namespace hydrapod::cli
