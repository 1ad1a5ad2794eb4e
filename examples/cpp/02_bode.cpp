// Resonances of the Bode diagram, 10 mm above the neutral pose: 02_bode machine.toml
#include <cstdio>
#include <hydrapod/hydrapod.hpp>
using namespace hydrapod;

int main(int count, char** arguments) {
  if (count < 2) return 2;
  const auto machine = tasks::read_machine({.file = arguments[1], .pose = "z=10 mm"});
  for (const auto& peak : tasks::bode(machine, {.points = 200}).real_peaks)
    std::printf("%-2s %8.3f Hz %9.2e\n", spatial::direction_name(peak.direction),
                peak.omega / base::two_pi, peak.magnitude);
}
