/// Any bytes behind HDF5's signature, as hydrapod's own layout, MATLAB 7.3 or any other. What is
/// looked for is hydrapod's part: Debian's HDF5 is not built with sanitizers.

#include "record_fuzz.hpp"

/// HDF5 leaks what it had read of a file that it then refuses.
extern "C" int __lsan_is_turned_off() { return 1; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  hydrapod::fuzz::read_as_record({reinterpret_cast<const char*>(data), size});
  return 0;
}
