#include "mat73_text.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <cstring>

#include "hdf5_text.hpp"
#include "hydrapod/base/version.hpp"
#include "unicode.hpp"

namespace hydrapod::data {

namespace {

/// One row of `count` items; MATLAB's first index is HDF5's last.
Hdf5Handle row(std::size_t count) {
  const hsize_t size[2] = {count, 1};
  return {H5Screate_simple(2, size, nullptr), H5Sclose};
}

/// HDF5 has no empty datasets of MATLAB's kind: their size stands where the data would.
bool write_empty_text(hid_t group, const char* name) {
  const hsize_t two = 2;
  const std::uint64_t size[2] = {0, 0};
  const auto set = write_set(group, name, H5T_STD_U64LE, H5T_NATIVE_UINT64,
                             {H5Screate_simple(1, &two, nullptr), H5Sclose}, size);
  return set.ok() && mat73_class(set.id(), "char") && write_attribute(set.id(), "MATLAB_empty", 1);
}

}  // namespace

/// ASCII, as MATLAB writes it; matio takes no other.
bool mat73_class(hid_t dataset, const char* name) {
  const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), std::strlen(name));
  const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Handle attribute(
      H5Acreate2(dataset, "MATLAB_class", type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  return attribute.ok() && H5Awrite(attribute.id(), type.id(), name) >= 0;
}

bool mat73_text(hid_t group, const char* name, const std::string& text) {
  if (text.empty()) return write_empty_text(group, name);
  const std::u16string units = utf16_from(text);
  const auto set =
      write_set(group, name, H5T_STD_U16LE, H5T_NATIVE_UINT16, row(units.size()), units.data());
  return set.ok() && mat73_class(set.id(), "char") &&
         write_attribute(set.id(), "MATLAB_int_decode", 2);
}

bool mat73_numbers(hid_t group, const char* name, const std::vector<double>& values) {
  const auto set =
      write_set(group, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, row(values.size()), values.data());
  return set.ok() && mat73_class(set.id(), "double");
}

bool mat73_texts(hid_t root, const char* name, const std::vector<std::string>& texts) {
  constexpr const char* references = "#refs#";
  Hdf5Handle group;
  if (has_object(root, references))
    group = {H5Gopen2(root, references, H5P_DEFAULT), H5Gclose};
  else
    group = group_without_times(root, references);
  std::vector<hobj_ref_t> list;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const std::string item = fmt::format("{}_{}", name, i + 1);
    hobj_ref_t reference{};
    if (!mat73_text(group.id(), item.c_str(), texts[i]) ||
        H5Rcreate(&reference, group.id(), item.c_str(), H5R_OBJECT, -1) < 0)
      return false;
    list.push_back(reference);
  }
  const auto set =
      write_set(root, name, H5T_STD_REF_OBJ, H5T_STD_REF_OBJ, row(list.size()), list.data());
  return set.ok() && mat73_class(set.id(), "cell");
}

bool write_mat73_userblock(const std::string& path) {
  std::string text =
      fmt::format("MATLAB 7.3 MAT-file, Platform: GLNXA64, Created by: hydrapod {}", base::version);
  text.resize(116, ' ');
  text += std::string(8, '\0') + std::string("\0\2IM", 4);
  std::FILE* file = std::fopen(path.c_str(), "r+b");
  if (file == nullptr) return false;
  const bool good = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  return std::fclose(file) == 0 && good;
}

}  // namespace hydrapod::data
