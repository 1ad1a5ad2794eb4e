// The platform and what stands on it.
#include "around.hpp"

namespace hydrapod::diagnosis {

namespace {
constexpr double most = 3.0;

std::vector<calibration::FreeParameter> moments(const model::Platform& platform) {
  const auto& I = platform.inertia;
  return {within("platform.inertia.xx", I(0, 0), most),
          within("platform.inertia.yy", I(1, 1), most),
          within("platform.inertia.zz", I(2, 2), most)};
}
}  // namespace

std::vector<Suspect> platform(const model::MachineFile& file) {
  const auto& stated = file.machine.platform;
  const auto mass = within("platform.mass", stated.mass, most);
  auto both = moments(stated);
  both.insert(both.begin(), mass);
  // a payload raises the centre with the mass, and where there is gravity presses on the knees
  const double reach = std::sqrt(stated.inertia.trace() / (3.0 * stated.mass));
  return {
      {.name = "payload (platform mass)",
       .statement = "the mass of platform and payload differs from the nominal mass",
       .family = "platform",
       .free = {mass}},
      {.name = "payload at another height",
       .statement = "mass and height of the payload differ from the nominal values",
       .family = "platform",
       .free = {mass, near("platform.mass_center[2]", stated.mass_center[2], reach)},
       .in_pairs = false},
      {.name = "platform inertia",
       .statement = "the moments of inertia of the platform differ from the nominal values",
       .family = "platform",
       .free = moments(stated)},
      {.name = "platform mass and inertia",
       .statement = "mass and moments of inertia of the platform differ from the nominal values",
       .family = "platform",
       .free = both}};
}

}  // namespace hydrapod::diagnosis
