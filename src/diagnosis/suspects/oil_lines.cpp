// Oil that swings in the lines with the pistons: inertia along the legs.
#include "around.hpp"

namespace hydrapod::diagnosis {

std::vector<Suspect> oil_lines(const model::MachineFile& file) {
  constexpr double least = 1e-4, most = 0.5;  // of the platform's mass, per leg
  const double mass = file.machine.platform.mass;
  const double stated = file.machine.legs[0].added_axial_inertia;
  const double start = std::max(stated, 10.0 * least * mass);
  std::vector<model::Assignment> begin;
  if (start != stated) begin = {change(file, "legs.added_axial_inertia", start)};
  return {{.name = "oil in the lines",
           .statement = "the oil in the lines adds inertia to the pistons",
           .family = "oil lines",
           .free = {{.paths = {"legs.added_axial_inertia"},
                     .start = start,
                     .lower = least * mass,
                     .upper = most * mass}},
           .changes = begin}};
}

}  // namespace hydrapod::diagnosis
