/// Any bytes as a record, in whatever format they claim to be: an InputError or a record whose
/// header holds, read to its end in bounded memory. Formats that HDF5 reads are left to
/// hdf5_record_fuzz.

#include "record_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  constexpr std::string_view signature{"\x89HDF", 4};
  if (text.find(signature) != std::string::npos) return 0;
  hydrapod::fuzz::read_as_record(text);
  return 0;
}
