// Oil that swings in the lines with the pistons: inertia along the legs.
#include "around.hpp"

namespace hydrapod::diagnosis {

std::vector<Suspect> oil_lines(const model::MachineFile& file) {
  constexpr double least = 1e-4, most = 0.5;  // of the platform's mass, per leg
  const double mass = file.machine.platform.mass;
  const double stated = file.machine.legs[0].added_axial_inertia;
  const double start = std::max(stated, 10.0 * least * mass);
  std::vector<std::string> begin;
  if (start != stated) begin = {fmt::format("legs.added_axial_inertia={:.17g}", start)};
  return {{.name = "oil in the lines",
           .statement = "the oil in the lines adds inertia to the pistons",
           .family = "oil lines",
           .free = {{.paths = {"legs.added_axial_inertia"},
                     .start = fmt::format("{:.17g}", start),
                     .lower = fmt::format("{:.17g}", least * mass),
                     .upper = fmt::format("{:.17g}", most * mass)}},
           .overrides = begin}};
}

}  // namespace hydrapod::diagnosis
