/// MAT and HDF5 files as analysers, h5py, pandas and PyTables write them, made here with matio and
/// the HDF5 library.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "hydrapod/data/record_io.hpp"
#include "library_files.hpp"
#include "said.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
constexpr int samples = 300;

std::vector<double> wave(double size, double omega) {
  std::vector<double> values;
  for (int k = 0; k < samples; ++k) values.push_back(size * std::sin(omega * k + 0.3));
  return values;
}

std::vector<std::string> channel_names(const data::Record& record) {
  std::vector<std::string> list;
  for (const auto& channel : record.header.channels) list.push_back(channel.name);
  return list;
}

std::vector<std::string> channel_units(const data::Record& record) {
  std::vector<std::string> list;
  for (const auto& channel : record.header.channels) list.push_back(channel.unit);
  return list;
}

std::string said(const std::string& path, const data::ReadOptions& options = {}) {
  return refusal_of([&] { data::read_record(path, options); }).message;
}

// MAT

matvar_t* numbers(const char* name, std::vector<double> values, bool row = false) {
  std::size_t size[2] = {values.size(), 1};
  if (row) std::swap(size[0], size[1]);
  return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size, values.data(), 0);
}

matvar_t* text(const char* name, std::string value) {
  std::size_t size[2] = {1, value.size()};
  return Mat_VarCreate(name, MAT_C_CHAR, MAT_T_UTF8, 2, size, value.data(), 0);
}

/// The fields become the structure's.
matvar_t* structure(const char* name,
                    const std::vector<std::pair<const char*, matvar_t*>>& fields) {
  std::size_t size[2] = {1, 1};
  std::vector<const char*> names;
  for (const auto& field : fields) names.push_back(field.first);
  matvar_t* made =
      Mat_VarCreateStruct(name, 2, size, names.data(), static_cast<unsigned>(names.size()));
  for (const auto& [field, value] : fields) Mat_VarSetStructFieldByName(made, field, 0, value);
  return made;
}

matvar_t* simcenter_signal(const char* name, const std::string& label, const std::string& unit,
                           const std::vector<double>& values, const std::string& axis = "s") {
  return structure(
      name, {{"x_values",
              structure("x_values",
                        {{"start_value", numbers("start_value", {0.5})},
                         {"increment", numbers("increment", {1.0 / 512.0})},
                         {"number_of_values", numbers("n", {1.0 * samples})},
                         {"quantity", structure("quantity", {{"label", text("label", axis)}})}})},
             {"y_values",
              structure("y_values",
                        {{"values", numbers("values", values)},
                         {"quantity", structure("quantity", {{"label", text("label", unit)}})}})},
             {"function_record", structure("function_record", {{"name", text("name", label)},
                                                               {"type", text("type", "Time")}})}});
}

TEST(AnalyserFiles, SimcenterSignalsWithNamesUnitsAndIncrement) {
  const TemporaryFolder folder;
  write_mat(folder / "s.mat", {simcenter_signal("Signal_0", "Hammer:+Z", "N", wave(3.0, 0.1)),
                               simcenter_signal("Signal_1", "plate:1:+Z", "g", wave(2.0, 0.2))});
  const auto [record, notes] = data::read_record(folder / "s.mat");
  EXPECT_EQ(record.header.sample_rate, 512.0);
  EXPECT_EQ(record.header.start, 0.5);
  EXPECT_THAT(channel_names(record), ElementsAre("Hammer:+Z", "plate:1:+Z"));
  EXPECT_THAT(channel_units(record), ElementsAre("N", "m/s^2"));
  EXPECT_EQ(record.header.channels[0].role, data::Role::excitation);
  EXPECT_EQ(record.header.channels[1].role, data::Role::response);
  ASSERT_EQ(record.samples.rows(), samples);
  EXPECT_EQ(record.samples(7, 1), wave(2.0, 0.2)[7] * 9.80665);
}

TEST(AnalyserFiles, SimcenterSpectraAreNoRecord) {
  const TemporaryFolder folder;
  write_mat(folder / "s.mat", {simcenter_signal("FRF", "a/F", "g/N", wave(1.0, 0.1), "Hz")});
  EXPECT_THAT(said(folder / "s.mat"), HasSubstr("no samples over time"));
}

TEST(AnalyserFiles, PulseChannelsWithHeaders) {
  const TemporaryFolder folder;
  std::vector<matvar_t*> variables;
  const char* data_names[] = {"Channel_1_Data", "Channel_2_Data"};
  const char* header_names[] = {"Channel_1_Header", "Channel_2_Header"};
  for (int c = 0; c < 2; ++c) {
    variables.push_back(
        structure(header_names[c], {{"SignalName", text("SignalName", c == 0 ? "Force" : "Acc")},
                                    {"Unit", text("Unit", c == 0 ? "N" : "m/s²")},
                                    {"SampleFrequency", numbers("SampleFrequency", {2048.0})}}));
    variables.push_back(numbers(data_names[c], wave(1.0 + c, 0.3), true));
  }
  write_mat(folder / "p.mat", variables);
  const auto record = data::read_record(folder / "p.mat").record;
  EXPECT_EQ(record.header.sample_rate, 2048.0);
  EXPECT_THAT(channel_names(record), ElementsAre("Force", "Acc"));
  EXPECT_EQ(record.header.channels[0].role, data::Role::excitation);
  EXPECT_EQ(record.samples(3, 1), wave(2.0, 0.3)[3]);
}

TEST(AnalyserFiles, SeveralRatesAreNotGuessedBetween) {
  const TemporaryFolder folder;
  write_mat(folder / "r.mat",
            {numbers("x", wave(1.0, 0.1)), numbers("fs", {100.0}), numbers("dt", {0.005})});
  EXPECT_THAT(said(folder / "r.mat"), HasSubstr("the file states several sample rates: 100 Hz by "
                                                "'fs' and 200 Hz by 'dt'"));
  EXPECT_EQ(data::read_record(folder / "r.mat", {.sample_rate = 200.0}).record.header.sample_rate,
            200.0);
}

/// A file of two runs is two records: as one, the second would have the times of the first.
TEST(AnalyserFiles, PartsWithTimesOfTheirOwnAreNotOneRecord) {
  const auto file_of = [](const std::filesystem::path& path, double rate, double start,
                          const char* unit) {
    std::vector<double> one, other;
    for (int k = 0; k < samples; ++k) {
      one.push_back(k / 200.0);
      other.push_back(start + k / rate);
    }
    Hdf5File file(path);
    for (const char* group : {"run1", "run2"})
      H5Gclose(H5Gcreate2(file.id(), group, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    const auto list = [&](const char* name, const std::vector<double>& numbers) {
      file.write(name, H5T_NATIVE_DOUBLE, {samples}, numbers.data());
    };
    list("run1/force", wave(3.0, 0.1));
    list("run2/force", wave(2.0, 0.2));
    list("run1/time", one);
    list("run2/time", other);
    if (unit != nullptr) file.attribute("run2/time", "unit", std::string(unit));
  };
  const TemporaryFolder folder;
  const auto path = folder / "two.h5";
  for (const auto& [rate, start] : {std::pair{100.0, 0.0}, {200.0, 100.0}}) {
    file_of(path, rate, start, nullptr);
    EXPECT_THAT(said(path), HasSubstr("the times 'run2/time' are not those of 'run1/time': these "
                                      "are several records"));
  }
  file_of(path, 200.0, 0.0, nullptr);
  EXPECT_EQ(data::read_record(path).record.header.sample_rate, 200.0);
  file_of(path, 0.2, 0.0, "ms");
  EXPECT_EQ(data::read_record(path).record.header.sample_rate, 200.0);
}

TEST(AnalyserFiles, GapsInAListOfTimesAreMissingSamples) {
  const TemporaryFolder folder;
  std::vector<double> time, value;
  for (int k = 0; k < 5000; ++k) {
    if (k >= 3000 && k < 3040) continue;  // behind the first thousand
    time.push_back(2.0 + k / 400.0);
    value.push_back(k);
  }
  write_mat(folder / "t.mat", {numbers("time", time), numbers("y", value)});
  const auto [record, notes] = data::read_record(folder / "t.mat");
  EXPECT_EQ(record.header.sample_rate, 400.0);
  EXPECT_EQ(record.header.start, 2.0);
  ASSERT_EQ(record.samples.rows(), 5000);
  for (int k = 0; k < 5000; ++k) {
    if (k >= 3000 && k < 3040)
      EXPECT_TRUE(std::isnan(record.samples(k, 0)));
    else
      EXPECT_EQ(record.samples(k, 0), k);
  }
  ASSERT_FALSE(notes.empty());
  EXPECT_THAT(notes[0].message, HasSubstr("40 samples at 400 Hz are missing"));
}

TEST(AnalyserFiles, ARateThatTheTimesContradictIsRefused) {
  const TemporaryFolder folder;
  std::vector<double> time;
  for (int k = 0; k < samples; ++k) time.push_back(0.01 * k);
  write_mat(folder / "t.mat",
            {numbers("t", time), numbers("fs", {50.0}), numbers("y", wave(1.0, 0.1))});
  EXPECT_THAT(
      said(folder / "t.mat"),
      HasSubstr("the times make a sample rate of 100 Hz, but the variable 'fs' says 50 Hz"));
}

// HDF5

/// A boolean as h5py has it.
hid_t boolean() {
  const hid_t type = H5Tenum_create(H5T_NATIVE_INT8);
  const std::int8_t no = 0, yes = 1;
  H5Tenum_insert(type, "FALSE", &no);
  H5Tenum_insert(type, "TRUE", &yes);
  return type;
}

struct Row {
  double time;
  float force;
  double acc[3];
  std::int8_t ok;
  std::int16_t count;
};

std::vector<Row> rows() {
  std::vector<Row> all;
  for (int k = 0; k < samples; ++k)
    all.push_back({k / 200.0,
                   static_cast<float>(std::sin(0.2 * k)),
                   {1.0 * k, 2.0 * k, -3.0 * k},
                   static_cast<std::int8_t>(k % 2),
                   static_cast<std::int16_t>(k - 100)});
  return all;
}

hid_t row_type() {
  const hsize_t three = 3;
  const hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(Row));
  H5Tinsert(type, "time", HOFFSET(Row, time), H5T_NATIVE_DOUBLE);
  H5Tinsert(type, "force", HOFFSET(Row, force), H5T_NATIVE_FLOAT);
  H5Tinsert(type, "acc", HOFFSET(Row, acc), H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, &three));
  H5Tinsert(type, "ok", HOFFSET(Row, ok), boolean());
  H5Tinsert(type, "n", HOFFSET(Row, count), H5T_NATIVE_INT16);
  return type;
}

TEST(AnalyserFiles, ACompoundTableIsAChannelPerMember) {
  const TemporaryFolder folder;
  {
    Hdf5File file(folder / "c.h5");
    file.write("run", row_type(), {samples}, rows().data());
    const std::int8_t yes = 1;
    file.write("enabled", boolean(), {}, &yes);
  }
  const auto [record, notes] = data::read_record(folder / "c.h5");
  EXPECT_EQ(record.header.sample_rate, 200.0);
  EXPECT_THAT(channel_names(record),
              ElementsAre("run/force", "run/acc 1", "run/acc 2", "run/acc 3", "run/ok", "run/n"));
  EXPECT_EQ(record.header.channels[0].role, data::Role::excitation);
  EXPECT_EQ(record.header.channels[1].role, data::Role::response);
  ASSERT_EQ(record.samples.rows(), samples);
  for (Eigen::Index k = 0; k < samples; ++k) {
    EXPECT_EQ(record.samples(k, 0), static_cast<double>(rows()[static_cast<std::size_t>(k)].force));
    EXPECT_EQ(record.samples(k, 3), -3.0 * static_cast<double>(k));
    EXPECT_EQ(record.samples(k, 4), static_cast<double>(k % 2));
    EXPECT_EQ(record.samples(k, 5), static_cast<double>(k - 100));
  }
}

TEST(AnalyserFiles, BooleansAndARateAsAttribute) {
  const TemporaryFolder folder;
  {
    Hdf5File file(folder / "b.h5");
    std::vector<std::int8_t> flags;
    for (int k = 0; k < samples; ++k) flags.push_back(k % 3 == 0 ? 1 : 0);
    file.write("flag", boolean(), {samples}, flags.data());
    file.write("x", H5T_NATIVE_DOUBLE, {samples}, wave(1.0, 0.1).data());
    file.write("bits", H5T_NATIVE_B8, {samples}, flags.data());
    file.attribute("x", "fs", 128.0);
  }
  const auto record = data::read_record(folder / "b.h5").record;
  EXPECT_EQ(record.header.sample_rate, 128.0);
  EXPECT_THAT(channel_names(record), ElementsAre("bits", "flag", "x"));
  for (Eigen::Index k = 0; k < samples; ++k) {
    EXPECT_EQ(record.samples(k, 0), k % 3 == 0 ? 1.0 : 0.0);
    EXPECT_EQ(record.samples(k, 1), k % 3 == 0 ? 1.0 : 0.0);
    EXPECT_EQ(record.samples(k, 2), wave(1.0, 0.1)[static_cast<std::size_t>(k)]);
  }
}

TEST(AnalyserFiles, ATableOfPandasHasItsColumnsAndItsIndex) {
  struct Frame {
    std::int64_t index;
    double block[2];
  };
  const TemporaryFolder folder;
  {
    Hdf5File file(folder / "p.h5");
    std::vector<Frame> frames;
    for (int k = 0; k < samples; ++k)  // 2024-03-01, every 10 ms, in ns
      frames.push_back({1709251200000000000 + 10'000'000LL * k, {1.0 * k, -2.0 * k}});
    const hsize_t two = 2;
    const hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(Frame));
    H5Tinsert(type, "index", HOFFSET(Frame, index), H5T_NATIVE_INT64);
    H5Tinsert(type, "values_block_0", HOFFSET(Frame, block),
              H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, &two));
    file.write("table", type, {samples}, frames.data());
    file.attribute("table", "index_kind", std::string("datetime64"));
    file.attribute("table", "values_block_0_kind",
                   std::string("(lp0\nVforce [N]\np1\naVa1\np2\na."));
  }
  const auto record = data::read_record(folder / "p.h5").record;
  EXPECT_EQ(record.header.sample_rate, 100.0);
  EXPECT_THAT(channel_names(record), ElementsAre("force", "a1"));
  EXPECT_THAT(channel_units(record), ElementsAre("N", ""));
  ASSERT_EQ(record.samples.rows(), samples);
  EXPECT_EQ(record.samples(7, 1), -14.0);
}

}  // namespace
}  // namespace hydrapod::test
