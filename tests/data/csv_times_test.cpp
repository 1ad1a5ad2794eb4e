/// Tables whose times have gaps, scatter, are coarse, or are stamps of a calendar.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hydrapod/base/units.hpp"
#include "hydrapod/data/record_io.hpp"
#include "said.hpp"
#include "support/random.hpp"
#include "support/run_program.hpp"

namespace hydrapod::test {
namespace {

using base::two_pi;
using testing::HasSubstr;

data::ReadRecordResult table(const std::string& text, const data::ReadOptions& options = {}) {
  const TemporaryFolder folder;
  write_text(folder / "r.csv", text);
  return data::read_record(folder / "r.csv", options);
}

base::Diagnostic problem(const std::string& text, const data::ReadOptions& options = {}) {
  return refusal_of([&] { table(text, options); });
}

/// 1, 2, 3 … at k / rate, without the samples of which `lost` is true.
template <class Lost>
std::string counted(int samples, double rate, int decimals, const Lost& lost) {
  std::string text = "time [s],x\n";
  for (int k = 0; k < samples; ++k)
    if (!lost(k)) text += fmt::format("{:.{}f},{}\n", k / rate, decimals, k + 1);
  return text;
}

void expect_counted(const data::Record& record, int samples, const std::function<bool(int)>& lost) {
  ASSERT_EQ(record.samples.rows(), samples);
  for (int k = 0; k < samples; ++k) {
    if (lost(k))
      EXPECT_TRUE(std::isnan(record.samples(k, 0))) << k;
    else
      EXPECT_EQ(record.samples(k, 0), k + 1) << k;
  }
}

TEST(CsvTimes, GapsBecomeMissingSamplesOnTheGrid) {
  const auto lost = [](int k) { return (k >= 700 && k < 733) || k == 900 || k == 2001; };
  const auto [record, notes] = table(counted(3000, 256.0, 6, lost));
  EXPECT_EQ(record.header.sample_rate, 256.0);
  expect_counted(record, 3000, lost);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].message,
            "the times have 3 gaps, the first before 2.863281 s: 35 samples at 256 Hz are missing");
  EXPECT_EQ(notes[0].line, 702U);
}

TEST(CsvTimes, TwoPerCentOfLostSamplesInWholeMilliseconds) {
  Random random(17);
  std::vector<bool> gone;
  for (int k = 0; k < 5000; ++k)
    gone.push_back(k > 0 && k < 4999 && random.uniform(0.0, 1.0) < 0.02);
  const auto lost = [&](int k) { return static_cast<bool>(gone[static_cast<std::size_t>(k)]); };
  std::string text = "t [ms];x\n";
  for (int k = 0; k < 5000; ++k)
    if (!lost(k)) text += fmt::format("{};{}\n", k, k + 1);
  const auto record = table(text).record;
  EXPECT_EQ(record.header.sample_rate, 1000.0);
  expect_counted(record, 5000, lost);
}

TEST(CsvTimes, ARateFromOutsideDoesNotHideAGap) {
  const auto lost = [](int k) { return k >= 10 && k < 15; };
  const auto text = counted(40, 100.0, 3, lost);
  expect_counted(table(text, {.sample_rate = 100.0}).record, 40, lost);
  const auto refused = problem(text, {.sample_rate = 50.0});
  EXPECT_THAT(refused.message,
              HasSubstr("the times make a sample rate of 100 Hz, but --rate 50 says "
                        "50 Hz"));
}

/// Rows whose time is missing are samples all the same: they count in the step, and in the grid.
TEST(CsvTimes, RowsWithoutATimeAreSamples) {
  std::string text = "time [s],x\n";
  for (int k = 0; k < 1200; ++k)
    text += k % 3 == 1 ? fmt::format(",{}\n", k + 1) : fmt::format("{:.4f},{}\n", k / 320.0, k + 1);
  const auto record = table(text).record;
  EXPECT_NEAR(record.header.sample_rate, 320.0, 1e-6 * 320.0);
  expect_counted(record, 1200, [](int) { return false; });
}

TEST(CsvTimes, AUnitBehindAnUnderscore) {
  const auto no_gap = [](int) { return false; };
  for (const auto& [title, rate] : {std::pair{"time_s", 1.0}, {"t_ms", 1e3}, {"Zeit_s", 1.0}}) {
    std::string text = std::string(title) + ",force\n";
    for (int k = 0; k < 300; ++k) text += fmt::format("{},{}\n", 4 * k, k + 1);
    const auto record = table(text).record;
    EXPECT_EQ(record.header.sample_rate, 0.25 * rate) << title;
    EXPECT_EQ(record.header.channels.size(), 1U) << title;
    expect_counted(record, 300, no_gap);
  }
  EXPECT_THAT(problem("first_s,force\n0,1\n4,2\n").message, HasSubstr("no column of times"));
}

TEST(CsvTimes, RoundedTimesOfARateThatDoesNotSuitThem) {
  // 700 Hz in whole milliseconds: steps of 1 and 2 ms are no gaps
  const auto record = table(counted(20000, 700.0, 3, [](int) { return false; })).record;
  EXPECT_NEAR(record.header.sample_rate, 700.0, 700.0 * 1e-4);
  expect_counted(record, 20000, [](int) { return false; });
}

TEST(CsvTimes, TimesThatAreTooCoarseForARateAskForIt) {
  // 77 Hz with whole seconds: known to some per cent only
  const auto text = counted(2000, 77.3, 0, [](int) { return false; });
  EXPECT_THAT(problem(text).message, HasSubstr("too coarse for a sample rate"));
  EXPECT_THAT(problem(text).message, HasSubstr("--rate"));
  EXPECT_EQ(table(text, {.sample_rate = 77.3}).record.header.sample_rate, 77.3);
}

TEST(CsvTimes, FewSignificantDigitsAreNoGaps) {
  std::string text = "t,x\n";  // five digits: from 100 s on, two or three samples have one time
  for (int k = 0; k < 50000; ++k) text += fmt::format("{:.5g},{}\n", k / 250.0, k + 1);
  const auto record = table(text).record;
  EXPECT_EQ(record.header.sample_rate, 250.0);
  expect_counted(record, 50000, [](int) { return false; });
}

/// Samples of a sine at times that scatter.
std::string scattered(double jitter, int samples, double rate, double frequency) {
  Random random(5);
  std::string text = "time,x [m]\n";
  for (int k = 0; k < samples; ++k) {
    const double t = (k + random.uniform(-jitter, jitter)) / rate;
    text += fmt::format("{:.9f},{:.12g}\n", t, std::sin(two_pi * frequency * t));
  }
  return text;
}

TEST(CsvTimes, JitterIsInterpolatedWithANotice) {
  const auto [record, notes] = table(scattered(0.25, 4000, 200.0, 9.3));
  EXPECT_NEAR(record.header.sample_rate, 200.0, 200.0 * 0.5 / 4000.0);
  ASSERT_EQ(notes.size(), 2U);  // the other one says the roles
  EXPECT_THAT(notes[1].message, HasSubstr("the samples are interpolated at"));
  double worst = 0.0;
  const auto& header = record.header;
  for (Eigen::Index k = 2; k + 3 < record.samples.rows(); ++k) {
    const double t = header.start + static_cast<double>(k) / header.sample_rate;
    worst = std::max(worst, std::abs(record.samples(k, 0) - std::sin(two_pi * 9.3 * t)));
  }
  // as they stand, the samples are off by up to 0.25 steps, 7 % at this frequency; cubic
  // interpolation over knots up to 1.5 steps apart leaves (ω·1.5 h)⁴·3/128 at most
  const double knots = 1.5 * two_pi * 9.3 / 200.0;
  EXPECT_LT(worst, std::pow(knots, 4) * 3.0 / 128.0 * 1.5);
  // at the ends along a straight line, which leaves (ω·1.5 h)²/8
  for (const Eigen::Index k : {Eigen::Index{1}, record.samples.rows() - 2}) {
    const double t = header.start + static_cast<double>(k) / header.sample_rate;
    EXPECT_NEAR(record.samples(k, 0), std::sin(two_pi * 9.3 * t), knots * knots / 8.0) << k;
  }
  EXPECT_GE(record.samples.rows(), 3998);
}

TEST(CsvTimes, TimesWithoutAGridAreRefusedAndTheOptionIsNamed) {
  Random random(3);
  std::string text = "time,x\n";
  double t = 0.0;
  for (int k = 0; k < 500; ++k) {
    t += random.uniform(0.001, 0.02);
    text += fmt::format("{:.6f},{:.9g}\n", t, std::sin(3.0 * t));
  }
  EXPECT_THAT(problem(text).message, HasSubstr("not evenly spaced"));
  EXPECT_THAT(problem(text).message, HasSubstr("--rate"));
  const auto record = table(text, {.sample_rate = 50.0}).record;
  EXPECT_EQ(record.header.sample_rate, 50.0);
  double worst = 0.0;
  for (Eigen::Index k = 2; k + 3 < record.samples.rows(); ++k)
    worst = std::max(
        worst, std::abs(record.samples(k, 0) -
                        std::sin(3.0 * (record.header.start + 0.02 * static_cast<double>(k)))));
  EXPECT_LT(worst, 1e-5);  // 3 rad/s over steps of 0.02 s: (0.06)⁴/40
}

TEST(CsvTimes, NothingIsInterpolatedOverAGap) {
  std::string text = scattered(0.2, 400, 100.0, 2.0);
  const std::size_t from = text.find("\n1.5"), to = text.find("\n2.5");
  ASSERT_LT(from, to);
  text.erase(from, to - from);
  const auto record = table(text).record;
  // beside the gap along a straight line, over 1.4 steps at most: (ω·1.4 h)²/8
  const double beside = std::pow(two_pi * 2.0 * 1.4 / 100.0, 2) / 8.0;
  int missing = 0;
  for (Eigen::Index k = 0; k < record.samples.rows(); ++k) {
    const double t = record.header.start + static_cast<double>(k) / record.header.sample_rate;
    if (std::isnan(record.samples(k, 0)))
      ++missing;
    else
      EXPECT_NEAR(record.samples(k, 0), std::sin(two_pi * 2.0 * t), beside) << k;
  }
  EXPECT_NEAR(missing, 100, 2);
  EXPECT_NEAR(static_cast<double>(record.samples.rows()), 400.0, 2.0);
}

TEST(CsvTimes, TimesThatGoBackAreTwoRecords) {
  const auto refused = problem("t,x\n0,1\n1,2\n2,3\n0,4\n1,5\n");
  EXPECT_THAT(refused.message, HasSubstr("the time goes back from 2 s to 0 s"));
  EXPECT_EQ(refused.line, 5U);
  EXPECT_THAT(problem("t,x\n0,1\n1,2\n2,3\n3,4\n1e6,5\n").message,
              HasSubstr("several records in one file"));
}

TEST(CsvTimes, StampsOfEveryForm) {
  for (const char* form : {"2024-03-01T10:00:0{}", "2024-03-01 10:00:0{}", "2024-03-01T10:00:0{}Z",
                           "2024-03-01T10:00:0{}+01:00", "2024-03-01 10:00:0{}-0530"}) {
    std::string text = "stamp;a [m]\n";
    for (int k = 0; k < 50; ++k) {
      const std::string stamp = form;
      const std::size_t at = stamp.find("{}");
      text += stamp.substr(0, at) + fmt::format("{:.2f}", 0.02 * k) + stamp.substr(at + 2) +
              fmt::format(";{},{}\n", k, 5);
    }
    const auto record = table(text).record;
    EXPECT_EQ(record.header.sample_rate, 50.0) << form;
    EXPECT_EQ(record.header.start, 0.0);
    ASSERT_EQ(record.header.channels.size(), 1U);
    EXPECT_EQ(record.header.channels[0].name, "a");
    EXPECT_THAT(record.header.date, testing::StartsWith("2024-03-01T10:00:00"));
    ASSERT_EQ(record.samples.rows(), 50);
    EXPECT_EQ(record.samples(49, 0), 49.5);  // a decimal comma
  }
}

TEST(CsvTimes, StampsWithoutAFractionOverMidnightWithAGap) {
  std::string text = "timestamp,x\n";
  for (int k = 0; k < 20; ++k)
    if (k != 12) text += fmt::format("2023-12-31T23:59:{:02d},{}\n", 40 + k, k + 1);
  text += "2024-01-01T00:00:00,21\n2024-01-01T00:00:01,22\n";
  const auto record = table(text).record;
  EXPECT_EQ(record.header.sample_rate, 1.0);
  expect_counted(record, 22, [](int k) { return k == 12; });
}

/// The night in which clocks are put back: 2:59 is followed by 2:00, an hour nearer to Greenwich.
TEST(CsvTimes, StampsWhoseZoneChanges) {
  std::string text = "timestamp,x\n";
  for (int k = 0; k < 20; ++k)
    text += fmt::format("2026-10-25T02:59:{:04.1f}+02:00,{}\n", 58.0 + 0.1 * k, k + 1);
  for (int k = 0; k < 20; ++k)
    text += fmt::format("2026-10-25T02:00:{:04.1f}+01:00,{}\n", 0.1 * k, k + 21);
  const auto record = table(text).record;
  EXPECT_EQ(record.header.sample_rate, 10.0);
  expect_counted(record, 40, [](int) { return false; });
}

TEST(CsvTimes, DateAndTimeInTwoColumns) {
  const auto record = table(
                          "date time a b\n2024-03-01 10:00:00.0 1 2\n2024-03-01 10:00:00.1 3 4\n"
                          "2024-03-01 10:00:00.2 5 6\n")
                          .record;
  EXPECT_EQ(record.header.sample_rate, 10.0);
  ASSERT_EQ(record.header.channels.size(), 2U);
  EXPECT_EQ(record.header.channels[1].name, "b");
  EXPECT_EQ(record.samples(2, 1), 6.0);
}

TEST(CsvTimes, TitlesMayStandInAComment) {
  const auto record = table("# time force acc\n0.0 1 2\n0.5 3 4\n1.0 5 6\n").record;
  EXPECT_EQ(record.header.sample_rate, 2.0);
  EXPECT_EQ(record.header.channels[0].name, "force");
}

// roles

std::string roles_of(const std::string& titles) {
  std::string row;
  for (std::size_t c = 0; c < static_cast<std::size_t>(std::ranges::count(titles, ',')); ++c)
    row += ",1";
  const auto record =
      table("time [s]," + titles.substr(1) + "\n0" + row + "\n1" + row + "\n").record;
  std::string roles;
  for (const auto& channel : record.header.channels)
    roles += (roles.empty() ? "" : " ") + std::string(data::role_text(channel.role));
  return roles;
}

TEST(ChannelRoles, FollowFromNamesAndUnits) {
  EXPECT_EQ(roles_of(",F1 [N],a1 [g],a2 [m/s^2],temp [degC]"),
            "excitation response response other");
  EXPECT_EQ(roles_of(",Hammer [mV],Acc_1 [mV]"), "excitation response");
  EXPECT_EQ(roles_of(",demand x [mm],x [mm],valve current [mA]"), "excitation response drive");
  EXPECT_EQ(roles_of(",Kraft (kN),Weg (mm),Geschwindigkeit (m/s)"), "excitation response response");
  EXPECT_EQ(roles_of(",reaction force [N],p [bar]"), "response response");
  EXPECT_EQ(roles_of(",ch1,ch2"), "other other");
}

}  // namespace
}  // namespace hydrapod::test
