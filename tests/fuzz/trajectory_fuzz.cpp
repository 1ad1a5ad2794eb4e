/// Any bytes as the file of a trajectory: an InputError, or points that ascend in time and can be
/// sampled.

#include <cmath>

#include "fuzz.hpp"
#include "hydrapod/signals/signals.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hydrapod;
  fuzz::accepted([&] {
    const auto trajectory = signals::parse_trajectory(
        fuzz::text_of(data, size), "motion.csv",
        size % 2 == 0 ? signals::displacement_units : signals::wrench_units);
    if (trajectory.times.empty() || trajectory.times.size() != trajectory.points.size())
      std::abort();
    for (std::size_t k = 0; k < trajectory.times.size(); ++k) {
      if (!std::isfinite(trajectory.times[k]) || !trajectory.points[k].allFinite()) std::abort();
      if (k > 0 && !(trajectory.times[k] > trajectory.times[k - 1])) std::abort();
    }
    signals::Signal signal;
    signal.form = trajectory;
    try {
      signals::Generator generator({signal}, 100.0);
      for (int k = 0; k < 100; ++k) generator.next();
    } catch (const std::invalid_argument&) {
    }
  });
  return 0;
}
