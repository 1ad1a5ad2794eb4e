/// Any bytes as a list of modes that calibrate and diagnose read: CSV where the first byte is even,
/// else TOML. What was accepted is sound: frequencies and deviations are positive and finite.

#include <cmath>

#include "fuzz.hpp"
#include "hydrapod/calibration/calibrate.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hydrapod;
  if (size == 0) return 0;
  const std::string text = fuzz::text_of(data + 1, size - 1);
  fuzz::accepted([&] {
    const auto file =
        calibration::parse_targets(text, data[0] % 2 == 0 ? "targets.csv" : "targets.toml");
    for (const auto& mode : file.targets.modes) {
      if (!std::isfinite(mode.omega) || !(mode.omega > 0.0)) std::abort();
      if (!std::isfinite(mode.deviation) || !(mode.deviation > 0.0)) std::abort();
      if (mode.shape && !mode.shape->allFinite()) std::abort();
      if (mode.direction && (*mode.direction < 0 || *mode.direction > 5)) std::abort();
    }
  });
  return 0;
}
