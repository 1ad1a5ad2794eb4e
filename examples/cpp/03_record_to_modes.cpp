// Modes of a record with their 95 % intervals: 03_record_to_modes run.h5
#include <cstdio>
#include <hydrapod/hydrapod.hpp>
using namespace hydrapod;

int main(int count, char** arguments) {
  if (count < 2) return 2;
  for (const auto& mode : tasks::identify({.measure = {.files = {arguments[1]}}}).modes.modes)
    std::printf("%8.3f Hz +- %.3f, damping %.2f %%\n", mode.fit.omega() / base::two_pi,
                1.96 * mode.fit.omega_deviation / base::two_pi, 100.0 * mode.fit.damping_ratio());
}
