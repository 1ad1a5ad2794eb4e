/// Modes whose frequency drifts during the record are named, others are not. Many seeds are in
/// wander_long_test.cpp.

#include <gtest/gtest.h>

#include "foreign_loop.hpp"
#include "wandering.hpp"

namespace hydrapod::identification {
namespace {

TEST(Wandering, AModeThatDriftsIsNamed) {
  const auto system = five_masses();
  constexpr int drifting = 2;
  const auto found = tested_for_wandering(drifting_record(system, {.mode = drifting}, 3));
  ASSERT_EQ(found.modes.size(), 5U);
  const auto warnings = wandering_in(found);
  ASSERT_EQ(warnings.size(), 1U);
  const auto& pole = system.modes[drifting].pole;
  const double frequency = std::abs(pole) / (2.0 * std::numbers::pi);
  EXPECT_NEAR(warnings[0].value, frequency, 0.005 * frequency);
  // halves of a linear drift of 2 % are 1 % apart
  EXPECT_EQ(warnings[0].count, 2);
  EXPECT_NEAR((warnings[0].to - warnings[0].from) / frequency, 0.01, 0.003);
  // what is said of the damping: higher than in the parts, and in truth too high
  const double damping = -pole.real() / std::abs(pole);
  const auto& mode = found.modes[drifting];
  EXPECT_GT(mode.fit.damping_ratio(), damping + 2.0 * mode.fit.damping_deviation);
  EXPECT_GT(warnings[0].share, 0.02);
  EXPECT_NEAR(mode.fit.damping_ratio() / (1.0 + warnings[0].share), damping, 0.1 * damping);
  for (int r = 0; r < 5; ++r) {
    const auto& other = found.modes[static_cast<std::size_t>(r)];
    if (r == drifting)
      EXPECT_LT(other.steadiness, 0.75);
    else
      EXPECT_EQ(other.steadiness, 1.0);
  }
}

TEST(Wandering, ModesThatStayAreNotNamed) {
  const auto system = five_masses();
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
    EXPECT_TRUE(wandering_in(tested_for_wandering(drifting_record(system, {}, seed))).empty())
        << seed;
}

/// A step that is wider than the resonance makes two peaks: in a part the partner of a mode is one
/// of the same shape near by, or none, and never another mode.
TEST(Wandering, ThePartnerInAPartIsTheSameMode) {
  const auto system = five_masses();
  for (int drifting = 1; drifting < 4; ++drifting) {
    const auto found =
        tested_for_wandering(drifting_record(system, {.mode = drifting, .size = 0.12}, 3));
    for (const auto& warning : wandering_in(found)) {
      EXPECT_GT(warning.from, 0.89 * warning.value) << drifting;
      EXPECT_LT(warning.to, 1.11 * warning.value) << drifting;
    }
  }
}

/// A drift by several widths makes two modes of one shape. Neither is there.
TEST(Wandering, AResonanceThatBecameTwinsIsNoMode) {
  using Eigen::Vector4d;
  constexpr int drifting = 1;
  constexpr double frequency = 17.3;
  test::ModalSystem system{{test::real_mode(11.1, 0.0061, Vector4d(0.83, -0.41, 0.57, 0.93)),
                            test::real_mode(frequency, 0.0078, Vector4d(-0.37, 0.91, 0.62, -0.48)),
                            test::real_mode(26.3, 0.0052, Vector4d(0.69, 0.52, -0.97, 0.44))}};
  for (auto& mode : system.modes) mode.participation = mode.participation.head(1).eval();
  // 200 s have too few blocks of the usual length for parts of them
  for (const double duration : {600.0, 200.0}) {
    SCOPED_TRACE(duration);
    const auto found = tested_for_wandering(
        drifting_record(system, {.mode = drifting, .size = 0.04, .duration = duration}, 3));
    int near = 0;
    for (const auto& mode : found.modes) {
      if (std::abs(mode.fit.omega() / (2.0 * std::numbers::pi) / frequency - 1.0) > 0.05) continue;
      ++near;
      EXPECT_EQ(mode.quality(), 0.0);
    }
    EXPECT_GE(near, 2);
  }
}

/// An excitation that grows leaves both halves enough.
TEST(Wandering, UnderAGrowingExcitationTheModeThatDriftsIsNamed) {
  const auto system = five_masses();
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const auto named = wandering_in(tested_for_wandering(
        drifting_record(system, {.mode = 2, .duration = 240.0, .growth = 4.0}, seed)));
    ASSERT_EQ(named.size(), 1U) << seed;
    EXPECT_NEAR(named[0].value / (std::abs(system.modes[2].pole) / (2.0 * std::numbers::pi)), 1.0,
                0.01);
    EXPECT_TRUE(wandering_in(tested_for_wandering(drifting_record(
                                 system, {.duration = 240.0, .growth = 4.0}, seed + 30)))
                    .empty())
        << seed;
  }
}

/// Halves of shorter blocks tell what the record is too short for: with its own blocks no half has
/// averages enough.
TEST(Wandering, OfAShortRecordIsNamedToo) {
  const auto system = five_masses();
  for (const double duration : {75.0, 110.0}) {
    SCOPED_TRACE(duration);
    int named = 0, others = 0, of_still = 0;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const auto found = tested_for_wandering(
          drifting_record(system, {.mode = 1, .size = 0.04, .duration = duration}, seed));
      const double frequency = std::abs(system.modes[1].pole) / (2.0 * std::numbers::pi);
      for (const auto& warning : wandering_in(found))
        ++(std::abs(warning.value / frequency - 1.0) < 0.03 ? named : others);
      of_still += static_cast<int>(wandering_in(tested_for_wandering(drifting_record(
                                                    system, {.duration = duration}, seed + 20)))
                                       .size());
    }
    EXPECT_EQ(named, 3);
    EXPECT_EQ(others, 0);
    EXPECT_EQ(of_still, 0);
  }
}

/// Quarters are fitted as they are read where they are long enough, and put together where they are
/// not: what comes out is that of all spectra at once.
TEST(Wandering, OfARecordIsThatOfItsGroups) {
  const auto system = five_masses();
  for (const double duration : {300.0, 520.0}) {
    const test::TemporaryFolder folder;
    const std::string file = folder / "run.h5";
    data::write_record(file, drifting_record(system, {.mode = 2, .duration = duration}, 3),
                       data::RecordFormat::hdf5);
    data::RecordSet records({file});
    const auto measured = measure_responses(records, {});
    const auto found = identify_modes(measured.responses);
    const auto grouped = measure_groups(records, measured, {}, 4, {}, found.to);
    const auto expected = wandering_modes(grouped.groups, grouped.choice, grouped.estimator, found);
    const auto got = compare_parts(records, measured, {}, found).wandering;
    ASSERT_EQ(expected.size(), 1U) << duration;
    ASSERT_EQ(got.size(), 1U) << duration;
    EXPECT_EQ(got[0].mode, expected[0].mode);
    EXPECT_EQ(got[0].groups, duration > 400.0 ? 4 : 2);
    EXPECT_EQ(got[0].chi_squared, expected[0].chi_squared);
    EXPECT_EQ(got[0].lowest, expected[0].lowest);
    EXPECT_EQ(got[0].damping_in_groups, expected[0].damping_in_groups);
    const auto stop = [](double) { return true; };
    EXPECT_TRUE(compare_parts(records, measured, {}, found, {}, {}, stop).wandering.empty());
  }
}

TEST(Wandering, InALoopTheModeThatDriftsIsNamed) {
  const auto plant = foreign_plant();
  for (int drifting = -1; drifting < 3; ++drifting) {
    const ForeignLoop loop{.excitation = Excitation::noise, .drifting = drifting, .seed = 71};
    const auto found = tested_for_wandering(foreign_loop_record(plant, loop));
    const auto warnings = wandering_in(found);
    ASSERT_EQ(warnings.size(), drifting < 0 ? 0U : 1U) << drifting;
    if (drifting < 0) continue;
    const double frequency =
        std::abs(plant.modes[static_cast<std::size_t>(drifting)].pole) / (2.0 * std::numbers::pi);
    EXPECT_NEAR(warnings[0].value, frequency, 0.005 * frequency);
    EXPECT_NEAR((warnings[0].to - warnings[0].from) / frequency, 0.01, 0.003);
  }
}

}  // namespace
}  // namespace hydrapod::identification
