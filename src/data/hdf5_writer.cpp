#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "formats.hpp"
#include "hdf5_text.hpp"
#include "hydrapod/base/version.hpp"
#include "out_stream.hpp"
#include "unicode.hpp"

namespace hydrapod::data {

namespace {

constexpr unsigned mat73_userblock_bytes = 512;

// Variables of MATLAB 7.3 files: HDF5 datasets with the attributes that MATLAB looks for. All
// functions return false when HDF5 could not write.

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

/// A cell array of texts, which stand in the group "#refs#".
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

/// The text by which MATLAB knows the file; `path` must be closed.
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

/// Samples per chunk, about 64 KiB: a short record is a small file.
hsize_t chunk_rows(std::size_t channels) {
  return std::clamp<hsize_t>((64U * 1024U) / (sizeof(double) * channels), 1, 8192);
}

/// Attributes of the file and a group `channels`. False when HDF5 could not write.
struct PlainHeader {
  hid_t root{};
  Hdf5Handle group{};

  template <class Value>
  bool attribute(const char* name, const Value& value) const {
    return write_attribute(root, name, value);
  }
  bool text(const char* name, const std::string& text) const {
    return write_text(root, name, text);
  }
  template <class Value>
  bool channels(const char* name, const std::vector<Value>& values) const {
    return write_list(group.id(), name, values);
  }
};

/// The same as variables of MATLAB.
struct Mat73Header {
  hid_t root{};

  bool attribute(const char* name, const std::string& value) const { return text(name, value); }
  bool attribute(const char* name, double value) const {
    return mat73_numbers(root, name, {value});
  }
  bool text(const char* name, const std::string& text) const {
    return mat73_text(root, name, text);
  }
  bool channels(const std::string& name, const std::vector<std::string>& texts) const {
    return mat73_texts(root, ("channel_" + name).c_str(), texts);
  }
  bool channels(const std::string& name, const std::vector<int>& values) const {
    return mat73_numbers(root, ("channel_" + name).c_str(), {values.begin(), values.end()});
  }
};

bool write_header(hid_t root, const RecordHeader& header, bool for_matlab) {
  if (for_matlab) return put_header(header, Mat73Header{root});
  return put_header(header, PlainHeader{root, group_without_times(root, "channels")});
}

/// HDF5 of hydrapod's own layout or of MATLAB 7.3; `samples` are one dataset of samples × channels
/// in both, which MATLAB sees as channels × samples.
class Hdf5Writer final : public RecordWriter {
 public:
  Hdf5Writer(std::unique_ptr<base::PartFile> part, const RecordHeader& header, bool for_matlab)
      : RecordWriter(header), part_(std::move(part)), header_(header), for_matlab_(for_matlab) {
    const Hdf5Handle list(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    H5Pset_obj_track_times(list.id(), false);
    if (for_matlab) H5Pset_userblock(list.id(), mat73_userblock_bytes);
    file_ = {H5Fcreate(part_->part().c_str(), H5F_ACC_TRUNC, list.id(), H5P_DEFAULT), H5Fclose};
    if (!file_.ok()) fail();
    {
      const Hdf5Handle root(H5Gopen2(file_.id(), "/", H5P_DEFAULT), H5Gclose);
      if (!write_header(root.id(), header, for_matlab)) fail();
    }
    give_index_room();
    make_samples();
    flush();
  }

  ~Hdf5Writer() override {
    const Hdf5Lock lock;
    samples_.reset();
    file_.reset();
  }

  void write(const Eigen::Ref<const Samples>& samples) override {
    if (samples.rows() == 0) return;
    const Hdf5Lock lock;
    const Hdf5Silence silence;
    const Samples dense = samples;  // rows of a block may be apart
    const hsize_t rows = static_cast<hsize_t>(dense.rows()), columns = header_.channels.size();
    const hsize_t whole[2] = {written_ + rows, columns}, from[2] = {written_, 0},
                  count[2] = {rows, columns};
    if (H5Dset_extent(samples_.id(), whole) < 0) fail();
    const Hdf5Handle target(H5Dget_space(samples_.id()), H5Sclose);
    const Hdf5Handle source(H5Screate_simple(2, count, nullptr), H5Sclose);
    H5Sselect_hyperslab(target.id(), H5S_SELECT_SET, from, nullptr, count, nullptr);
    if (H5Dwrite(samples_.id(), H5T_NATIVE_DOUBLE, source.id(), target.id(), H5P_DEFAULT,
                 dense.data()) < 0)
      fail();
    written_ += rows;
    unflushed_ += rows * columns * sizeof(double);
    constexpr hsize_t enough = 1U << 20U;  // bytes
    if (unflushed_ < enough) return;
    flush();
    unflushed_ = 0;
  }

 private:
  std::string finish(bool complete) override {
    const Hdf5Lock lock;
    const Hdf5Silence silence;
    if (!put_checksum()) fail();
    flush();
    if (!samples_.reset() || !file_.reset()) fail();
    if (for_matlab_ && !write_mat73_userblock(part_->part())) fail();
    return part_->commit(complete);
  }

  [[nodiscard]] bool put_checksum() const {
    const std::string text = checksum();
    if (!for_matlab_) {
      const Hdf5Handle root(H5Gopen2(file_.id(), "/", H5P_DEFAULT), H5Gclose);
      return rewrite_attribute(root.id(), checksum_name, text);
    }
    const std::u16string units = utf16_from(text);
    const Hdf5Handle set(H5Dopen2(file_.id(), checksum_name, H5P_DEFAULT), H5Dclose);
    return set.ok() &&
           H5Dwrite(set.id(), H5T_NATIVE_UINT16, H5S_ALL, H5S_ALL, H5P_DEFAULT, units.data()) >=
               0 &&
           H5Dflush(set.id()) >= 0;
  }

  /// The file stays as the last good flush left it: HDF5, asked to close what it could not write,
  /// would put its table of contents over that and leave a file that cannot be opened.
  [[noreturn]] void fail() {
    samples_.abandon();
    file_.abandon();
    throw base::ComputationError(failed_write(*part_, flushed_ > 0));
  }

  /// Room on the disk for all that HDF5 has yet to write: what would be half an index otherwise
  /// leaves the last good flush untouched.
  [[nodiscard]] bool reserve() const {
    hsize_t bytes = 0;
    void* descriptor = nullptr;
    if (H5Fget_filesize(file_.id(), &bytes) < 0 ||
        H5Fget_vfd_handle(file_.id(), H5P_DEFAULT, &descriptor) < 0)
      return false;
    const int number = *static_cast<int*>(descriptor);
    while (::fallocate(number, 0, 0, static_cast<off_t>(bytes)) != 0) {
      if (errno == EOPNOTSUPP || errno == ENOSYS) return true;  // not every file system can
      if (errno != EINTR) return false;
    }
    return true;
  }

  void flush() {
    if (!reserve() || H5Fflush(file_.id(), H5F_SCOPE_GLOBAL) < 0) fail();
    flushed_ = written_;
  }

  /// What is not samples gets room of 16 KiB at a time from here on: HDF5 moves the first leaf of
  /// the index of the chunks to a new place when the second one comes, after 4 MB, and so it stands
  /// before the samples. hdf5_remains.cpp finds the samples of a file that was cut off by it.
  void give_index_room() {
    flush();
    if (!file_.reset()) fail();
    const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    constexpr hsize_t room = 16384;  // six leaves
    H5Pset_meta_block_size(access.id(), room);
    file_ = {H5Fopen(part_->part().c_str(), H5F_ACC_RDWR, access.id()), H5Fclose};
    if (!file_.ok()) fail();
  }

  void make_samples() {
    const hsize_t columns = header_.channels.size();
    const hsize_t now[2] = {0, columns}, most[2] = {H5S_UNLIMITED, columns},
                  chunk[2] = {chunk_rows(columns), columns};
    const Hdf5Handle list = dataset_without_times();
    H5Pset_chunk(list.id(), 2, chunk);
    const Hdf5Handle space(H5Screate_simple(2, now, most), H5Sclose);
    samples_ = {H5Dcreate2(file_.id(), "samples", H5T_IEEE_F64LE, space.id(), H5P_DEFAULT,
                           list.id(), H5P_DEFAULT),
                H5Dclose};
    if (!samples_.ok() || (for_matlab_ && !mat73_class(samples_.id(), "double"))) fail();
  }

  std::unique_ptr<base::PartFile> part_;
  RecordHeader header_;
  bool for_matlab_;
  Hdf5Handle file_;
  Hdf5Handle samples_;
  hsize_t written_{}, flushed_{};  ///< samples
  hsize_t unflushed_{};            ///< bytes
};

}  // namespace

std::unique_ptr<RecordWriter> make_hdf5_writer(const std::string& path, const RecordHeader& header,
                                               bool for_matlab) {
  // may look into an HDF5 file that stands there: before the lock
  auto part = std::make_unique<base::PartFile>(path);
  const Hdf5Lock lock;
  const Hdf5Silence silence;
  return std::make_unique<Hdf5Writer>(std::move(part), header, for_matlab);
}

}  // namespace hydrapod::data
