/// MAT files that GNU Octave 7.3 wrote (tests/data/files/make_octave_files.m): plain and
/// compressed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hydrapod/data/record_io.hpp"
#include "said.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

constexpr double octave_rate = 512.0;
constexpr Eigen::Index samples = 700;
constexpr double ulps = 4e-16;  // Octave's sin and ours may differ in the last bit

data::ReadRecordResult octave(const std::string& name, const data::ReadOptions& options = {}) {
  return data::read_record(source_file("tests/data/files/" + name), options);
}

std::vector<std::string> names(const data::Record& record) {
  std::vector<std::string> list;
  for (const auto& channel : record.header.channels) list.push_back(channel.name);
  return list;
}

double time(Eigen::Index k) { return static_cast<double>(k) / octave_rate; }
double x(Eigen::Index k) { return 1e-3 * std::sin(2.0 * std::numbers::pi * 17.25 * time(k)); }

class Columns : public testing::TestWithParam<const char*> {};

TEST_P(Columns, AreChannelsOfTheLengthOfTheTimes) {
  const auto [record, notes] = octave(GetParam());
  EXPECT_THAT(messages(notes),
              testing::ElementsAre("roles by the names and units of the channels: excitation: "
                                   "forces 1, forces 2, forces 3; other: x, y, counts; --inputs "
                                   "and --outputs name others"));
  EXPECT_EQ(record.header.sample_rate, octave_rate);
  EXPECT_EQ(record.header.start, 0.0);
  EXPECT_THAT(names(record),
              testing::ElementsAre("x", "y", "counts", "forces 1", "forces 2", "forces 3"));
  ASSERT_EQ(record.samples.rows(), samples);
  for (Eigen::Index k = 0; k < samples; ++k) {
    EXPECT_NEAR(record.samples(k, 0), x(k), ulps);
    const auto single =
        static_cast<double>(static_cast<float>(std::cos(2.0 * std::numbers::pi * 3.5 * time(k))));
    EXPECT_NEAR(record.samples(k, 1), single, 6e-8);  // one unit of single precision
    EXPECT_EQ(record.samples(k, 2), std::round(1000.0 * std::sin(time(k))));
    EXPECT_EQ(record.samples(k, 3), time(k));
    EXPECT_EQ(record.samples(k, 4), 2.0 * time(k));
    EXPECT_EQ(record.samples(k, 5), -3.0 * time(k));
  }
}

INSTANTIATE_TEST_SUITE_P(Octave, Columns, testing::Values("columns_v6.mat", "columns_v7.mat"));

TEST(OctaveFiles, NamesAndUnitsOfRowsAreHonoured) {
  const auto [record, notes] = octave("rows_v7.mat");
  EXPECT_THAT(messages(notes),
              testing::ElementsAre("channel \"valve 1\": \"mA\" converted to \"A\", times 0.001",
                                   "channel \"valve 2\": \"bar\" converted to \"Pa\", times 100000",
                                   "channel \"Prüfling\": \"mm\" converted to \"m\", times 0.001",
                                   "roles by the names and units of the channels: drive: valve 1; "
                                   "response: valve 2, Prüfling; --inputs and --outputs name "
                                   "others"));
  EXPECT_EQ(record.header.title, "Prüfstand");
  EXPECT_THAT(names(record), testing::ElementsAre("valve 1", "valve 2", "Prüfling"));
  ASSERT_EQ(record.samples.rows(), samples);
  for (Eigen::Index k = 0; k < samples; ++k) {
    EXPECT_EQ(record.samples(k, 0), time(k) * 0.001);
    EXPECT_EQ(record.samples(k, 1), 2.0 * time(k) * 100000.0);
    EXPECT_EQ(record.samples(k, 2), -3.0 * time(k) * 0.001);
  }
}

class Structures : public testing::TestWithParam<const char*> {};

TEST_P(Structures, AreOpenedAndTheRestIsNamed) {
  const auto [record, notes] = octave(GetParam());
  EXPECT_THAT(messages(notes),
              testing::ElementsAre("variable 's' is of class 5, which is not read: left out",
                                   "'z' is complex, and samples are real numbers (write its real "
                                   "and its imaginary part as two arrays): left out"));
  EXPECT_EQ(record.header.sample_rate, octave_rate);  // from rig.dt
  EXPECT_THAT(names(record),
              testing::ElementsAre("rig.channels 1", "rig.channels 2", "rig.channels 3"));
  ASSERT_EQ(record.samples.rows(), samples);
  for (Eigen::Index k = 0; k < samples; ++k) EXPECT_EQ(record.samples(k, 2), -3.0 * time(k));
}

INSTANTIATE_TEST_SUITE_P(Octave, Structures,
                         testing::Values("structure_v6.mat", "structure_v7.mat"));

TEST(OctaveFiles, RowVectorsAreChannelsToo) {
  const auto [record, notes] = octave("row_vectors_v6.mat");
  EXPECT_THAT(messages(notes), testing::ElementsAre("variable 'odd' is 3 × 5 and not of the "
                                                    "record's length of 700: left out"));
  EXPECT_EQ(record.header.sample_rate, octave_rate);
  ASSERT_EQ(record.samples.rows(), samples);
  for (Eigen::Index k = 0; k < samples; ++k) EXPECT_NEAR(record.samples(k, 0), x(k), ulps);
}

}  // namespace
}  // namespace hydrapod::test
