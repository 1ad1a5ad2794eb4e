// The mass centre of platform and payload.
#include "around.hpp"

namespace hydrapod::diagnosis {

std::vector<Suspect> mass_center(const model::MachineFile& file) {
  const auto& platform = file.machine.platform;
  // a radius of gyration to every side
  const double reach = std::sqrt(platform.inertia.trace() / (3.0 * platform.mass));
  Suspect suspect{.name = "mass centre",
                  .statement = "the mass centre differs from the nominal position",
                  .family = "mass centre"};
  for (int k = 0; k < 3; ++k)
    suspect.free.push_back(
        near(fmt::format("platform.mass_center[{}]", k), platform.mass_center[k], reach));
  return {suspect};
}

}  // namespace hydrapod::diagnosis
