#pragma once
/// Variables of MATLAB 7.3 files: HDF5 datasets with the attributes that MATLAB looks for.

#include <string>
#include <vector>

#include "hdf5_handle.hpp"

namespace hydrapod::data {

inline constexpr unsigned mat73_userblock_bytes = 512;

/// All return false when HDF5 could not write.
bool mat73_class(hid_t dataset, const char* name);
bool mat73_text(hid_t group, const char* name, const std::string& text);
bool mat73_numbers(hid_t group, const char* name, const std::vector<double>& values);
/// A cell array of texts, which stand in the group "#refs#".
bool mat73_texts(hid_t root, const char* name, const std::vector<std::string>& texts);
/// The text by which MATLAB knows the file; `path` must be closed.
bool write_mat73_userblock(const std::string& path);

}  // namespace hydrapod::data
