/// A sensor or an input that is another in one of several records, or from some time on, is named;
/// sound records, and machines that are not quite the same in all of them, are not accused.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "exact/modal_system.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/tasks/measurement.hpp"
#include "support/run_program.hpp"

namespace hydrapod::tasks {
namespace {

using testing::HasSubstr;
using Kind = data::ResponseWarning::Kind;

test::ModalSystem three_masses(double damping = 0.015) {
  return test::chain(3, 1.3, 4000.0, damping);
}

/// One force, three motions with noise of 2 % or so.
data::Record sound_record(std::uint64_t seed, const test::ModalSystem& all = three_masses(),
                          int samples = 16000) {
  auto system = all;
  for (auto& mode : system.modes) mode.participation = mode.participation.head(1).eval();
  auto record = test::record_of(system, {.sample_rate = 60.0,
                                         .samples = samples,
                                         .output_noise = Eigen::Vector3d(1.0, 1.2, 0.8) * 1e-5,
                                         .seed = seed});
  record.header.channels[0].name = "force";
  for (int o = 1; o <= 3; ++o)
    record.header.channels[static_cast<std::size_t>(o)].name = fmt::format("d{}", o);
  return record;
}

/// Two forces: ten blocks of 4096 samples, halves of some 6 averages.
data::Record record_of_two_forces(std::uint64_t seed) {
  auto system = three_masses(0.02);
  for (auto& mode : system.modes) mode.participation = mode.participation.head(2).eval();
  auto record = test::record_of(system, {.sample_rate = 60.0,
                                         .samples = 40000,
                                         .output_noise = Eigen::Vector3d(1.0, 1.2, 0.8) * 1e-5,
                                         .seed = seed});
  for (int o = 1; o <= 3; ++o)
    record.header.channels[static_cast<std::size_t>(o + 1)].name = fmt::format("d{}", o);
  return record;
}

class SensorChanged : public testing::Test {
 protected:
  [[nodiscard]] std::string written(const char* name, const data::Record& record) const {
    const std::string path = folder_ / name;
    data::write_record(path, record, data::RecordFormat::hdf5);
    return path;
  }
  [[nodiscard]] Identified identified(std::vector<std::string> files) const {
    return identify({.measure = {.files = std::move(files)}, .compare = false});
  }
  static std::vector<data::ResponseWarning> changed_in(const Identified& found) {
    std::vector<data::ResponseWarning> list;
    for (const auto& warning : found.modes.responses.warnings)
      if (warning.kind == Kind::sensor_changed || warning.kind == Kind::input_changed)
        list.push_back(warning);
    return list;
  }

 private:
  test::TemporaryFolder folder_{};
};

TEST_F(SensorChanged, BetweenTwoRecordsSignAndGainAreNamed) {
  for (const double factor : {-1.0, 9.80665, 0.5, 1.3}) {
    auto other = sound_record(2);
    other.samples.col(2) *= factor;
    const auto found = identified({written("p1.h5", sound_record(1)), written("p2.h5", other)});
    const auto changed = changed_in(found);
    ASSERT_EQ(changed.size(), 1U) << factor;
    EXPECT_EQ(changed[0].channel, "d2");
    EXPECT_EQ(changed[0].other, "p2.h5");
    EXPECT_NEAR(changed[0].value / factor, 1.0, 0.03) << factor;
    EXPECT_EQ(changed[0].count, 1);
    EXPECT_EQ(changed[0].total, 3);
    EXPECT_TRUE(std::ranges::any_of(found.warnings, [](const base::Diagnostic& d) {
      return d.message.starts_with("d2 of p2.h5 is ");
    }));
    // frequencies are right; no quality is above the share of sound sensors
    ASSERT_FALSE(found.modes.modes.empty());
    for (const auto& mode : found.modes.modes) EXPECT_LE(mode.quality(), 2.0 / 3.0 + 1e-12);
  }
}

/// A record at a lower level counts by its own.
TEST_F(SensorChanged, BetweenRecordsOfOtherLevelsIsNamed) {
  auto quiet = sound_record(2);
  quiet.samples *= 0.4;
  EXPECT_TRUE(
      changed_in(identified({written("p1.h5", sound_record(1)), written("p2.h5", quiet)})).empty());
  quiet.samples.col(2) *= -1.0;
  const auto changed =
      changed_in(identified({written("p1.h5", sound_record(1)), written("p2.h5", quiet)}));
  ASSERT_EQ(changed.size(), 1U);
  EXPECT_EQ(changed[0].channel, "d2");
  EXPECT_EQ(changed[0].other, "p2.h5");
  EXPECT_NEAR(changed[0].value, -1.0, 0.03);
}

/// Of three records the one that differs is named, also where it is the first.
TEST_F(SensorChanged, TheRecordThatDiffersFromMostIsNamed) {
  for (int wrong = 0; wrong < 3; ++wrong) {
    std::vector<std::string> files;
    for (int k = 0; k < 3; ++k) {
      auto record =
          sound_record(static_cast<std::uint64_t>(10 + k), three_masses(), 24000 + 1700 * k);
      if (k == wrong) record.samples.col(3) *= -1.0;
      files.push_back(written(fmt::format("p{}.h5", k).c_str(), record));
    }
    const auto changed = changed_in(identified(files));
    ASSERT_EQ(changed.size(), 1U) << wrong;
    EXPECT_EQ(changed[0].channel, "d3");
    EXPECT_EQ(changed[0].other, fmt::format("p{}.h5", wrong));
    EXPECT_NEAR(changed[0].value, -1.0, 0.03);
  }
}

TEST_F(SensorChanged, WithinARecordItsTimeIsNamed) {
  auto record = sound_record(4, three_masses(), 100000);
  record.samples.col(1).tail(50000) *= -1.0;
  const auto found = identified({written("run.h5", record)});
  const auto changed = changed_in(found);
  ASSERT_EQ(changed.size(), 1U);
  EXPECT_EQ(changed[0].channel, "d1");
  EXPECT_NEAR(changed[0].lowest, 833.3, 25.0);
  EXPECT_NEAR(changed[0].highest, 1666.7, 25.0);
  EXPECT_TRUE(std::ranges::any_of(found.warnings, [](const base::Diagnostic& d) {
    return d.message.find("in the rest of the record") != std::string::npos;
  }));
}

/// Parts with few averages do for sensors, though not for modes that wander.
TEST_F(SensorChanged, WithinAShortRecordOfTwoForcesItIsNamed) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    auto record = record_of_two_forces(seed);
    EXPECT_TRUE(changed_in(identified({written("sound.h5", record)})).empty()) << seed;
    record.samples.col(3).tail(record.samples.rows() / 2) *= -1.0;
    const auto found = identified({written("run.h5", record)});
    EXPECT_LT(found.modes.responses.averages, 20.0);
    EXPECT_FALSE(found.modes.needed_duration.has_value());
    const auto changed = changed_in(found);
    ASSERT_EQ(changed.size(), 1U) << seed;
    EXPECT_EQ(changed[0].channel, "d2");
    EXPECT_NEAR(changed[0].value, -1.0, 0.05);
  }
}

/// All responses to an input change alike: it is no sensor.
TEST_F(SensorChanged, AnInputThatChangedIsNamed) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed)
    for (const double factor : {-1.0, 1.5, 0.6}) {
      auto record = record_of_two_forces(seed);
      record.samples.col(1).tail(record.samples.rows() / 2) *= factor;
      const auto found = identified({written("run.h5", record)});
      const auto changed = changed_in(found);
      ASSERT_EQ(changed.size(), 1U) << seed << " " << factor;
      EXPECT_EQ(changed[0].kind, Kind::input_changed);
      EXPECT_EQ(changed[0].channel, record.header.channels[1].name);
      EXPECT_NEAR(changed[0].value / factor, 1.0, 0.05);
      EXPECT_EQ(changed[0].count, 1);
      EXPECT_EQ(changed[0].total, 2);
      for (const auto& mode : found.modes.modes) EXPECT_LE(mode.quality(), 0.5 + 1e-12);
      EXPECT_TRUE(std::ranges::any_of(found.warnings, [](const base::Diagnostic& d) {
        return d.message.find("the responses to it are wrong") != std::string::npos;
      }));
    }
}

/// The phases of what was turned round are no clock's, and another gain is no other damping. In the
/// mean over the record nothing may be left, and no mode.
TEST_F(SensorChanged, TheOnlyInputThatChangedIsNamed) {
  for (const double factor : {-1.0, 1.5}) {
    auto record = sound_record(6, three_masses(), 100000);
    record.samples.col(0).tail(50000) *= factor;
    const auto found = identified({written("run.h5", record)});
    const auto changed = changed_in(found);
    ASSERT_EQ(changed.size(), 1U) << factor;
    EXPECT_EQ(changed[0].kind, Kind::input_changed);
    EXPECT_EQ(changed[0].channel, "force");
    EXPECT_NEAR(changed[0].value / factor, 1.0, 0.05);
    for (const auto& warning : found.modes.responses.warnings)
      EXPECT_NE(warning.kind, Kind::two_clocks);
  }
}

TEST_F(SensorChanged, AnInputThatChangedBetweenRecordsIsNamed) {
  auto other = record_of_two_forces(8);
  other.samples.col(0) *= -1.0;
  const auto changed =
      changed_in(identified({written("p1.h5", record_of_two_forces(7)), written("p2.h5", other)}));
  ASSERT_EQ(changed.size(), 1U);
  EXPECT_EQ(changed[0].kind, Kind::input_changed);
  EXPECT_EQ(changed[0].channel, other.header.channels[0].name);
  EXPECT_EQ(changed[0].other, "p2.h5");
  EXPECT_NEAR(changed[0].value, -1.0, 0.05);
}

/// Of records with too few blocks for modes, in shorter ones; also of those that are identified in
/// one piece.
TEST_F(SensorChanged, InAShortRecordItIsNamedToo) {
  for (const int samples : {12000, 20000})
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      auto record = record_of_two_forces(seed);
      record.samples = record.samples.topRows(samples).eval();
      EXPECT_TRUE(changed_in(identified({written("sound.h5", record)})).empty()) << seed;
      for (const int channel : {1, 3}) {
        auto turned = record;
        turned.samples.col(channel).tail(samples / 2) *= -1.0;
        const auto found = identified({written("run.h5", turned)});
        EXPECT_FALSE(found.modes.needed_duration.has_value());
        const auto changed = changed_in(found);
        ASSERT_EQ(changed.size(), 1U) << samples << " " << seed << " " << channel;
        EXPECT_EQ(changed[0].kind, channel == 1 ? Kind::input_changed : Kind::sensor_changed);
        EXPECT_EQ(changed[0].channel,
                  record.header.channels[static_cast<std::size_t>(channel)].name);
        EXPECT_NEAR(changed[0].value, -1.0, 0.1);
      }
    }
}

/// What was not tested is said, and how long a record would do.
TEST_F(SensorChanged, ARecordTooShortForItSaysSo) {
  IdentifyOptions options{.measure = {.files = {written("run.h5", record_of_two_forces(4))}},
                          .compare = false};
  options.measure.estimate.block_length = 8192;
  const auto found = identify(options);
  EXPECT_TRUE(changed_in(found).empty());
  ASSERT_TRUE(found.modes.needed_duration.has_value());
  EXPECT_GT(*found.modes.needed_duration, 40000.0 / 60.0);
  EXPECT_LT(*found.modes.needed_duration, 4000.0);
}

/// Of the half in which it changed it is the mean that is compared, so that the size of the factor
/// is none of the sensor; its sign is.
TEST_F(SensorChanged, WithinAHalfOfARecordItIsNamed) {
  auto record = sound_record(5, three_masses(), 100000);
  record.samples.col(1).tail(60000) *= -1.0;
  const auto changed = changed_in(identified({written("run.h5", record)}));
  ASSERT_EQ(changed.size(), 1U);
  EXPECT_EQ(changed[0].channel, "d1");
  EXPECT_LT(changed[0].value, 0.0);
}

TEST_F(SensorChanged, SoundRecordsAreNotAccused) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const auto found =
        identified({written("p1.h5", sound_record(100 + seed)),
                    written("p2.h5", sound_record(200 + seed, three_masses(), 11000))});
    EXPECT_TRUE(changed_in(found).empty()) << seed;
  }
}

/// Another level gives another damping, another temperature another stiffness: no sensor changed.
TEST_F(SensorChanged, AMachineThatChangedIsNoSensorThatChanged) {
  for (const double stiffness : {4000.0, 4080.0})
    for (const double damping : {0.015, 0.022}) {
      const auto found =
          identified({written("p1.h5", sound_record(7)),
                      written("p2.h5", sound_record(8, test::chain(3, 1.3, stiffness, damping)))});
      EXPECT_TRUE(changed_in(found).empty()) << stiffness << " " << damping;
    }
}

TEST_F(SensorChanged, OtherUnitsAreRefused) {
  auto other = sound_record(2);
  other.header.channels[2].unit = "m/s^2";
  try {
    std::ignore = identified({written("p1.h5", sound_record(1)), written("p2.h5", other)});
    FAIL() << "not refused";
  } catch (const base::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("d2 is in m/s^2 and in"));
  }
  other.header.channels[2].unit = "m";
  other.header.channels[1].unit = "m s^-2";
  auto first = sound_record(1);
  first.header.channels[1].unit = "m/s^2";  // another spelling
  EXPECT_TRUE(changed_in(identified({written("p1.h5", first), written("p2.h5", other)})).empty());
}

/// Two records of a minute are too short for the test of longer ones: blocks of half the length
/// tell whether a resonance is elsewhere in the second.
TEST_F(SensorChanged, ButAMachineThatChangedBetweenShortRecordsIsNamed) {
  const auto wandering_between = [&](double factor, std::uint64_t seed) {
    auto other = three_masses();
    for (auto& mode : other.modes) mode.pole *= factor;
    const auto found = identified({written("p1.h5", sound_record(seed, three_masses(), 3600)),
                                   written("p2.h5", sound_record(seed + 1, other, 3600))});
    EXPECT_TRUE(changed_in(found).empty());
    return std::ranges::count(found.modes.warnings, identification::ModeWarning::Kind::wanders,
                              &identification::ModeWarning::kind);
  };
  for (std::uint64_t seed = 31; seed < 37; seed += 2) {
    EXPECT_EQ(wandering_between(1.0, seed), 0) << seed;
    EXPECT_GE(wandering_between(0.991, seed), 2) << seed;
  }
}

}  // namespace
}  // namespace hydrapod::tasks
