#pragma once
/// Strings and numbers as HDF5 attributes and datasets, written and read with care for sizes.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hdf5_handle.hpp"

namespace hydrapod::data {

/// Objects without time stamps, so that equal records are equal files.
Hdf5Handle dataset_without_times();
Hdf5Handle group_without_times(hid_t where, const char* name);

/// All return false when HDF5 could not write.
bool write_attribute(hid_t object, const char* name, const std::string& text);
bool write_attribute(hid_t object, const char* name, double value);
bool write_attribute(hid_t object, const char* name, int value);
/// A scalar string.
bool write_text(hid_t group, const char* name, const std::string& text);
/// A list of strings, of integers.
bool write_list(hid_t group, const char* name, const std::vector<std::string>& texts);
bool write_list(hid_t group, const char* name, const std::vector<int>& values);
/// A dataset of that size, written whole; not ok() when HDF5 could not write.
Hdf5Handle write_set(hid_t group, const char* name, hid_t file_type, hid_t memory_type,
                     const Hdf5Handle& space, const void* values);

/// None where there is none, or where it is of another type or size than it can be: a declared size
/// beyond `most_bytes` is not believed.
std::optional<std::string> read_text_attribute(hid_t object, const char* name);
std::optional<double> read_number_attribute(hid_t object, const char* name);
std::optional<std::vector<std::string>> read_texts(hid_t dataset, std::size_t most_bytes);
/// Bytes of a chunk in memory; 0 for a dataset that has none.
std::uint64_t chunk_bytes(hid_t dataset);
/// Chunks larger than this are not taken into memory, whatever the file says.
inline constexpr std::uint64_t most_chunk_bytes = 256U << 20U;
/// Of the `rows` rows that a dataset of rows × columns declares, those for which there is anything
/// in the file.
std::uint64_t believable_rows(hid_t dataset, std::uint64_t rows, std::uint64_t columns);
bool has_object(hid_t group, const char* name);

}  // namespace hydrapod::data
