#include <fmt/format.h>

#include <algorithm>

#include "formats.hpp"
#include "hdf5_text.hpp"
#include "hydrapod/base/file.hpp"

namespace hydrapod::data {

namespace {

/// Samples per chunk: about half a megabyte, which is what HDF5 keeps in its cache.
hsize_t chunk_rows(std::size_t channels) {
  return std::clamp<hsize_t>((512U * 1024U) / (sizeof(double) * channels), 1, 16384);
}

class Hdf5Writer final : public RecordWriter {
 public:
  Hdf5Writer(const std::string& path, const RecordHeader& header) : part_(path), header_(header) {
    const Hdf5Handle list(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    H5Pset_obj_track_times(list.id(), false);
    file_ = {H5Fcreate(part_.part().c_str(), H5F_ACC_TRUNC, list.id(), H5P_DEFAULT), H5Fclose};
    if (!file_.ok()) fail();
    write_header();
    make_samples();
    flush();
  }

  void append(const Eigen::Ref<const Samples>& samples) override {
    require_columns(samples, header_);
    if (!samples_.ok()) throw std::invalid_argument("RecordWriter::append: the record is closed");
    if (samples.rows() == 0) return;
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
    const hsize_t chunk = chunk_rows(columns);
    const bool chunk_complete = (written_ + rows) / chunk > written_ / chunk;
    written_ += rows;
    if (chunk_complete) flush();
  }

  void close() override {
    const Hdf5Silence silence;
    flush();
    if (!samples_.reset() || !file_.reset()) fail();
    part_.commit();
  }

 private:
  [[noreturn]] void fail() const {
    throw base::ComputationError(
        fmt::format("writing '{}' failed; is the disk full?", part_.path()));
  }

  void flush() {
    if (H5Fflush(file_.id(), H5F_SCOPE_GLOBAL) < 0) fail();
  }

  void write_header() {
    const Hdf5Handle root(H5Gopen2(file_.id(), "/", H5P_DEFAULT), H5Gclose);
    const hid_t id = root.id();
    bool good = write_attribute(id, "format", std::string(record_mark)) &&
                write_attribute(id, "format_version", record_version) &&
                write_attribute(id, "title", header_.title) &&
                write_attribute(id, "sample_rate_hz", header_.sample_rate) &&
                write_attribute(id, "start_s", header_.start) &&
                write_attribute(id, "date", header_.date) &&
                write_attribute(id, "repeat", header_.repeat) &&
                write_text(id, "notes", header_.notes) &&
                write_text(id, "machine", header_.machine);
    std::vector<std::string> names, units, directions, roles;
    std::vector<int> points;
    for (const Channel& channel : header_.channels) {
      names.push_back(channel.name);
      units.push_back(channel.unit);
      directions.emplace_back(direction_text(channel.direction));
      roles.emplace_back(role_text(channel.role));
      points.push_back(channel.point);
    }
    const Hdf5Handle group = group_without_times(id, "channels");
    good = good && write_texts(group.id(), "name", names) &&
           write_texts(group.id(), "unit", units) &&
           write_texts(group.id(), "direction", directions) &&
           write_texts(group.id(), "role", roles) && write_integers(group.id(), "point", points);
    if (!good) fail();
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
    if (!samples_.ok()) fail();
  }

  base::PartFile part_;
  RecordHeader header_;
  Hdf5Handle file_;
  Hdf5Handle samples_;
  hsize_t written_{};
};

}  // namespace

std::unique_ptr<RecordWriter> make_hdf5_writer(const std::string& path,
                                               const RecordHeader& header) {
  const Hdf5Silence silence;
  return std::make_unique<Hdf5Writer>(path, header);
}

}  // namespace hydrapod::data
