/// Any bytes behind the first key of an RPC III file.

#include "record_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string bytes(128, '\0');
  bytes.replace(0, 6, "FORMAT");
  bytes.replace(32, 6, "BINARY");
  bytes.append(reinterpret_cast<const char*>(data), size);
  hydrapod::fuzz::read_as_record(bytes);
  return 0;
}
