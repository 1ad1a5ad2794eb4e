/// Any text as a sensor of the test rig: an InputError or numbers that are sound. The first byte
/// selects what is read.

#include <cmath>

#include "fuzz.hpp"
#include "hydrapod/rig/rig.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hydrapod;
  if (size == 0) return 0;
  const std::string text = fuzz::text_of(data + 1, size - 1);
  fuzz::accepted([&] {
    if (data[0] % 2 == 0) {
      const auto sensor = rig::parse_sensor("--length-sensor", text, "m");
      if (!(sensor.resolution >= 0.0) || !(sensor.noise >= 0.0)) std::abort();
    } else {
      const auto one = rig::parse_accelerometer(text);
      if (one.name.empty() || !one.p_P.allFinite() || one.e_P.norm() != 1.0) std::abort();
    }
  });
  return 0;
}
