#include "hdf5_text.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>

namespace hydrapod::data {

namespace {

constexpr std::size_t most_attribute_bytes = 65536;  // HDF5's own limit for compact attributes

/// Fixed length, padded with zeros, UTF-8.
Hdf5Handle string_type(std::size_t length) {
  Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), std::max<std::size_t>(length, 1));
  H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  return type;
}

Hdf5Handle list_space(hsize_t count) { return {H5Screate_simple(1, &count, nullptr), H5Sclose}; }

bool write_scalar(hid_t object, const char* name, hid_t file_type, hid_t memory_type,
                  const void* value) {
  const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Handle attribute(
      H5Acreate2(object, name, file_type, space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  return attribute.ok() && H5Awrite(attribute.id(), memory_type, value) >= 0;
}

/// Texts one after the other, each padded to `length`.
std::string joined(const std::vector<std::string>& texts, std::size_t length) {
  std::string all(length * texts.size(), '\0');
  for (std::size_t i = 0; i < texts.size(); ++i) texts[i].copy(all.data() + i * length, length);
  return all;
}

/// Cut off at the padding: zeros, or blanks where the file pads with them.
std::string unpadded(const char* text, std::size_t length, hid_t type) {
  std::string value(text, strnlen(text, length));
  if (H5Tget_strpad(type) == H5T_STR_SPACEPAD) value.erase(value.find_last_not_of(' ') + 1);
  return value;
}

/// Reads strings of a dataset or attribute with `read`, which takes a memory type and a buffer.
template <typename Read>
std::optional<std::vector<std::string>> read_strings(const Hdf5Handle& type,
                                                     const Hdf5Handle& space,
                                                     std::size_t most_bytes, Read read) {
  if (!type.ok() || !space.ok() || H5Tget_class(type.id()) != H5T_STRING) return {};
  const hssize_t count = H5Sget_simple_extent_npoints(space.id());
  if (count < 1) return {};
  const auto n = static_cast<std::size_t>(count);
  std::vector<std::string> texts;
  if (H5Tis_variable_str(type.id()) > 0) {
    if (n > most_bytes / sizeof(char*)) return {};
    std::vector<char*> pointers(n, nullptr);
    const Hdf5Handle memory(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(memory.id(), H5T_VARIABLE);
    H5Tset_cset(memory.id(), H5Tget_cset(type.id()));
    if (read(memory.id(), pointers.data()) < 0) return {};
    for (const char* text : pointers) texts.emplace_back(text == nullptr ? "" : text);
    H5Dvlen_reclaim(memory.id(), space.id(), H5P_DEFAULT, pointers.data());
    return texts;
  }
  const std::size_t length = H5Tget_size(type.id());
  if (length == 0 || length > most_bytes || n > most_bytes / length) return {};
  std::vector<char> buffer(n * length);
  if (read(type.id(), buffer.data()) < 0) return {};
  for (std::size_t i = 0; i < n; ++i)
    texts.push_back(unpadded(buffer.data() + i * length, length, type.id()));
  return texts;
}

bool is_open_here(const std::string& path) {
  std::vector<hid_t> files(
      static_cast<std::size_t>(std::max<ssize_t>(H5Fget_obj_count(H5F_OBJ_ALL, H5F_OBJ_FILE), 0)));
  const ssize_t count = H5Fget_obj_ids(H5F_OBJ_ALL, H5F_OBJ_FILE, files.size(), files.data());
  files.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  return std::ranges::any_of(files, [&](hid_t file) {
    std::array<char, 4096> name{};
    std::error_code none;
    return H5Fget_name(file, name.data(), name.size()) > 0 &&
           std::filesystem::equivalent(name.data(), path, none);
  });
}

Hdf5Handle open_attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return {};
  return {H5Aopen(object, name, H5P_DEFAULT), H5Aclose};
}

}  // namespace

Hdf5Handle dataset_without_times() {
  Hdf5Handle list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(list.id(), false);
  return list;
}

Hdf5Handle group_without_times(hid_t where, const char* name) {
  const Hdf5Handle list(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  H5Pset_obj_track_times(list.id(), false);
  return {H5Gcreate2(where, name, H5P_DEFAULT, list.id(), H5P_DEFAULT), H5Gclose};
}

Hdf5Handle open_to_read(const std::string& path) {
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  if (is_open_here(path)) {
    H5Pset_fapl_stdio(access.id());  // files of another driver are other files
    H5Pset_file_locking(access.id(), false, true);
  }
  return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose};
}

Hdf5Handle within_this_file(hid_t kind) {
  constexpr H5L_elink_traverse_t refuse = [](const char* /*file*/, const char* /*group*/,
                                             const char* /*other_file*/, const char* /*object*/,
                                             unsigned* /*flags*/, hid_t /*access*/,
                                             void* /*data*/) -> herr_t { return -1; };
  Hdf5Handle list(H5Pcreate(kind), H5Pclose);
  if (H5Pset_elink_cb(list.id(), refuse, nullptr) < 0) return {};
  return list;
}

bool write_attribute(hid_t object, const char* name, const std::string& text) {
  const Hdf5Handle type = string_type(text.size());
  return write_scalar(object, name, type.id(), type.id(), text.c_str());
}

bool write_text_attribute(hid_t object, const char* name, const std::string& text) {
  const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), H5T_VARIABLE);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  const char* const first = text.c_str();
  return write_scalar(object, name, type.id(), type.id(), &first);
}

bool rewrite_attribute(hid_t object, const char* name, const std::string& text) {
  const Hdf5Handle attribute = open_attribute(object, name);
  return attribute.ok() &&
         H5Awrite(attribute.id(), string_type(text.size()).id(), text.c_str()) >= 0;
}

bool write_attribute(hid_t object, const char* name, double value) {
  return write_scalar(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

bool write_attribute(hid_t object, const char* name, int value) {
  return write_scalar(object, name, H5T_STD_I32LE, H5T_NATIVE_INT, &value);
}

Hdf5Handle write_set(hid_t group, const char* name, hid_t file_type, hid_t memory_type,
                     const Hdf5Handle& space, const void* values) {
  const Hdf5Handle list = dataset_without_times();
  Hdf5Handle set(
      H5Dcreate2(group, name, file_type, space.id(), H5P_DEFAULT, list.id(), H5P_DEFAULT),
      H5Dclose);
  // what is small goes to a buffer, which is written where the handle is closed and nobody asks
  const bool good = set.ok() &&
                    H5Dwrite(set.id(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0 &&
                    H5Dflush(set.id()) >= 0;
  return good ? std::move(set) : Hdf5Handle();
}

bool write_text(hid_t group, const char* name, const std::string& text) {
  const Hdf5Handle type = string_type(text.size());
  return write_set(group, name, type.id(), type.id(), {H5Screate(H5S_SCALAR), H5Sclose},
                   text.c_str())
      .ok();
}

bool write_list(hid_t group, const char* name, const std::vector<std::string>& texts) {
  std::size_t length = 1;
  for (const auto& text : texts) length = std::max(length, text.size());
  const Hdf5Handle type = string_type(length);
  return write_set(group, name, type.id(), type.id(), list_space(texts.size()),
                   joined(texts, length).data())
      .ok();
}

bool write_list(hid_t group, const char* name, const std::vector<int>& values) {
  return write_set(group, name, H5T_STD_I32LE, H5T_NATIVE_INT, list_space(values.size()),
                   values.data())
      .ok();
}

std::vector<std::string> read_texts_attribute(hid_t object, const char* name) {
  const Hdf5Handle attribute = open_attribute(object, name);
  if (!attribute.ok()) return {};
  const Hdf5Handle type(H5Aget_type(attribute.id()), H5Tclose);
  const Hdf5Handle space(H5Aget_space(attribute.id()), H5Sclose);
  if (H5Sget_simple_extent_npoints(space.id()) < 1) return {};
  return read_strings(
             type, space, most_attribute_bytes,
             [&](hid_t memory, void* buffer) { return H5Aread(attribute.id(), memory, buffer); })
      .value_or(std::vector<std::string>{});
}

std::optional<std::string> read_text_attribute(hid_t object, const char* name) {
  const auto texts = read_texts_attribute(object, name);
  if (texts.size() != 1) return {};
  return texts.front();
}

std::string scale_attribute(hid_t dataset) {
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
  if (H5Tget_class(type.id()) != H5T_INTEGER) return "";
  for (const char* name : {"scale_factor", "scale", "gain", "slope", "add_offset"})
    if (open_attribute(dataset, name).ok()) return name;
  return "";
}

std::optional<double> read_number_attribute(hid_t object, const char* name) {
  const Hdf5Handle attribute = open_attribute(object, name);
  if (!attribute.ok()) return {};
  const Hdf5Handle type(H5Aget_type(attribute.id()), H5Tclose);
  const Hdf5Handle space(H5Aget_space(attribute.id()), H5Sclose);
  const auto kind = H5Tget_class(type.id());
  if ((kind != H5T_FLOAT && kind != H5T_INTEGER) || H5Sget_simple_extent_npoints(space.id()) != 1)
    return {};
  double value = 0.0;
  if (H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, &value) < 0) return {};
  return value;
}

std::optional<std::vector<std::string>> read_texts(hid_t dataset, std::size_t most_bytes) {
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  return read_strings(type, space, most_bytes, [&](hid_t memory, void* buffer) {
    return H5Dread(dataset, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer);
  });
}

std::uint64_t chunk_bytes(hid_t dataset) {
  const Hdf5Handle list(H5Dget_create_plist(dataset), H5Pclose);
  if (H5Pget_layout(list.id()) != H5D_CHUNKED) return 0;
  std::array<hsize_t, H5S_MAX_RANK> chunk{};
  const int rank = H5Pget_chunk(list.id(), H5S_MAX_RANK, chunk.data());
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
  std::uint64_t bytes = std::max<std::size_t>(H5Tget_size(type.id()), 1);
  for (int i = 0; i < rank; ++i) {
    const hsize_t size = chunk[static_cast<std::size_t>(i)];
    if (size != 0 && bytes > (std::uint64_t{1} << 60U) / size) return std::uint64_t{1} << 60U;
    bytes *= size;
  }
  return bytes;
}

std::string why_not_read(hid_t dataset) {
  const Hdf5Handle list(H5Dget_create_plist(dataset), H5Pclose);
  if (!list.ok()) return "cannot be opened";
  if (H5Pget_external_count(list.id()) != 0) return "keeps its numbers in another file";
  if (H5Pget_layout(list.id()) == H5D_VIRTUAL) return "is put together from other datasets";
  for (int k = 0; k < H5Pget_nfilters(list.id()); ++k) {
    unsigned flags = 0, settings = 0;
    std::size_t values = 0;
    std::array<char, 64> name{};
    const H5Z_filter_t filter = H5Pget_filter2(list.id(), static_cast<unsigned>(k), &flags, &values,
                                               nullptr, name.size() - 1, name.data(), &settings);
    const bool known = filter > H5Z_FILTER_NONE && filter <= H5Z_FILTER_SCALEOFFSET;
    if (!known || H5Zfilter_avail(filter) <= 0)
      return "has the filter " + std::to_string(filter) +
             ", which HDF5 itself does not have "
             "(h5repack -f GZIP=4 IN OUT writes the file without it)";
  }
  return "";
}

std::uint64_t working_set(hid_t dataset) {
  const Hdf5Handle list(H5Dget_create_plist(dataset), H5Pclose);
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  std::array<hsize_t, 2> chunk{1, 1}, size{1, 1};
  if (H5Pget_layout(list.id()) != H5D_CHUNKED || H5Pget_nfilters(list.id()) < 1) return 0;
  if (H5Sget_simple_extent_ndims(space.id()) > 2 || H5Pget_chunk(list.id(), 2, chunk.data()) < 1 ||
      H5Sget_simple_extent_dims(space.id(), size.data(), nullptr) < 0 || chunk[0] == 0 ||
      chunk[1] == 0)
    return chunk_bytes(dataset);
  if (size[0] == 0 || size[1] == 0) return 0;
  const bool lists = H5Sget_simple_extent_ndims(space.id()) < 2;
  const bool channels_are_rows = size[0] < size[1];
  const hsize_t beside = lists               ? 1
                         : channels_are_rows ? (size[0] - 1) / chunk[0] + 1
                                             : (size[1] - 1) / chunk[1] + 1;
  constexpr std::uint64_t beyond = std::uint64_t{1} << 60U;
  const std::uint64_t one = chunk_bytes(dataset);
  return one == 0 || beside > beyond / one ? beyond : beside * one;
}

std::uint64_t believable_rows(hid_t dataset, std::uint64_t rows, std::uint64_t columns) {
  const Hdf5Handle list(H5Dget_create_plist(dataset), H5Pclose);
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
  const std::uint64_t row_bytes = columns * std::max<std::size_t>(H5Tget_size(type.id()), 1);
  if (row_bytes == 0) return 0;
  if (H5Pget_layout(list.id()) != H5D_CHUNKED)
    return std::min<std::uint64_t>(rows, H5Dget_storage_size(dataset) / row_bytes);
  std::array<hsize_t, 2> chunk{1, 1};
  hsize_t chunks = 0;
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  const int rank = H5Pget_chunk(list.id(), 2, chunk.data());
  if (rank < 1 || rank > 2 || chunk[0] == 0 || chunk[1] == 0 ||
      H5Dget_num_chunks(dataset, space.id(), &chunks) < 0)
    return 0;
  const std::uint64_t side_by_side = (columns + chunk[1] - 1) / chunk[1];
  const std::uint64_t stacked = (chunks + side_by_side - 1) / side_by_side;
  if (stacked > rows / chunk[0]) return rows;
  return std::min<std::uint64_t>(rows, stacked * chunk[0]);
}

std::uint64_t believable_numbers(hid_t dataset) {
  const Hdf5Handle list(H5Dget_create_plist(dataset), H5Pclose);
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
  const std::uint64_t bytes = std::max<std::size_t>(H5Tget_size(type.id()), 1);
  if (H5Pget_layout(list.id()) != H5D_CHUNKED) return H5Dget_storage_size(dataset) / bytes;
  hsize_t chunks = 0;
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  if (H5Dget_num_chunks(dataset, space.id(), &chunks) < 0) return 0;
  return chunks * (chunk_bytes(dataset) / bytes);
}

std::uint64_t most_packed(hid_t dataset, std::uint64_t file_bytes) {
  const Hdf5Handle list(H5Dget_create_plist(dataset), H5Pclose);
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
  const bool packed = H5Pget_nfilters(list.id()) > 0;
  return (packed ? 1100 : 1) * file_bytes / std::max<std::size_t>(H5Tget_size(type.id()), 1);
}

bool has_object(hid_t group, const char* name) {
  return H5Lexists(group, name, H5P_DEFAULT) > 0 && H5Oexists_by_name(group, name, H5P_DEFAULT) > 0;
}

}  // namespace hydrapod::data
