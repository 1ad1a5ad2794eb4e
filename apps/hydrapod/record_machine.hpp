#pragma once
/// The machine that a record was taken on, at the pose of the record.

#include <optional>
#include <string>

#include "hydrapod/data/record.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/machine_arguments.hpp"

namespace hydrapod::cli {

/// The part of an experiment that simulation and test rig have in common.
data::Experiment experiment_of(const model::MachineFile& file, const report::PoseChoice& pose,
                               dynamics::ModelKind kind, std::uint64_t seed);

struct RecordMachine {
  std::string name{};  ///< of the file, as messages call it
  model::MachineFile file{};
  model::NamedPose pose{};
  dynamics::ModelKind kind{};
};

/// --machine, else the machine file of the `experiment` of a record, with its overrides; `pose` and
/// `kind` in words, empty: as in the experiment, else neutral and what the file describes. None
/// where there is no machine. Throws base::InputError.
std::optional<RecordMachine> record_machine(const data::Experiment* experiment,
                                            const std::string& record, const std::string& machine,
                                            const std::string& pose, const std::string& kind);

}  // namespace hydrapod::cli
