// The O-rings under the step seals: softer or stiffer than stated, in all legs or in one.
#include "around.hpp"

namespace hydrapod::diagnosis {

std::vector<Suspect> guide_sleeves(const model::MachineFile& file) {
  constexpr double factor = 1e4;  // who calculates with rigid legs may state anything
  const auto& legs = file.machine.legs;
  std::vector<Suspect> suspects{
      {.name = "guide sleeves of all legs",
       .statement = "the stiffness of the guide sleeves of all legs differs from the nominal value",
       .family = "guide sleeves",
       .free = {within("legs.guide_sleeve.stiffness", legs[0].guide_sleeve.stiffness, factor)}}};
  for (int i = 0; i < model::leg_count; ++i) {
    const double stated = legs[static_cast<std::size_t>(i)].guide_sleeve.stiffness;
    suspects.push_back(
        {.name = fmt::format("guide sleeve of leg {}", i + 1),
         .statement = fmt::format(
             "the stiffness of the guide sleeve of leg {} differs from the nominal value", i + 1),
         .family = "guide sleeves",
         .leg = i,
         .free = {within(leg_path(i, "guide_sleeve.stiffness"), stated, factor)}});
  }
  return suspects;
}

}  // namespace hydrapod::diagnosis
