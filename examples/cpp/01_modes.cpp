// Modes of a machine: 01_modes machine.toml
#include <cstdio>
#include <hydrapod/hydrapod.hpp>
using namespace hydrapod;

int main(int count, char** arguments) {
  if (count < 2) return 2;
  const auto machine = tasks::read_machine({.file = arguments[1]});
  for (const auto& mode : tasks::modes(machine).real.modes)
    std::printf("%8.3f Hz  %s\n", mode.mode.omega / base::two_pi, mode.label.c_str());
}
