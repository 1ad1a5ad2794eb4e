/// HDF5 files as DataFrame.to_hdf() of pandas 1.5 writes them with PyTables 3.7, in both formats,
/// and what they have in common with MAT files: times as a column, booleans, complex numbers.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <complex>
#include <numbers>

#include "hydrapod/data/record_io.hpp"
#include "library_files.hpp"
#include "said.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr int frame_rows = 300;
constexpr double frame_rate = 200.0;
constexpr std::int64_t march_of_2024 = 1709251200000000000;  // [ns]

double time_of(int k) { return k / frame_rate; }
double force_of(int k) { return std::sin(0.2 * k); }
bool is_on(int k, int column) { return k % (2 + column) == 0; }

std::vector<std::string> frame_channels(const data::Record& record) {
  std::vector<std::string> list;
  for (const auto& channel : record.header.channels) list.push_back(channel.name);
  return list;
}

/// A row of the format "table": blocks of columns of one type.
struct FrameRow {
  std::int64_t index;
  double numbers[2];
  std::uint8_t booleans[2];
  std::int64_t date;
  double turning[2];
};

hid_t columns_of(hid_t type, hsize_t count) { return H5Tarray_create2(type, 1, &count); }

hid_t turning_type() {
  const hid_t type = H5Tcreate(H5T_COMPOUND, 2 * sizeof(double));
  H5Tinsert(type, "r", 0, H5T_NATIVE_DOUBLE);
  H5Tinsert(type, "i", sizeof(double), H5T_NATIVE_DOUBLE);
  return type;
}

void write_table(const std::string& path, const std::string& first_column) {
  std::vector<FrameRow> rows;
  for (int k = 0; k < frame_rows; ++k)
    rows.push_back({k,
                    {time_of(k), force_of(k)},
                    {is_on(k, 0) ? std::uint8_t{1} : std::uint8_t{0},
                     is_on(k, 1) ? std::uint8_t{1} : std::uint8_t{0}},
                    march_of_2024 + 5'000'000LL * k,
                    {1.0, -1.0}});
  const hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(FrameRow));
  H5Tinsert(type, "index", HOFFSET(FrameRow, index), H5T_NATIVE_INT64);
  H5Tinsert(type, "values_block_0", HOFFSET(FrameRow, numbers), columns_of(H5T_NATIVE_DOUBLE, 2));
  H5Tinsert(type, "values_block_1", HOFFSET(FrameRow, booleans), columns_of(H5T_NATIVE_B8, 2));
  H5Tinsert(type, "values_block_2", HOFFSET(FrameRow, date), columns_of(H5T_NATIVE_INT64, 1));
  H5Tinsert(type, "values_block_3", HOFFSET(FrameRow, turning), columns_of(turning_type(), 1));
  Hdf5File file(path);
  file.write("table", type, {frame_rows}, rows.data());
  file.attribute("table", "index_kind", std::string("integer"));
  file.attribute("table", "values_block_0_kind",
                 "(lp0\nV" + first_column + "\np1\naVforce [N]\np2\na.");
  file.attribute("table", "values_block_1_kind",
                 std::string("(lp0\nVon\np1\naVvalve open\np2\na."));
  file.attribute("table", "values_block_2_kind", std::string("(lp0\nVwhen\np1\na."));
  file.attribute("table", "values_block_2_dtype", std::string("datetime64"));
  file.attribute("table", "values_block_3_kind", std::string("(lp0\nVz\np1\na."));
}

void expect_samples(const data::Record& record, Eigen::Index force, Eigen::Index on) {
  ASSERT_EQ(record.samples.rows(), frame_rows);
  for (int k = 0; k < frame_rows; ++k) {
    EXPECT_EQ(record.samples(k, force), force_of(k));
    EXPECT_EQ(record.samples(k, on), is_on(k, 0) ? 1.0 : 0.0);
    EXPECT_EQ(record.samples(k, on + 1), is_on(k, 1) ? 1.0 : 0.0);
  }
}

class TimeColumns : public testing::TestWithParam<std::pair<const char*, double>> {};

/// As in a table of text: the index of rows says nothing of the times, a column does.
TEST_P(TimeColumns, AreTheTimesOfATable) {
  const auto [title, seconds] = GetParam();
  const TemporaryFolder folder;
  write_table(folder / "p.h5", title);
  const auto [record, notes] = data::read_record(folder / "p.h5");
  EXPECT_NEAR(record.header.sample_rate, frame_rate / seconds, 1e-9 * frame_rate / seconds);
  EXPECT_EQ(record.header.start, 0.0);
  EXPECT_THAT(frame_channels(record), ElementsAre("force", "on", "valve open", "when"));
  expect_samples(record, 0, 1);
  EXPECT_THAT(messages(notes), Contains(HasSubstr("'table/values_block_3' is complex")));
}

INSTANTIATE_TEST_SUITE_P(Pandas, TimeColumns,
                         testing::Values(std::pair("time", 1.0), std::pair("t", 1.0),
                                         std::pair("time [ms]", 1e-3), std::pair("Zeit (s)", 1.0),
                                         std::pair("time_s", 1.0), std::pair("seconds", 1.0)));

TEST(PandasFiles, ATableWithoutTimesNeedsARate) {
  const TemporaryFolder folder;
  write_table(folder / "p.h5", "x");
  EXPECT_THAT(refusal_of([&] { data::read_record(folder / "p.h5"); }).message,
              HasSubstr("states no sample rate"));
  const auto record = data::read_record(folder / "p.h5", {.sample_rate = 50.0}).record;
  EXPECT_THAT(frame_channels(record), ElementsAre("x", "force", "on", "valve open", "when"));
  expect_samples(record, 1, 2);
}

TEST(PandasFiles, ARateIsComparedWithTheColumnOfTimes) {
  const TemporaryFolder folder;
  write_table(folder / "p.h5", "time");
  EXPECT_THAT(
      refusal_of([&] { data::read_record(folder / "p.h5", {.sample_rate = 50.0}); }).message,
      HasSubstr("the times make a sample rate of 200 Hz, but --rate 50 says 50 Hz"));
  EXPECT_EQ(
      data::read_record(folder / "p.h5", {.sample_rate = frame_rate}).record.header.channels.size(),
      4U);
}

TEST(PandasFiles, AColumnOfDatesIsTheTimes) {
  const TemporaryFolder folder;
  {
    Hdf5File file(folder / "p.h5");
    std::vector<std::int64_t> dates;
    std::vector<double> force;
    for (int k = 0; k < frame_rows; ++k) {
      dates.push_back(march_of_2024 + 5'000'000LL * k);
      force.push_back(force_of(k));
    }
    const hid_t names = H5Tcopy(H5T_C_S1);
    H5Tset_size(names, 9);
    file.write("block0_items", names, {1}, "force [N]");
    file.write("block0_values", H5T_NATIVE_DOUBLE, {frame_rows, 1}, force.data());
    H5Tset_size(names, 4);
    file.write("block1_items", names, {1}, "time");
    file.write("block1_values", H5T_NATIVE_INT64, {frame_rows, 1}, dates.data());
    file.attribute("block1_values", "value_type", std::string("datetime64"));
  }
  const auto record = data::read_record(folder / "p.h5").record;
  EXPECT_NEAR(record.header.sample_rate, frame_rate, 1e-9 * frame_rate);
  EXPECT_THAT(frame_channels(record), ElementsAre("force"));
  EXPECT_EQ(record.samples(7, 0), force_of(7));
}

/// A gap in a column of times leaves missing samples, where columns stand side by side and where
/// they stand one behind the other.
TEST(PandasFiles, AColumnOfTimesMayHaveGaps) {
  const TemporaryFolder folder;
  std::vector<double> by_rows, by_columns(2UL * frame_rows);
  for (int k = 0; k < frame_rows; ++k) {
    const int point = k < 100 ? k : k + 3;
    const auto at = static_cast<std::size_t>(k);
    by_rows.insert(by_rows.end(), {force_of(k), time_of(point)});
    by_columns[at] = force_of(k);
    by_columns[at + frame_rows] = time_of(point);
  }
  {
    Hdf5File file(folder / "p.h5");
    const hid_t names = H5Tcopy(H5T_C_S1);
    H5Tset_size(names, 5);
    file.write("block0_items", names, {2}, "forcet\0\0\0\0");
    file.write("block0_values", H5T_NATIVE_DOUBLE, {frame_rows, 2}, by_rows.data());
  }
  std::size_t size[2] = {frame_rows, 2}, count[2] = {1, 2};
  matvar_t* cell = Mat_VarCreate("names", MAT_C_CELL, MAT_T_CELL, 2, count, nullptr, 0);
  for (const std::string name : {"force", "t"}) {
    std::size_t length[2] = {1, name.size()};
    std::string text = name;
    Mat_VarSetCell(cell, name == "t" ? 1 : 0,
                   Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UTF8, 2, length, text.data(), 0));
  }
  write_mat(
      folder / "p.mat",
      {Mat_VarCreate("data", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size, by_columns.data(), 0), cell});
  for (const char* name : {"p.h5", "p.mat"}) {
    const auto [record, notes] = data::read_record(folder / name);
    EXPECT_EQ(record.header.sample_rate, frame_rate) << name;
    EXPECT_THAT(frame_channels(record), ElementsAre("force")) << name;
    ASSERT_EQ(record.samples.rows(), frame_rows + 3) << name;
    EXPECT_EQ(record.samples(99, 0), force_of(99)) << name;
    EXPECT_TRUE(std::isnan(record.samples(101, 0))) << name;
    EXPECT_EQ(record.samples(103, 0), force_of(100)) << name;
    EXPECT_THAT(messages(notes), Contains(HasSubstr("the times have 1 gap"))) << name;
  }
}

/// A channel called t beside a stated rate is a torque, or a temperature.
TEST(PandasFiles, ARateOfTheFileHolds) {
  const TemporaryFolder folder;
  std::vector<double> numbers;
  for (int k = 0; k < frame_rows; ++k) numbers.insert(numbers.end(), {force_of(k), -force_of(k)});
  {
    Hdf5File file(folder / "p.h5");
    file.write("block0_items", H5T_C_S1, {2}, "FT");
    file.write("block0_values", H5T_NATIVE_DOUBLE, {frame_rows, 2}, numbers.data());
    file.attribute("block0_values", "fs", frame_rate);
  }
  EXPECT_THAT(frame_channels(data::read_record(folder / "p.h5").record), ElementsAre("F", "T"));
}

/// Numbers of which one part would be lost are no samples, in all formats alike.
TEST(PandasFiles, ComplexNumbersAreLeftOutOfEveryFormat) {
  const TemporaryFolder folder;
  std::vector<std::complex<double>> turning;
  std::vector<double> force, real, imaginary;
  for (int k = 0; k < frame_rows; ++k) {
    turning.push_back(std::polar(1.0, 0.1 * k));
    force.push_back(force_of(k));
    real.push_back(turning.back().real());
    imaginary.push_back(turning.back().imag());
  }
  for (const bool alone : {false, true}) {
    const double fs = frame_rate;
    {
      Hdf5File file(folder / "z.h5");
      file.write("z", turning_type(), {frame_rows}, turning.data());
      file.write("fs", H5T_NATIVE_DOUBLE, {}, &fs);
      if (!alone) file.write("force", H5T_NATIVE_DOUBLE, {frame_rows}, force.data());
    }
    std::size_t size[2] = {frame_rows, 1}, one[2] = {1, 1};
    mat_complex_split_t split{real.data(), imaginary.data()};
    double of_file = frame_rate;
    std::vector<matvar_t*> variables{
        Mat_VarCreate("z", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size, &split, MAT_F_COMPLEX),
        Mat_VarCreate("fs", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, one, &of_file, 0)};
    if (!alone)
      variables.push_back(
          Mat_VarCreate("force", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size, force.data(), 0));
    write_mat(folder / "z.mat", variables);
    for (const char* name : {"z.h5", "z.mat"}) {
      const std::string said =
          "'z' is complex, and samples are real numbers (write its real and its imaginary part as "
          "two arrays): left out";
      if (alone) {
        EXPECT_THAT(refusal_of([&] { data::read_record(folder / name); }).message,
                    HasSubstr("no array of numbers with two samples or more"));
        continue;
      }
      const auto [record, notes] = data::read_record(folder / name);
      EXPECT_THAT(frame_channels(record), ElementsAre("force")) << name;
      EXPECT_THAT(messages(notes), Contains(said)) << name;
    }
  }
}

}  // namespace
}  // namespace hydrapod::test
