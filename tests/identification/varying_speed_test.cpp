/// Modes from outputs alone beside a machine whose speed varies: its vibrations are named, and are
/// no modes.

#include "varying_speed.hpp"

#include <gtest/gtest.h>

namespace hydrapod::test {
namespace {

TEST(VaryingSpeed, IsNamedAndIsNoMode) {
  for (const double spread : {0.001, 0.003, 0.01}) {
    auto data = floor_with_machine(spread);
    data.experiment.seed = 21;
    const auto found = identified_as_asked(
        with_machine(outputs_of(data.system, data.experiment), data.machine, 22));
    ClassScore score;
    score.add(true_modes(data.system), found_modes(found));
    EXPECT_EQ(score.found, 4) << spread;
    // what is left of the flanks may be a pole, but none that is trusted
    int trusted = 0;
    for (const auto& mode : found.modes) trusted += mode.quality() >= 0.5 ? 1 : 0;
    EXPECT_EQ(trusted, 4) << spread;
    const auto is_speed = [&](const data::Harmonic& harmonic) {
      return std::abs(harmonic.frequency / data.machine.frequency - 1.0) < spread + 0.001;
    };
    ASSERT_TRUE(std::ranges::any_of(found.responses.harmonics, is_speed)) << spread;
    if (spread < 0.003) continue;
    const auto& harmonic = *std::ranges::find_if(found.responses.harmonics, is_speed);
    // a normal process is within three deviations nearly all the time
    EXPECT_NEAR(harmonic.wander / data.machine.frequency, 2.5 * spread, spread) << spread;
  }
}

/// Noise and resonances, however sharp, are no vibrations of constant amplitude.
TEST(VaryingSpeed, NothingIsFoundWhereNothingTurns) {
  for (std::uint64_t seed = 31; seed < 34; ++seed) {
    auto data = floor_with_machine(0.0);
    data.experiment.seed = seed;
    const auto found = identified_as_asked(outputs_of(data.system, data.experiment));
    EXPECT_TRUE(found.responses.harmonics.empty()) << seed;
    EXPECT_EQ(found.modes.size(), 4U) << seed;
  }
}

}  // namespace
}  // namespace hydrapod::test
