#pragma once
/// HDF5's C interface with owners for its handles; strings and numbers as attributes and datasets,
/// written and read with care for sizes. HDF5's own error output is silenced: callers say what went
/// wrong.

#include <hdf5.h>

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hydrapod::data {

/// Owns one HDF5 identifier; `close` is the function that gives it back.
class Hdf5Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Hdf5Handle() = default;
  Hdf5Handle(hid_t id, Close close) : id_(id), close_(close) {}
  Hdf5Handle(Hdf5Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
    if (this != &other) {
      reset();
      id_ = std::exchange(other.id_, H5I_INVALID_HID);
      close_ = other.close_;
    }
    return *this;
  }
  ~Hdf5Handle() { reset(); }

  [[nodiscard]] hid_t id() const { return id_; }
  [[nodiscard]] bool ok() const { return id_ >= 0; }
  /// Leaves the identifier to the end of the program, unclosed.
  void abandon() { id_ = H5I_INVALID_HID; }
  /// True when closing went well (buffers are written then).
  bool reset() {
    const hid_t id = std::exchange(id_, H5I_INVALID_HID);
    return id < 0 || close_(id) >= 0;
  }

 private:
  hid_t id_{H5I_INVALID_HID};
  Close close_{};
};

/// No messages of HDF5 on stderr while it lives.
class Hdf5Silence {
 public:
  Hdf5Silence() {
    // Nothing is left to the end of the program: there HDF5 crashes over a file that a full disk
    // has kept it from closing.
    [[maybe_unused]] static const herr_t once = H5dont_atexit();
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  Hdf5Silence(const Hdf5Silence&) = delete;
  Hdf5Silence& operator=(const Hdf5Silence&) = delete;
  ~Hdf5Silence() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

 private:
  H5E_auto2_t function_{};
  void* data_{};
};

/// Held by whoever calls HDF5 in this process, which Debian's HDF5 does not lock by itself, and
/// while a process is forked that is to use it.
class Hdf5Lock {
 public:
  Hdf5Lock() : lock_(all()) {}

 private:
  static std::mutex& all() {
    static std::mutex one;
    return one;
  }
  std::lock_guard<std::mutex> lock_;
};

/// Objects without time stamps, so that equal records are equal files.
Hdf5Handle dataset_without_times();
Hdf5Handle group_without_times(hid_t where, const char* name);

/// A file to read from. One that a writer of this program has open is opened beside it: HDF5 would
/// else go on with the writer's descriptor, which a process that was forked does not have.
Hdf5Handle open_to_read(const std::string& path);

/// Properties for access by name that follows no link into another file, also where the way of a
/// soft link leads through one. `kind` is H5P_LINK_ACCESS, H5P_GROUP_ACCESS or H5P_DATASET_ACCESS.
Hdf5Handle within_this_file(hid_t kind);

/// All return false when HDF5 could not write.
bool write_attribute(hid_t object, const char* name, const std::string& text);
/// The same of variable length, which h5py and MATLAB read as text.
bool write_text_attribute(hid_t object, const char* name, const std::string& text);
bool write_attribute(hid_t object, const char* name, double value);
bool write_attribute(hid_t object, const char* name, int value);
/// Over what stands there, which is as long.
bool rewrite_attribute(hid_t object, const char* name, const std::string& text);
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
std::vector<std::string> read_texts_attribute(hid_t object, const char* name);
std::optional<double> read_number_attribute(hid_t object, const char* name);
/// The attribute of a dataset of integers that says what they count, such as scale_factor; empty if
/// there is none.
std::string scale_attribute(hid_t dataset);
std::optional<std::vector<std::string>> read_texts(hid_t dataset, std::size_t most_bytes);
/// Why a dataset is not read, for a message ("keeps its numbers in another file"): its numbers are
/// not in this file, or it has a filter that HDF5 itself does not have. Empty: it is read.
std::string why_not_read(hid_t dataset);
/// Bytes of the chunks that must be in memory so that a filtered dataset is read from front to back
/// with each chunk unpacked once; 0 where it has no filters.
std::uint64_t working_set(hid_t dataset);
/// Bytes of a chunk in memory; 0 for a dataset that has none.
std::uint64_t chunk_bytes(hid_t dataset);
/// Chunks larger than this are not taken into memory, whatever the file says.
inline constexpr std::uint64_t most_chunk_bytes = 256U << 20U;
/// Of the `rows` rows that a dataset of rows × columns declares, those for which there is anything
/// in the file.
std::uint64_t believable_rows(hid_t dataset, std::uint64_t rows, std::uint64_t columns);
/// Of a dataset of any rank, as many numbers as there can be in the file.
std::uint64_t believable_numbers(hid_t dataset);
/// Of the dataset's numbers, how many a file of so many bytes holds at most: 1100 times as many
/// where they are packed, as deflate cannot do better than 1032 to 1.
std::uint64_t most_packed(hid_t dataset, std::uint64_t file_bytes);
bool has_object(hid_t group, const char* name);

}  // namespace hydrapod::data
