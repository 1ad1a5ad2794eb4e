/// Named arrays as datasets of an HDF5 file, as numpy and h5py have them.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <complex>

#include "formats.hpp"
#include "hdf5_text.hpp"
#include "out_stream.hpp"

namespace hydrapod::data {

namespace {

/// Pages first, then rows, then columns; a single row or column is a list.
std::vector<hsize_t> numpy_sizes(const MatVariable& v) {
  const auto rows = static_cast<hsize_t>(v.size[0]), columns = static_cast<hsize_t>(v.size[1]);
  if (v.size.size() > 2) return {static_cast<hsize_t>(v.size[2]), rows, columns};
  if (rows == 1 || columns == 1) return {rows * columns};
  return {rows, columns};
}

/// The numbers, of which columns stand one after the other, row by row.
template <class Number, class Get>
std::vector<Number> row_by_row(const MatVariable& v, const Get& get) {
  const auto rows = static_cast<std::size_t>(v.size[0]),
             columns = static_cast<std::size_t>(v.size[1]);
  std::vector<Number> numbers;
  for (std::size_t page = 0; page < v.real.size(); page += rows * columns)
    for (std::size_t i = 0; i < rows; ++i)
      for (std::size_t j = 0; j < columns; ++j) numbers.push_back(get(page + j * rows + i));
  return numbers;
}

Hdf5Handle pair_type(hid_t number) {
  const std::size_t bytes = H5Tget_size(number);
  Hdf5Handle type(H5Tcreate(H5T_COMPOUND, 2 * bytes), H5Tclose);
  H5Tinsert(type.id(), "r", 0, number);
  H5Tinsert(type.id(), "i", bytes, number);
  return type;
}

void require_size(const MatVariable& v) {
  std::size_t count = 1;
  for (const int size : v.size) count *= static_cast<std::size_t>(size);
  const bool shaped = v.size.size() == 2 || v.size.size() == 3;
  if (!shaped || count != v.real.size() ||
      (!v.imaginary.empty() && v.imaginary.size() != v.real.size()))
    throw std::invalid_argument(
        fmt::format("HDF5 variable {}: {} numbers do not fit its size", v.name, v.real.size()));
}

bool put_numbers(hid_t root, const MatVariable& v) {
  require_size(v);
  const auto sizes = numpy_sizes(v);
  if (v.is_number) return write_attribute(root, v.name.c_str(), v.real[0]);
  const Hdf5Handle space(H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr),
                         H5Sclose);
  if (v.imaginary.empty()) {
    const auto numbers = row_by_row<double>(v, [&](std::size_t k) { return v.real[k]; });
    return write_set(root, v.name.c_str(), H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, space, numbers.data())
        .ok();
  }
  const auto numbers = row_by_row<std::complex<double>>(
      v, [&](std::size_t k) { return std::complex<double>(v.real[k], v.imaginary[k]); });
  return write_set(root, v.name.c_str(), pair_type(H5T_IEEE_F64LE).id(),
                   pair_type(H5T_NATIVE_DOUBLE).id(), space, numbers.data())
      .ok();
}

bool put(hid_t root, const MatVariable& v) {
  if (v.is_list) return write_list(root, v.name.c_str(), v.texts);
  if (!v.is_text) return put_numbers(root, v);
  const std::string text = v.texts.empty() ? "" : v.texts[0];
  constexpr std::array short_texts{"format", "title", "date"};
  if (std::ranges::find(short_texts, v.name) != short_texts.end())
    return write_attribute(root, v.name.c_str(), text);
  return write_text(root, v.name.c_str(), text);
}

}  // namespace

void write_hdf5_variables(const std::string& path, const std::vector<MatVariable>& variables) {
  base::PartFile part(path);  // may look into an HDF5 file that stands there: before the lock
  const Hdf5Lock lock;
  const Hdf5Silence silence;
  const auto fail = [&] { throw base::ComputationError(failed_write(part, false)); };
  const Hdf5Handle list(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_obj_track_times(list.id(), false);
  Hdf5Handle file(H5Fcreate(part.part().c_str(), H5F_ACC_TRUNC, list.id(), H5P_DEFAULT), H5Fclose);
  if (!file.ok()) fail();
  const auto abandon = [&] {  // HDF5 would write again what it could not write
    file.abandon();
    fail();
  };
  {
    Hdf5Handle root(H5Gopen2(file.id(), "/", H5P_DEFAULT), H5Gclose);
    for (const MatVariable& v : variables)
      if (!put(root.id(), v)) {
        root.abandon();
        abandon();
      }
  }
  if (H5Fflush(file.id(), H5F_SCOPE_GLOBAL) < 0) abandon();
  if (!file.reset()) fail();
  part.commit();
}

}  // namespace hydrapod::data
