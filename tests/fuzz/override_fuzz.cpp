/// No `--set PATH=VALUE` crashes or hangs the reader, laid over a sound file.

#include <cstddef>
#include <cstdint>
#include <string>

#include "hydrapod/base/error.hpp"
#include "hydrapod/model/machine_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string sound = hydrapod::model::starter_machine_file();
  const std::string override(reinterpret_cast<const char*>(data), size);
  try {
    hydrapod::model::parse_machine(sound, "fuzz.toml", {override});
  } catch (const hydrapod::base::InputError&) {
  }
  return 0;
}
