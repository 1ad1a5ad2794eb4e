#pragma once
/// The machine that a record was taken on, at the pose of the record.

#include <optional>
#include <string>

#include "hydrapod/data/record.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/machine_arguments.hpp"

namespace hydrapod::cli {

/// An accelerometer of the record and where it sits.
struct PlacedSensor {
  std::string name{};      ///< of its channel
  spatial::Vector3 p_P{};  ///< in the platform frame [m]
  spatial::Vector3 e_P{};  ///< its axis, unit
};

/// What `hydrapod rig` notes of the machine besides its file, a line each: "test rig of hydrapod",
/// "pose: NAME", "model: KIND", "--set PATH=VALUE" and "sensor: NAME at=X Y Z along=X Y Z".
std::string rig_notes(const std::string& pose, dynamics::ModelKind kind,
                      const std::vector<std::string>& overrides,
                      const std::vector<PlacedSensor>& sensors);

/// The sensors whose places the notes of `header` tell.
std::vector<PlacedSensor> placed_sensors(const data::RecordHeader& header);

/// Was it written by `hydrapod rig`, whose machine is under its controller?
bool is_rig_record(const data::RecordHeader& header);

struct RecordMachine {
  std::string name{};  ///< of the file, as messages call it
  model::MachineFile file{};
  model::NamedPose pose{};
  dynamics::ModelKind kind{};
};

/// --machine, else the machine file in the record (`header`) with what its notes say; `pose` and
/// `kind` in words, empty: as noted, else neutral and what the file describes. None where there is
/// no machine. Throws base::InputError.
std::optional<RecordMachine> record_machine(const data::RecordHeader* header,
                                            const std::string& record, const std::string& machine,
                                            const std::string& pose, const std::string& kind);

}  // namespace hydrapod::cli
