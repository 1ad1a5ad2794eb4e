/// Columns of studies: HDF5's own filters unpack what is packed here.

#include <gtest/gtest.h>
#include <hdf5.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include "hydrapod/data/modal_results.hpp"
#include "support/random.hpp"

namespace hydrapod::data {
namespace {

namespace fs = std::filesystem;

std::vector<double> read_back(const fs::path& path, const std::string& name, std::size_t rows) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t set = H5Dopen2(file, ("samples/" + name).c_str(), H5P_DEFAULT);
  const hid_t space = H5Dget_space(set);
  EXPECT_EQ(H5Sget_simple_extent_npoints(space), static_cast<hssize_t>(rows));
  std::vector<double> values(rows);
  EXPECT_GE(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  H5Sclose(space);
  H5Dclose(set);
  H5Fclose(file);
  return values;
}

/// Random bits, a smooth column, few values, NaN: planes that are stored, packed, and both by
/// turns. 1, 8191, 8192 and 20000 rows: a part of a chunk, a whole one, several.
TEST(Columns, AreReadBackBitForBit) {
  const fs::path path = fs::temp_directory_path() / "hydrapod-columns-test.h5";
  test::Random random(2104);
  for (const std::size_t rows : {1U, 8191U, 8192U, 20000U}) {
    std::vector<double> numbers;
    for (std::size_t k = 0; k < rows; ++k) {
      numbers.push_back(random.uniform(4.0, 5.0));
      numbers.push_back(1.0 + 1e-3 * static_cast<double>(k));
      numbers.push_back(random.chance(0.5) ? 1.0 : 2.0);
      numbers.push_back(std::numeric_limits<double>::quiet_NaN());
    }
    ColumnFile file{.rows = rows};
    for (const char* name : {"noise", "ramp", "coin", "none"})
      file.columns.push_back({name, "1", "what it is"});
    file.each_rows = [&](const std::function<void(std::span<const double>)>& take) {
      const std::size_t some = 4 * std::min<std::size_t>(rows, 100);
      for (std::size_t at = 0; at < numbers.size(); at += some)
        take(std::span(numbers).subspan(at, std::min(some, numbers.size() - at)));
    };
    write_columns(path.string(), file);
    const std::array<std::string, 4> names{"noise", "ramp", "coin", "none"};
    for (std::size_t k = 0; k < names.size(); ++k) {
      const auto values = read_back(path, names[k], rows);
      for (std::size_t row = 0; row < rows; ++row) {
        const double expected = numbers[4 * row + k];
        ASSERT_TRUE(values[row] == expected || (std::isnan(values[row]) && std::isnan(expected)))
            << names[k] << ", row " << row << " of " << rows;
      }
    }
    // of four columns less than two: one is noise, one a ramp, two hold hardly anything
    if (rows == 20000) {
      EXPECT_LT(fs::file_size(path), rows * 2 * 8);
    }
  }
  fs::remove(path);
}

}  // namespace
}  // namespace hydrapod::data
