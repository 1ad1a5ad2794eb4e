#pragma once
/// Named columns of numbers in one HDF5 file: the results of a study.
///
///     /            attributes: texts and numbers that say what the columns are
///     /samples/    a dataset per column, doubles, chunked and compressed (shuffle, deflate), with
///                  the attributes `unit` and `description`; NaN: no value
///
/// With h5py: `pandas.DataFrame({n: d[:] for n, d in h5py.File(path)["samples"].items()})`. Links
/// keep the order in which they were made. There are no time stamps: equal results are equal files.

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace hydrapod::data {

struct ColumnHead {
  std::string name{};
  std::string unit{};
  std::string description{};
};

struct ColumnFile {
  std::vector<ColumnHead> columns{};
  std::uint64_t rows{};
  int threads{};  ///< that pack the columns; 0: one per processor
  std::map<std::string, std::string> texts{};
  std::map<std::string, double> numbers{};
  /// Hands all rows over, some at a time, one row after the other, columns side by side.
  std::function<void(const std::function<void(std::span<const double>)>&)> each_rows{};
};

/// Writes the file whole or not at all. Throws base::InputError for a place that cannot be written
/// to, base::ComputationError where writing failed.
void write_columns(const std::string& path, const ColumnFile& file);

}  // namespace hydrapod::data
