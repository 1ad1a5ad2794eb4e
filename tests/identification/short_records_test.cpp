/// Records with too few blocks: identified in one piece.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "measured_records.hpp"
#include "short_records.hpp"

namespace hydrapod::identification {
namespace {

using Kind = data::ResponseWarning::Kind;
using testing::HasSubstr;

using base::two_pi;

bool is_said_to_be_short(const FrequencyResponses& r) {
  return std::ranges::any_of(r.warnings,
                             [](const auto& w) { return w.kind == Kind::short_record; });
}

/// Every mode once, each number within `deviations` of those that are stated for it.
void expect_truth(const test::ModalSystem& system, const Identification& found, double deviations) {
  std::string list;
  for (const auto& mode : found.modes)
    list += fmt::format("{:.4f} Hz {:.3f} % ", mode.fit.omega() / two_pi,
                        100.0 * mode.fit.damping_ratio());
  ASSERT_EQ(found.modes.size(), system.modes.size()) << list;
  for (std::size_t r = 0; r < found.modes.size(); ++r) {
    const auto& fit = found.modes[r].fit;
    const auto pole = system.modes[r].pole;
    EXPECT_NEAR(fit.omega(), std::abs(pole), deviations * fit.omega_deviation) << r;
    EXPECT_NEAR(fit.damping_ratio(), -pole.real() / std::abs(pole),
                deviations * fit.damping_deviation)
        << r;
    EXPECT_GT(mac(fit.shape, system.modes[r].shape), 0.99) << r;
  }
}

/// Of some fifty numbers one is 4 deviations off in 300 runs; the seeds are fixed.
constexpr double never = 4.0;

TEST(ShortRecords, TenSecondsShowAllModesBetterThanTheTextbook) {
  for (const auto& system : {five_masses(), two_rows()}) {
    const auto truth = test::true_modes(system);
    test::ClassScore ours, plain;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const auto record = short_record(system, {}, seed);
      const auto result = identified_record({record});
      ASSERT_NE(result.measured.record, nullptr);
      expect_truth(system, result.found, never);
      EXPECT_TRUE(result.found.warnings.empty());
      ours.add(truth, test::found_modes(result.found));
      plain.add(truth, textbook_record_modes(record, system.inputs(), 25.0));
    }
    EXPECT_LT(ours.median_frequency_error(), 5e-5);
    EXPECT_LT(ours.median_frequency_error(), plain.median_frequency_error());
    EXPECT_LT(ours.median_damping_error(), plain.median_damping_error());
  }
}

TEST(ShortRecords, TheRecordIsSaidToBeShort) {
  const auto result = identified_record({short_record(five_masses(), {}, 5)});
  const auto& warnings = result.found.responses.warnings;
  const auto at = std::ranges::find(warnings, Kind::short_record, &data::ResponseWarning::kind);
  ASSERT_NE(at, warnings.end());
  EXPECT_DOUBLE_EQ(at->value, 10.0);
  EXPECT_EQ(at->total, 8);  // 1.5 (3 + 2), rounded up
  EXPECT_LT(at->count, at->total);
  EXPECT_NEAR(at->value / at->share, static_cast<double>(at->count), 1.0);
}

/// What is drawn as measured is near the exact responses, as its errors have it.
TEST(ShortRecords, ResponsesComeWithErrors) {
  const auto system = five_masses();
  const auto result = identified_record({short_record(system, {.noise = 0.03}, 6)});
  const auto& r = result.found.responses;
  ASSERT_TRUE(r.has_errors());
  ASSERT_TRUE(r.excitation.empty());
  double sum = 0.0, count = 0.0;
  for (std::size_t k = 0; k < r.lines(); ++k) {
    const auto H = system.sampled_response(r.frequency[k], 1.0 / 200.0);
    for (Eigen::Index o = 0; o < 5; ++o)
      for (Eigen::Index i = 0; i < 3; ++i) {
        sum += std::norm(r.H[k](o, i) - H(o, i)) / r.variance(k, o, i);
        count += 1.0;
      }
  }
  // a model of finite order is biased by noise, which its errors do not hold
  EXPECT_LT(sum / count, 4.0);
  EXPECT_GT(sum / count, 0.5);
}

/// 1.5 · 5 blocks of 4096 samples are enough for three inputs, one sample less is not.
TEST(ShortRecords, AsManyBlocksAsItTakesAreAveraged) {
  const auto system = five_masses();
  constexpr double rate = 200.0, enough = 7.5 * 4096.0;
  MeasureOptions options;
  options.for_modes = true;
  const auto longer = measured({short_record(system, {.duration = enough / rate}, 7)}, options);
  EXPECT_EQ(longer.record, nullptr);
  EXPECT_FALSE(is_said_to_be_short(longer.responses));
  // who asks for the record in one piece gets it, or an error
  options.whole_record = true;
  EXPECT_THROW(measured({short_record(system, {.duration = enough / rate}, 7)}, options),
               base::ComputationError);
  const auto shorter =
      measured({short_record(system, {.duration = (enough - 1.0) / rate}, 7)}, options);
  EXPECT_NE(shorter.record, nullptr);
  // who does not ask for it gets averages
  options.whole_record = false;
  EXPECT_EQ(
      measured({short_record(system, {.duration = (enough - 1.0) / rate}, 7)}, options).record,
      nullptr);
  // and responses alone are those of averages, whatever the length
  const auto usual = measured({short_record(system, {.duration = (enough - 1.0) / rate}, 7)});
  EXPECT_EQ(usual.record, nullptr);
  EXPECT_GT(usual.responses.averages, 0.0);
}

TEST(ShortRecords, WhoAsksForBlocksGetsThem) {
  const auto record = short_record(five_masses(), {.duration = 40.0}, 8);
  MeasureOptions options;
  options.block_length = 512;
  EXPECT_EQ(identified_record({record}, options).measured.record, nullptr);
}

TEST(ShortRecords, WhatRingsBeforeTheBeginningIsNoError) {
  const auto system = five_masses();
  const auto at_rest = identified_record({short_record(system, {.from_rest = true}, 9)});
  const auto ringing = identified_record({short_record(system, {}, 9)});
  expect_truth(system, at_rest.found, never);
  expect_truth(system, ringing.found, never);
}

TEST(ShortRecords, SeveralAreBetterThanOne) {
  const auto system = two_rows();
  const ShortRecordCase e{.duration = 8.0, .noise = 0.03};
  const auto a = short_record(system, e, 10), b = short_record(system, e, 11);
  const auto one = identified_record({a}), other = identified_record({b}),
             both = identified_record({a, b});
  expect_truth(system, both.found, never);
  ASSERT_EQ(one.found.modes.size(), both.found.modes.size());
  ASSERT_EQ(other.found.modes.size(), both.found.modes.size());
  double ratio = 0.0;
  for (std::size_t r = 0; r < both.found.modes.size(); ++r) {
    const auto knows = [&](const ShortResult& result) {
      return 1.0 / std::pow(result.found.modes[r].fit.omega_deviation, 2);
    };
    ratio += knows(both) / (knows(one) + knows(other)) / 6.0;
  }
  // what each tells of a frequency is less where it must tell shapes and residual terms too: both
  // together tell more than the sum, by a part of what these take
  EXPECT_GT(ratio, 0.9);
  EXPECT_LT(ratio, 1.6);
}

TEST(ShortRecords, LowModesAtAHighRateAreFound) {
  const auto system = five_masses();
  const auto result =
      identified_record({short_record(system, {.sample_rate = 1500.0, .noise = 0.003}, 12)});
  ASSERT_NE(result.measured.record, nullptr);
  expect_truth(system, result.found, never);
  EXPECT_LT(result.found.to, 60.0);
}

/// Its intervals would be too narrow: 84 % of them held the truth in 60 records of 10 s.
TEST(ShortRecords, ALoopIsRefused) {
  const auto plant = foreign_plant();
  try {
    identified_record({foreign_loop_record(plant, {.duration = 20.0, .seed = 3})});
    FAIL() << "it was not refused";
  } catch (const base::ComputationError& error) {
    EXPECT_THAT(error.what(), HasSubstr("leave --whole-record out"));
  }
}

/// The channels of a loop without what was commanded.
data::Record without_excitation(const data::Record& record) {
  data::Record rest{.header = record.header, .samples = record.samples.rightCols(6)};
  rest.header.channels.erase(rest.header.channels.begin(), rest.header.channels.begin() + 3);
  return rest;
}

TEST(ShortRecords, ALoopWithoutInstrumentsIsRefused) {
  const auto record =
      without_excitation(foreign_loop_record(foreign_plant(), {.duration = 20.0, .seed = 4}));
  try {
    identified_record({record});
    FAIL() << "it was not refused";
  } catch (const base::ComputationError& error) {
    EXPECT_THAT(error.what(), HasSubstr("inputs follow its outputs"));
  }
}

/// Unasked, it is averaged, and that is biased by noise in the loop.
TEST(ShortRecords, ALoopWithoutInstrumentsIsAveragedWithAWarning) {
  const auto record =
      without_excitation(foreign_loop_record(foreign_plant(), {.duration = 8.0, .seed = 4}));
  const auto m = measured({record}, {.for_modes = true});
  EXPECT_EQ(m.record, nullptr);
  const auto& warnings = m.responses.warnings;
  const auto loop = std::ranges::find(warnings, Kind::feedback, &data::ResponseWarning::kind);
  ASSERT_NE(loop, warnings.end());
  EXPECT_GT(loop->share, 0.05);
  EXPECT_LT(loop->share, 1.0);
  EXPECT_EQ(loop->estimator, Estimator::h1);
}

TEST(ShortRecords, DrivesOutsideOfALoopAreNot) {
  const auto system = five_masses();
  auto record = short_record(system, {}, 13);
  for (int i = 0; i < 3; ++i)
    record.header.channels[static_cast<std::size_t>(i)].role = data::Role::drive;
  expect_truth(system, identified_record({record}).found, never);
}

void expect_refused(const data::Record& record, const char* reason) {
  try {
    const auto result = identified_record({record});
    FAIL() << result.found.modes.size() << " modes";
  } catch (const base::ComputationError& error) {
    EXPECT_THAT(error.what(), HasSubstr(reason));
  }
}

TEST(ShortRecords, WhatIsFarTooShortIsRefused) {
  const auto one = row_of_masses(Eigen::VectorXd::Constant(1, 1.37), Eigen::Vector2d(410.0, 290.0),
                                 Eigen::Vector2d(0.31, 0.29), {0});  // 3.6 Hz
  expect_refused(short_record(one, {.duration = 1.0, .noise = 0.001}, 14), "too short");
  expect_refused(short_record(five_masses(), {.duration = 0.2}, 14), "too short");
}

/// 10 s are 32.4 periods of the lowest mode.
TEST(ShortRecords, ARecordOfTooFewPeriodsIsRefused) {
  const auto kept = identified_record({short_record(five_masses(), {}, 18)});
  IdentifyOptions options;
  options.record.fewest_periods = 32.0;
  EXPECT_EQ(identify_modes(kept.measured, options).modes.size(), 5U);
  options.record.fewest_periods = 33.0;
  try {
    identify_modes(kept.measured, options);
    FAIL() << "it was not refused";
  } catch (const base::ComputationError& error) {
    EXPECT_THAT(error.what(), HasSubstr("32.4 periods of a mode at 3.24 Hz, and 33 are needed"));
  }
}

/// Where the modes do not show, none is listed.
TEST(ShortRecords, ASecondOfFiveMassesHasNoWrongNumber) {
  const auto system = five_masses();
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    try {
      const auto result = identified_record({short_record(system, {.duration = 1.1}, seed)});
      for (const auto& mode : result.found.modes) {
        const auto near = std::ranges::min(system.modes, {}, [&](const test::ExactMode& m) {
          return std::abs(std::abs(m.pole) - mode.fit.omega());
        });
        EXPECT_NEAR(mode.fit.omega(), std::abs(near.pole), never * mode.fit.omega_deviation);
      }
    } catch (const base::ComputationError& error) {
      EXPECT_THAT(error.what(), HasSubstr("too short"));
    }
  }
}

TEST(ShortRecords, NoiseAloneHasNoMode) {
  test::Random random(77);
  data::Record record{.header = test::header_of(2, 3, 100.0), .samples = data::Samples(1500, 5)};
  for (Eigen::Index k = 0; k < record.samples.size(); ++k)
    record.samples.data()[k] = test::normal(random);
  const auto result = identified_record({record});
  EXPECT_TRUE(result.found.modes.empty());
  ASSERT_FALSE(result.found.warnings.empty());
  EXPECT_EQ(result.found.warnings[0].kind, ModeWarning::Kind::no_mode);
}

/// In 10 s it has 157 periods and lies on a line, in 9.73 s it does not.
TEST(ShortRecords, HumIsNoMode) {
  const auto system = five_masses();
  for (const double duration : {10.0, 9.73})
    for (const std::uint64_t seed : {15U, 16U, 17U}) {
      const ShortRecordCase e{.duration = duration, .hum = 0.1};
      const auto record = short_record(system, e, seed);
      const auto result = identified_record({record});
      expect_truth(system, result.found, never);
      ASSERT_EQ(result.found.responses.harmonics.size(), 1U);
      const auto& hum = result.found.responses.harmonics[0];
      EXPECT_NEAR(hum.frequency, 15.7, 0.01);
      const Eigen::VectorXd rms =
          (record.samples.rightCols(5).colwise().squaredNorm() / record.samples.rows())
              .cwiseSqrt()
              .transpose();
      for (Eigen::Index o = 0; o < 5; ++o)
        EXPECT_NEAR(hum.amplitude[o], 0.1 * rms[o], 0.02 * rms[o]) << o;
    }
}

TEST(ShortRecords, MissingSamplesAreFilled) {
  const auto system = five_masses();
  auto record = short_record(system, {}, 16);
  for (const Eigen::Index t : {311, 312, 907, 1433})
    record.samples(t, 5) = std::numeric_limits<double>::quiet_NaN();
  const auto result = identified_record({record});
  ASSERT_NE(result.measured.record, nullptr);
  expect_truth(system, result.found, never);
}

TEST(ShortRecords, WithoutNoiseNumbersAreExactAndFinite) {
  const auto system = five_masses();
  const auto result = identified_record({short_record(system, {.noise = 0.0}, 17)});
  ASSERT_EQ(result.found.modes.size(), 5U);
  for (std::size_t r = 0; r < 5; ++r) {
    const auto& fit = result.found.modes[r].fit;
    EXPECT_NEAR(fit.omega() / std::abs(system.modes[r].pole), 1.0, 1e-5);
    EXPECT_TRUE(std::isfinite(fit.omega_deviation));
    EXPECT_TRUE(fit.shape_deviation.allFinite());
  }
}

}  // namespace
}  // namespace hydrapod::identification
