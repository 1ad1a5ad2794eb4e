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
  return {{.name = "payload (platform mass)",
           .statement = "the platform with its payload is not as heavy as stated",
           .family = "platform",
           .free = {mass}},
          {.name = "payload with a height of its own",
           .statement = "the payload is not as heavy as stated, and not as high",
           .family = "platform",
           .free = {mass, near("platform.mass_center[2]", stated.mass_center[2], reach)},
           .in_pairs = false},
          {.name = "platform inertia",
           .statement = "the platform's moments of inertia are not as stated",
           .family = "platform",
           .free = moments(stated)},
          {.name = "platform mass and inertia",
           .statement = "the platform's mass and moments of inertia are not as stated",
           .family = "platform",
           .free = both}};
}

}  // namespace hydrapod::diagnosis
