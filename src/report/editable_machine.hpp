#pragma once
/// The machine as the page's core takes it (web/core): numbers, no text to be read again.
///
/// The core has the parameter table, the mechanics and all checks, but neither the reader of machine
/// files nor the database of units. It gets every number that the machine holds under its row of the
/// table, so that the machine there is the same bit by bit, whichever way it was made here (a file,
/// overrides, a fit). Private to the module.

#include "hydrapod/report/json.hpp"

namespace hydrapod::report {

/// {
///   "numbers": { PATH: [of leg, pose or machine][element] },  null where the machine holds none
///   "words":   { PATH: [number of the word] },                other than the first one
///   "poses":   [{ "name", "position", "rotation" }],          those of the machine
///   "shown":   [{ "name", "of": number of the pose or null, "position", "rotation" }]
///              with `of` null: displacement from the neutral pose
///   "own":     { PATH: legs of the mask that have no value of their own }
///   "units":   { PATH: { "name", "size" } }                   as the machine file writes them
///   "scales":  { SI unit: { "kN/mm": 1e6 } }                  units in which a value may be typed
///   "model":   "rigid", "guide" or "full"
/// }
Json editable_json(const model::MachineFile& file, const std::vector<model::NamedPose>& shown,
                   dynamics::ModelKind kind);

}  // namespace hydrapod::report
