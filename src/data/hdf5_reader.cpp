#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "channel_units.hpp"
#include "formats.hpp"
#include "hdf5_text.hpp"
#include "header_numbers.hpp"
#include "hydrapod/base/printable.hpp"
#include "variable_file.hpp"

namespace hydrapod::data {

namespace {

class Hdf5Reader final : public RecordReader {
 public:
  Hdf5Reader(const std::string& path, Hdf5Handle file)
      : notes_(path),
        file_bytes_(std::filesystem::file_size(path)),
        file_(std::move(file)),
        root_(H5Gopen2(file_.id(), "/", H5P_DEFAULT), H5Gclose) {
    read_attributes();
    read_channels();
    make_names_unique(header_.channels);
    factors_ = to_si(header_.channels, notes_, true);
    open_samples();
  }

  [[nodiscard]] RecordFormat format() const override { return RecordFormat::hdf5; }
  [[nodiscard]] const RecordHeader& header() const override { return header_; }
  [[nodiscard]] std::optional<std::int64_t> sample_count() const override {
    return static_cast<std::int64_t>(rows_);
  }
  [[nodiscard]] const std::vector<base::Diagnostic>& notes() const override { return notes_.all(); }

  std::int64_t read(Eigen::Ref<Samples> block) override {
    const Hdf5Silence silence;
    const hsize_t rows = std::min<hsize_t>(rows_ - next_, static_cast<hsize_t>(block.rows()));
    if (rows == 0) return 0;
    const hsize_t count[2] = {rows, header_.channels.size()}, from[2] = {next_, 0};
    buffer_.resize(static_cast<Eigen::Index>(rows), block.cols());
    const Hdf5Handle source(H5Dget_space(samples_.id()), H5Sclose);
    const Hdf5Handle target(H5Screate_simple(2, count, nullptr), H5Sclose);
    if (H5Sselect_hyperslab(source.id(), H5S_SELECT_SET, from, nullptr, count, nullptr) < 0 ||
        H5Dread(samples_.id(), H5T_NATIVE_DOUBLE, target.id(), source.id(), H5P_DEFAULT,
                buffer_.data()) < 0) {
      notes_.add(fmt::format("the samples from {} on cannot be read: the file is damaged there",
                             next_ + 1));
      next_ = rows_;
      return 0;
    }
    next_ += rows;
    for (Eigen::Index c = 0; c < block.cols(); ++c)
      block.col(c).head(buffer_.rows()) = buffer_.col(c) * factors_[static_cast<std::size_t>(c)];
    return static_cast<std::int64_t>(rows);
  }

 private:
  double number(const char* name, std::optional<double> otherwise = {}) {
    const auto value = read_number_attribute(root_.id(), name);
    if (value && std::isfinite(*value)) return *value;
    if (!value && otherwise && H5Aexists(root_.id(), name) <= 0) return *otherwise;
    notes_.fail(fmt::format("the attribute '{}' is missing or is not a finite number", name));
  }

  void read_attributes() {
    read_header_numbers([this](const char* name,
                               std::optional<double> otherwise) { return number(name, otherwise); },
                        notes_, header_);
    header_.title = clean_text(read_text_attribute(root_.id(), "title").value_or(""));
    header_.date = clean_text(read_text_attribute(root_.id(), "date").value_or(""));
    header_.notes = clean_text(long_text("notes"), true);
    header_.machine = clean_text(long_text("machine"), true);
  }

  std::string long_text(const char* name) {
    const auto text = read_text(root_.id(), name, file_bytes_);
    if (!text && has_object(root_.id(), name))
      notes_.add(fmt::format("the text '{}' cannot be read and is left out", name));
    return text.value_or("");
  }

  void read_channels() {
    if (!has_object(root_.id(), "channels")) notes_.fail("there is no group 'channels'");
    const Hdf5Handle group(H5Gopen2(root_.id(), "channels", H5P_DEFAULT), H5Gclose);
    if (!group.ok()) notes_.fail("'channels' is not a group");
    const auto names = read_texts(group.id(), "name", file_bytes_);
    if (!names) notes_.fail("'channels/name' is not a list of names that the file can hold");
    for (const auto& name : *names) header_.channels.push_back({.name = name});
    const auto texts = [&](const char* what) {
      auto list = read_texts(group.id(), what, file_bytes_);
      if (list && list->size() == names->size()) return *list;
      notes_.add(fmt::format("'channels/{}' is missing or does not hold {} texts; it is left out",
                             what, names->size()));
      return std::vector<std::string>(names->size());
    };
    const auto units = texts("unit"), directions = texts("direction"), roles = texts("role");
    const auto points = read_integers(group.id(), "point", file_bytes_);
    for (std::size_t c = 0; c < names->size(); ++c) {
      Channel& channel = header_.channels[c];
      channel.unit = units[c];
      const auto direction = direction_from_text(directions[c]);
      const auto role = role_from_text(roles[c]);
      if (!direction)
        notes_.add(fmt::format("channel {}: direction \"{}\" is unknown and left out", c + 1,
                               base::printable(directions[c])));
      if (!role && !roles[c].empty())
        notes_.add(fmt::format("channel {}: role \"{}\" is unknown; taken as other", c + 1,
                               base::printable(roles[c])));
      channel.direction = direction.value_or(Direction::none);
      channel.role = role.value_or(Role::other);
      if (points && points->size() == names->size()) channel.point = (*points)[c];
    }
  }

  void open_samples() {
    if (!has_object(root_.id(), "samples")) notes_.fail("there is no dataset 'samples'");
    samples_ = {H5Dopen2(root_.id(), "samples", H5P_DEFAULT), H5Dclose};
    if (!samples_.ok()) notes_.fail("'samples' is not a dataset");
    const Hdf5Handle space(H5Dget_space(samples_.id()), H5Sclose);
    const Hdf5Handle type(H5Dget_type(samples_.id()), H5Tclose);
    hsize_t size[2] = {0, 0};
    if (H5Sget_simple_extent_ndims(space.id()) != 2 ||
        H5Sget_simple_extent_dims(space.id(), size, nullptr) < 0)
      notes_.fail("'samples' is not a table of samples × channels");
    if (H5Tget_class(type.id()) != H5T_FLOAT && H5Tget_class(type.id()) != H5T_INTEGER)
      notes_.fail("'samples' does not hold numbers");
    if (size[1] != header_.channels.size())
      notes_.fail(fmt::format("'samples' has {} columns for {} channels", size[1],
                              header_.channels.size()));
    rows_ = believable_rows(samples_.id(), size[0], size[1]);
    if (const auto bytes = chunk_bytes(samples_.id()); bytes > most_chunk_bytes)
      notes_.fail(
          fmt::format("'samples' has chunks of {} bytes, more than the {} MiB that are read "
                      "at once",
                      bytes, most_chunk_bytes >> 20U));
    if (rows_ < size[0])
      notes_.add(
          fmt::format("{} samples are declared, but the file holds {} at most", size[0], rows_));
  }

  Notes notes_;
  std::uintmax_t file_bytes_;
  Hdf5Handle file_;
  Hdf5Handle root_;
  RecordHeader header_;
  std::vector<double> factors_;
  Hdf5Handle samples_;
  hsize_t rows_{}, next_{};
  Samples buffer_;
};

}  // namespace

std::unique_ptr<RecordReader> make_hdf5_reader(const std::string& path,
                                               const ReadOptions& options) {
  const Hdf5Silence silence;
  Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file.ok()) Notes(path).fail("the HDF5 file is damaged or cut off: it cannot be opened");
  if (read_text_attribute(file.id(), "format") != record_mark) {
    Notes notes(path);
    file.reset();
    auto variables = open_hdf5_variables(path, notes);
    return make_variables_reader(std::move(variables), std::move(notes), options);
  }
  return std::make_unique<Hdf5Reader>(path, std::move(file));
}

}  // namespace hydrapod::data
