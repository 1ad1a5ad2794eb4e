/// Modes inside a loop that this project did not make, with excitation of every kind: a few seeds.

#include "foreign_loop.hpp"

#include <gtest/gtest.h>

namespace hydrapod::identification {
namespace {

class ForeignLoops : public testing::TestWithParam<Excitation> {};

TEST_P(ForeignLoops, GivesTheModesOfThePlant) {
  const auto plant = foreign_plant();
  test::ClassScore score;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    // noise in all of the band has the least power at the modes
    const double duration = GetParam() == Excitation::white ? 405.0 : 205.0;
    const auto m =
        foreign_measurement(plant, {.excitation = GetParam(), .duration = duration, .seed = seed});
    EXPECT_TRUE(m.responses.harmonics.empty());
    const auto found = identify_modes(m.responses, {.to = 16.0});
    score.add(test::true_modes(plant), test::found_modes(found));
  }
  EXPECT_EQ(score.found, score.wanted);
  EXPECT_EQ(score.false_modes, 0);
  EXPECT_LT(score.largest_frequency_error(), 3e-3);
  EXPECT_LT(score.largest_damping_error(), 0.1);
}

INSTANTIATE_TEST_SUITE_P(Excitations, ForeignLoops,
                         testing::Values(Excitation::white, Excitation::noise, Excitation::sweep,
                                         Excitation::multisine, Excitation::drive));

}  // namespace
}  // namespace hydrapod::identification
