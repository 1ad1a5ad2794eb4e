/// Channels of other programs: units as people write them, what is not used is said.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <vector>

#include "hydrapod/data/record_io.hpp"
#include "library_files.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

struct ReadForeign {
  data::Record record{};
  std::vector<std::string> said{};
};

ReadForeign read_foreign(const std::string& path) {
  const auto [record, notes] = data::read_record(path);
  ReadForeign all{.record = record};
  for (const auto& note : notes) all.said.push_back(note.message);
  return all;
}

ReadForeign table(const std::string& text) {
  const TemporaryFolder folder;
  write_text(folder / "t.csv", text);
  return read_foreign(folder / "t.csv");
}

TEST(ForeignChannels, UnitsAreThoseOfVibrations) {
  struct Case {
    const char* written;
    double factor;
    const char* unit;
  };
  for (const Case& c :
       {Case{"g", 9.80665, "m/s^2"}, Case{"G", 9.80665, "m/s^2"}, Case{"mg", 9.80665e-3, "m/s^2"},
        Case{"µg", 9.80665e-6, "m/s^2"}, Case{"ms-2", 1.0, "m/s^2"}, Case{"ms^-2", 1.0, "m/s^2"},
        Case{"m/s**2", 1.0, "m/s^2"}, Case{"mms-2", 1e-3, "m/s^2"}, Case{"ms-1", 1.0, "m/s"},
        Case{"g/s", 9.80665, "m/s^3"}, Case{"mg / ms", 9.80665, "m/s^3"},
        Case{"g s^-1", 9.80665, "m/s^3"}, Case{"kg/s", 1.0, "kg/s"}, Case{"kp", 9.80665, "N"},
        Case{"kg", 1.0, "kg"}, Case{"ms", 1e-3, "s"}}) {
    SCOPED_TRACE(c.written);
    const auto got =
        table("time [s],q [" + std::string(c.written) + "]\n0,2.5\n0.01,-3.25\n0.02,1\n");
    EXPECT_EQ(got.record.header.channels[0].unit, c.unit);
    EXPECT_NEAR(got.record.samples(1, 0), -3.25 * c.factor, 1e-12 * c.factor);
  }
}

TEST(ForeignChannels, WhatStandsBehindAUnitIsNoFactor) {
  struct Case {
    const char* written;
    double factor;
    const char* unit;
  };
  for (const Case& c : {Case{"bar(g)", 1e5, "Pa"}, Case{"bar (a)", 1e5, "Pa"},
                        Case{"bar g", 1e5, "Pa"}, Case{"psig", 6894.757293168361, "Pa"},
                        Case{"kPa abs", 1e3, "Pa"}, Case{"m/s2 pk", 1.0, "m/s2"},
                        Case{"mm/s rms", 1e-3, "m/s"}, Case{"g pk-pk", 9.80665, "m/s^2"}}) {
    SCOPED_TRACE(c.written);
    const auto got =
        table("time [s],q [" + std::string(c.written) + "]\n0,2.5\n0.01,-3.25\n0.02,1\n");
    EXPECT_EQ(got.record.header.channels[0].unit, c.unit);
    EXPECT_NEAR(got.record.samples(1, 0), -3.25 * c.factor, 1e-9 * c.factor);
    EXPECT_THAT(got.said, Contains(HasSubstr("behind its unit is left aside")));
  }
  for (const std::string unit : {"m/s2 pk2", "N min", "pk", "N a"}) {
    SCOPED_TRACE(unit);
    const auto got = table("time [s],q [" + unit + "]\n0,2.5\n0.01,-3.25\n0.02,1\n");
    EXPECT_EQ(got.record.samples(1, 0), -3.25);
    EXPECT_EQ(got.record.header.channels[0].unit, "");
    EXPECT_THAT(got.said, Contains(HasSubstr("is not known")));
  }
}

TEST(ForeignChannels, PoundsAreForcesWhereTheNameOrALengthSaysSo) {
  constexpr double lbf = 4.4482216152605, foot = 0.3048;
  const auto got = table(
      "time [s],force [lb],F2 [lbs],crate [lb],torque [ft-lb],M [lb-in]\n"
      "0,1,2,3,4,5\n0.01,2,1,4,3,9\n0.02,5,3,1,1,2\n");
  std::vector<std::string> units;
  for (const auto& channel : got.record.header.channels) units.push_back(channel.unit);
  EXPECT_THAT(units, testing::ElementsAre("N", "N", "kg", "N m", "N m"));
  EXPECT_NEAR(got.record.samples(2, 0), 5.0 * lbf, 1e-12);
  EXPECT_NEAR(got.record.samples(1, 1), lbf, 1e-12);
  EXPECT_NEAR(got.record.samples(1, 2), 4.0 * 0.45359237, 1e-12);
  EXPECT_NEAR(got.record.samples(1, 3), 3.0 * foot * lbf, 1e-12);
  EXPECT_NEAR(got.record.samples(1, 4), 9.0 * foot / 12.0 * lbf, 1e-12);
  EXPECT_THAT(got.said, Contains(HasSubstr("\"force\": \"lb\" is taken for lbf")));
}

TEST(ForeignChannels, TimesInHdf5WithoutAUnitThatMakeASlowRateAreNamed) {
  const TemporaryFolder folder;
  for (const std::string unit : {"", "ms"}) {
    const std::string path = folder / ("t" + unit + ".h5");
    {
      Hdf5File file(path);
      std::vector<double> times(40), values(40);
      for (std::size_t k = 0; k < times.size(); ++k) {
        times[k] = 3.90625 * static_cast<double>(k);
        values[k] = 0.37 * static_cast<double>(k % 7);
      }
      file.write("time", H5T_NATIVE_DOUBLE, {times.size()}, times.data());
      file.write("a1", H5T_NATIVE_DOUBLE, {values.size()}, values.data());
      if (!unit.empty()) file.attribute("time", "units", unit);
    }
    const auto got = read_foreign(path);
    const auto slow = Contains(HasSubstr("taken for seconds, which makes 0.256 Hz"));
    if (unit.empty())
      EXPECT_THAT(got.said, slow);
    else
      EXPECT_THAT(got.said, Not(slow));
  }
}

TEST(ForeignChannels, TimesWithoutAUnitThatMakeASlowRateAreNamed) {
  const std::string rows = "0,1\n3.90625,2\n7.8125,4\n11.71875,3\n";
  EXPECT_THAT(table("time,a\n" + rows).said,
              Contains(HasSubstr("the times have no unit and are taken for seconds, which makes "
                                 "0.256 Hz")));
  EXPECT_THAT(table("time [s],a\n" + rows).said, Not(Contains(HasSubstr("no unit"))));
  EXPECT_EQ(table("time [ms],a\n" + rows).record.header.sample_rate, 256.0);
  EXPECT_THAT(table("time,a\n0,1\n0.25,2\n0.5,4\n").said, Not(Contains(HasSubstr("no unit"))));
}

TEST(ForeignChannels, ManySamplesAtASlowRateAreNamed) {
  std::string rows;
  for (int k = 0; k < 2000; ++k) rows += fmt::format("{},{}\n", 0.25 * k, k % 7);
  const auto slow = Contains(HasSubstr("taken for seconds, which makes 4 Hz"));
  EXPECT_THAT(table("time,a\n" + rows).said, slow);
  EXPECT_THAT(table("time [s],a\n" + rows).said, Not(slow));
}

TEST(ForeignChannels, LettersForForcesAndInputsAreInputs) {
  const auto got =
      table("time,F,u2,y 1,y 2,data.f1\n0,1,2,3,4,5\n0.01,2,1,4,3,9\n0.02,5,3,1,1,2\n");
  std::vector<data::Role> roles;
  for (const auto& channel : got.record.header.channels) roles.push_back(channel.role);
  using enum data::Role;
  EXPECT_THAT(roles, testing::ElementsAre(excitation, excitation, response, response, excitation));
  // a displacement is often called u
  EXPECT_EQ(table("time,u [mm]\n0,1\n0.01,2\n").record.header.channels[0].role, response);
}

void put_texts(hid_t object, const char* name, const std::vector<const char*>& texts) {
  const hsize_t count = texts.size();
  const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate_simple(1, &count, nullptr);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  ASSERT_GE(H5Awrite(attribute, type, texts.data()), 0);
  H5Aclose(attribute);
  H5Sclose(space);
  H5Tclose(type);
}

void put_number(hid_t object, const char* name, double value) {
  const hid_t space = H5Screate(H5S_SCALAR);
  const hid_t attribute = H5Acreate2(object, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT);
  ASSERT_GE(H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value), 0);
  H5Aclose(attribute);
  H5Sclose(space);
}

/// A table of three columns in an HDF5 file, as h5py makes it.
ReadForeign table_in_hdf5(hid_t type, const std::vector<const char*>& units, const char* scale) {
  const TemporaryFolder folder;
  const std::string path = folder / "t.h5";
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  put_number(file, "fs", 40.0);
  const hsize_t size[2] = {50, 3};
  std::vector<double> values(150);
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = static_cast<double>((k * 37) % 101);
  const hid_t space = H5Screate_simple(2, size, nullptr);
  const hid_t set = H5Dcreate2(file, "acc", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  EXPECT_GE(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  if (!units.empty()) put_texts(set, "units", units);
  if (scale != nullptr) put_number(set, scale, 0.0025);
  H5Dclose(set);
  H5Sclose(space);
  H5Fclose(file);
  return read_foreign(path);
}

TEST(ForeignChannels, AnHdf5TableHasAUnitForEachColumn) {
  const auto got = table_in_hdf5(H5T_IEEE_F64LE, {"mm/s²", "m/s^2", "g"}, nullptr);
  ASSERT_EQ(got.record.samples.cols(), 3);
  for (const auto& channel : got.record.header.channels) EXPECT_EQ(channel.unit, "m/s^2");
  EXPECT_NEAR(got.record.samples(1, 0), 1e-3 * 10.0, 1e-12);  // 3 · 37 mod 101
  EXPECT_NEAR(got.record.samples(1, 1), 47.0, 1e-12);
  EXPECT_NEAR(got.record.samples(1, 2), 9.80665 * 84.0, 1e-9);
  EXPECT_THAT(table_in_hdf5(H5T_IEEE_F64LE, {"g", "g"}, nullptr).said,
              Contains(HasSubstr("variable 'acc' has 2 units for 3 channels: not used")));
}

/// A list of one channel has a unit of its own; a table has one for each column.
TEST(ForeignChannels, TwoUnitsThatContradictEachOtherAreSaid) {
  const TemporaryFolder folder;
  const double rate = 100.0;
  const std::vector<double> values{1.0, 3.5, 2.0, 0.25};
  {
    Hdf5File file(folder / "p.h5");
    file.write("fs", H5T_NATIVE_DOUBLE, {}, &rate);
    file.write("p", H5T_NATIVE_DOUBLE, {4}, values.data());
    file.attribute("p", "unit", "bar");
    file.attribute("p", "units", "Pa");
  }
  const auto list = read_foreign(folder / "p.h5");
  EXPECT_EQ(list.record.header.channels[0].unit, "Pa");
  EXPECT_EQ(list.record.samples(1, 0), 3.5e5);
  EXPECT_THAT(list.said, Contains(HasSubstr("variable 'p' has the unit \"bar\" by its attribute "
                                            "'unit' and \"Pa\" by 'units': 'unit' is used")));
  {
    Hdf5File file(folder / "t.h5");
    file.write("fs", H5T_NATIVE_DOUBLE, {}, &rate);
    file.write("p", H5T_NATIVE_DOUBLE, {2, 2}, values.data());
    file.attribute("p", "unit", "bar");
    const hid_t set = H5Dopen2(file.id(), "p", H5P_DEFAULT);
    put_texts(set, "units", {"bar", "N"});
    H5Dclose(set);
  }
  const auto table = read_foreign(folder / "t.h5");
  EXPECT_EQ(table.record.samples(1, 0), 2e5);
  EXPECT_EQ(table.record.samples(1, 1), 0.25);
  EXPECT_THAT(table.said, Contains(HasSubstr("\"N\" by 'units': 'units' is used")));
  {
    Hdf5File file(folder / "s.h5");
    file.write("fs", H5T_NATIVE_DOUBLE, {}, &rate);
    file.write("p", H5T_NATIVE_DOUBLE, {4}, values.data());
    file.attribute("p", "unit", "bar");
    file.attribute("p", "units", "bar");
  }
  EXPECT_THAT(read_foreign(folder / "s.h5").said, Not(Contains(HasSubstr("by 'units'"))));
}

TEST(ForeignChannels, CountsWithAScaleAreSaidToBeCounts) {
  EXPECT_THAT(table_in_hdf5(H5T_STD_I16LE, {}, "scale_factor").said,
              Contains(HasSubstr("'acc' has the attribute scale_factor, which is not used")));
  EXPECT_THAT(table_in_hdf5(H5T_IEEE_F64LE, {}, "scale_factor").said,
              Not(Contains(HasSubstr("scale_factor"))));
}

}  // namespace
}  // namespace hydrapod::test
