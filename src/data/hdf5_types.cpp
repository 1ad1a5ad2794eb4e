#include "hdf5_types.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "channel_units.hpp"
#include "hdf5_text.hpp"

namespace hydrapod::data {

bool is_numeric(hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  return kind == H5T_FLOAT || kind == H5T_INTEGER || kind == H5T_ENUM ||
         (kind == H5T_BITFIELD && H5Tget_size(type) == 1);
}

std::string member_name(hid_t type, unsigned member) {
  char* name = H5Tget_member_name(type, member);
  const std::string text = name == nullptr ? "" : clean_text(name);
  H5free_memory(name);
  return text;
}

bool is_complex(hid_t type) {
  if (H5Tget_class(type) != H5T_COMPOUND || H5Tget_nmembers(type) != 2 ||
      H5Tget_member_class(type, 0) != H5T_FLOAT || H5Tget_member_class(type, 1) != H5T_FLOAT)
    return false;
  const std::pair names{member_name(type, 0), member_name(type, 1)};
  return names == std::pair<std::string, std::string>("r", "i") ||
         names == std::pair<std::string, std::string>("re", "im") ||
         names == std::pair<std::string, std::string>("real", "imag");
}

std::vector<std::uint64_t> sizes_of(hid_t set) {
  const Hdf5Handle space(H5Dget_space(set), H5Sclose);
  std::array<hsize_t, H5S_MAX_RANK> size{};
  const int rank = H5Sget_simple_extent_dims(space.id(), size.data(), nullptr);
  return {size.rend() - std::max(rank, 0), size.rend()};
}

std::string unit_of(hid_t set) {
  return read_text_attribute(set, "unit").value_or(read_text_attribute(set, "units").value_or(""));
}

}  // namespace hydrapod::data
