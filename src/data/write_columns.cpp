#include "hydrapod/data/modal_results.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hdf5_text.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/numerics/parallel.hpp"
#include "packed_column.hpp"

namespace hydrapod::data {

namespace {

constexpr hsize_t rows_per_chunk = 8192;  ///< 64 KiB of a column
constexpr unsigned deflate_level = 1;     ///< as packed_column() does

/// The datasets of the columns, filled a chunk at a time.
class ColumnSets {
 public:
  ColumnSets(hid_t file, const ColumnFile& content)
      : width_(content.columns.size()),
        chunk_(std::max<hsize_t>(1, std::min<hsize_t>(rows_per_chunk, content.rows))),
        threads_(content.threads) {
    const Hdf5Handle list(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
    H5Pset_link_creation_order(list.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
    H5Pset_obj_track_times(list.id(), false);
    group_ = {H5Gcreate2(file, "samples", H5P_DEFAULT, list.id(), H5P_DEFAULT), H5Gclose};
    for (const auto& column : content.columns) add(column, content.rows);
    rows_.assign(width_, std::vector<double>(chunk_));
  }

  void take(std::span<const double> numbers) {
    for (std::size_t at = 0; at < numbers.size(); at += width_) {
      for (std::size_t k = 0; k < width_; ++k) rows_[k][filled_] = numbers[at + k];
      if (++filled_ == chunk_) flush();
    }
  }

  /// The last chunk is written as long as the others; what lies beyond the rows is zero.
  void flush() {
    if (filled_ == 0) return;
    for (auto& column : rows_)
      std::fill(column.begin() + static_cast<long>(filled_), column.end(), 0.0);
    std::vector<std::vector<unsigned char>> packed(width_);
    numerics::parallel_for(width_, threads_,
                           [&](std::size_t k) { packed[k] = packed_column(rows_[k]); });
    for (std::size_t k = 0; k < width_; ++k)
      good_ = !packed[k].empty() &&
              H5Dwrite_chunk(sets_[k].id(), H5P_DEFAULT, 0, &written_, packed[k].size(),
                             packed[k].data()) >= 0 &&
              good_;
    written_ += chunk_;
    filled_ = 0;
  }

  /// Closes all; false when HDF5 could not write.
  [[nodiscard]] bool close() {
    flush();
    for (auto& set : sets_) good_ = set.reset() && good_;
    return group_.reset() && good_;
  }
  void abandon() {
    for (auto& set : sets_) set.abandon();
    group_.abandon();
  }

 private:
  void add(const ColumnHead& column, hsize_t rows) {
    const Hdf5Handle list = dataset_without_times();
    H5Pset_chunk(list.id(), 1, &chunk_);
    H5Pset_shuffle(list.id());
    H5Pset_deflate(list.id(), deflate_level);
    const Hdf5Handle space(H5Screate_simple(1, &rows, nullptr), H5Sclose);
    sets_.emplace_back(H5Dcreate2(group_.id(), column.name.c_str(), H5T_IEEE_F64LE, space.id(),
                                  H5P_DEFAULT, list.id(), H5P_DEFAULT),
                       H5Dclose);
    good_ = good_ && sets_.back().ok() &&
            write_text_attribute(sets_.back().id(), "unit", column.unit) &&
            write_text_attribute(sets_.back().id(), "description", column.description);
  }

  std::size_t width_;
  hsize_t chunk_;
  int threads_;
  Hdf5Handle group_;
  std::vector<Hdf5Handle> sets_{};
  std::vector<std::vector<double>> rows_{};
  hsize_t filled_{}, written_{};
  bool good_{true};
};

}  // namespace

void write_columns(const std::string& path, const ColumnFile& content) {
  base::PartFile part(path);  // may look into an HDF5 file that stands there: before the lock
  const Hdf5Lock lock;
  const Hdf5Silence silence;
  const auto fail = [&] {
    throw base::ComputationError(fmt::format("{} cannot be written (is the disk full?)", path));
  };
  Hdf5Handle file(H5Fcreate(part.part().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT),
                  H5Fclose);
  if (!file.ok()) fail();
  bool good = true;
  {
    const Hdf5Handle root(H5Gopen2(file.id(), "/", H5P_DEFAULT), H5Gclose);
    if (!content.study.empty()) good = write_attribute(root.id(), "study", content.study);
  }
  ColumnSets sets(file.id(), content);
  content.each_rows([&](std::span<const double> rows) { sets.take(rows); });
  {
    const Hdf5Handle root(H5Gopen2(file.id(), "/", H5P_DEFAULT), H5Gclose);
    for (const auto& [name, text] : content.texts)
      good = write_text(root.id(), name.c_str(), text) && good;
    for (const auto& [name, number] : content.numbers)
      good = write_attribute(root.id(), name.c_str(), number) && good;
  }
  good = sets.close() && good;
  if (!good || H5Fflush(file.id(), H5F_SCOPE_GLOBAL) < 0) {
    sets.abandon();
    file.abandon();
    fail();
  }
  if (!file.reset()) fail();
  part.commit();
}

}  // namespace hydrapod::data
