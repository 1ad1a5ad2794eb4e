/// Records of hydrapod in the formats that it reads itself, damaged (record_recipe.hpp).

#include "record_recipe.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using enum hydrapod::data::RecordFormat;
  hydrapod::fuzz::write_damage_and_read(data, size,
                                        std::array{mat5, csv, uff, uff_ascii, rpc, rpc_short});
  return 0;
}
