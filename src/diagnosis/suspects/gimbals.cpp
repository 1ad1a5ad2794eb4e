// Gimbals and their fastening, which give way along the legs or have play; play shows as a softer
// spring, the softer the smaller the motion.
#include "around.hpp"
#include "hydrapod/hydraulics/oil_spring.hpp"

namespace hydrapod::diagnosis {

std::vector<Suspect> gimbals(const model::MachineFile& file) {
  constexpr double stiff = 30.0, factor = 1000.0;
  std::vector<Suspect> suspects;
  for (int i = -1; i < model::leg_count; ++i) {
    const auto& leg = file.machine.legs[static_cast<std::size_t>(std::max(i, 0))];
    const double l_m =
        kinematics::leg_lengths(file.machine, file.machine.neutral())[std::max(i, 0)] -
        leg.rod.length;
    const double k = leg.gimbal_stiffness.value_or(stiff * hydraulics::oil_stiffness(leg, l_m));
    const std::string path = i < 0 ? "legs.gimbal_stiffness" : leg_path(i, "gimbal_stiffness");
    Suspect suspect{
        .name = i < 0 ? "gimbals of all legs" : fmt::format("gimbals of leg {}", i + 1),
        .statement = i < 0 ? "the gimbals of all legs are compliant or have free play"
                           : fmt::format("a gimbal of leg {} is compliant or has free play", i + 1),
        .family = "leg axes",
        .free = {within(path, k, factor)},
        .in_pairs = false};
    if (i >= 0) suspect.leg = i;
    if (!leg.gimbal_stiffness) suspect.changes = {change(file, path, k)};
    suspects.push_back(suspect);
  }
  return suspects;
}

}  // namespace hydrapod::diagnosis
