/// Records of hydrapod in HDF5, its own layout and MATLAB 7.3, damaged (record_recipe.hpp).

#include "record_recipe.hpp"

/// HDF5 leaks what it had read of a file that it then refuses.
extern "C" int __lsan_is_turned_off() { return 1; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using enum hydrapod::data::RecordFormat;
  hydrapod::fuzz::write_damage_and_read(data, size, std::array{hdf5, mat73});
  return 0;
}
