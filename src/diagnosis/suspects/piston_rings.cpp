// The O-rings under the glyd rings at the pistons: a third resonance in x and y.
#include "around.hpp"

namespace hydrapod::diagnosis {

std::vector<Suspect> piston_rings(const model::MachineFile& file) {
  // where the file has none they begin stiffer than the sleeves, as they are in cylinders
  constexpr double factor = 1000.0, stiffer = 10.0;
  const auto& leg = file.machine.legs[0];
  Suspect all{.name = "piston rings of all legs",
              .statement = "the piston rings of all legs are compliant",
              .family = "piston rings",
              .needs_rings = true};
  std::vector<Suspect> suspects;
  const double stated =
      leg.piston_ring ? leg.piston_ring->stiffness : stiffer * leg.guide_sleeve.stiffness;
  if (!leg.piston_ring) all.changes = {change(file, "legs.piston_ring.stiffness", stated)};
  all.free = {within("legs.piston_ring.stiffness", stated, factor)};
  // sleeves that are stated as good as rigid say nothing about the rings
  if (!leg.piston_ring) all.free[0].lower = 1000.0;
  suspects.push_back(all);
  if (!leg.piston_ring) return suspects;
  for (int i = 0; i < model::leg_count; ++i) {
    if (!file.machine.legs[static_cast<std::size_t>(i)].piston_ring) continue;
    suspects.push_back(
        {.name = fmt::format("piston ring of leg {}", i + 1),
         .statement = fmt::format(
             "the stiffness of the piston ring of leg {} differs from the nominal value", i + 1),
         .family = "piston rings",
         .leg = i,
         .free = {within(leg_path(i, "piston_ring.stiffness"),
                         file.machine.legs[static_cast<std::size_t>(i)].piston_ring->stiffness,
                         factor)},
         .needs_rings = true});
  }
  return suspects;
}

}  // namespace hydrapod::diagnosis
