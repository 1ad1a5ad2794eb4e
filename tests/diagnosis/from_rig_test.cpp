/// Diagnosis of records short enough for every day.

#include "from_rig.hpp"
#include "by_record.hpp"
#include "planted_faults.hpp"

namespace hydrapod::test {
namespace {

TEST(DiagnosisFromRig, NamesTheGuideSleevesOfTheHeavyMachine) {
  const auto d = diagnosed_on_rig("heavy-platform", {"legs.guide_sleeve.stiffness=100 kN/mm"}, {},
                                  {.duration = 100.0, .level = 2e-4, .seed = 31});
  expect_sleeves(d, 0.84e6);
}

/// White forces on the machine under a controller that does not damp it: modes and responses of
/// all.
TEST(DiagnosisFromRig, NamesTheGuideSleevesFromForcesUnderControl) {
  const std::vector<std::string> owner{"controller.feedback=none",
                                       "legs.oil_spring.cylinder.air.fraction=0.001",
                                       "legs.guide_sleeve.stiffness=20 kN/mm"};
  auto truth = owner;
  truth.push_back("legs.guide_sleeve.stiffness=1.31 kN/mm");
  const auto d = diagnosed_on_rig("heavy-platform", owner, truth,
                                  {.duration = 100.0, .force = 5e3, .seed = 17});
  EXPECT_EQ(d.targets.observed, observation::Observed::system);
  ASSERT_EQ(d.targets.responses.size(), 1U);
  EXPECT_EQ(d.targets.responses[0].entry, observation::Entry::forces);
  expect_sleeves(d, 1.31e6);
}

/// The oil damped by 35 % of critical leaves the modes of the seals, in a band of few lines;
/// compared as undamped mechanics a sound machine would be blamed.
TEST(DiagnosisFromRig, BlamesNobodyFromForcesUnderControl) {
  const auto d =
      diagnosed_on_rig("heavy-platform", {}, {}, {.duration = 120.0, .force = 5e3, .seed = 23});
  EXPECT_EQ(d.finding, diagnosis::Finding::nominal) << verdict(d);
  EXPECT_FALSE(d.targets.responses.empty());
}

/// Of the series on records (record_series_long_test.cpp), with records of a minute. The parameter
/// is what was planted.
class ShortRecord : public testing::TestWithParam<std::string> {};

TEST_P(ShortRecord, FindsWhatWasPlanted) {
  const Setting setting{
      "heavy-platform.toml",
      {"legs.oil_spring.cylinder.air.fraction=0.001",
       "legs.oil_spring.cylinder.bulk_modulus=0.8 GPa", "legs.guide_sleeve.stiffness=20 kN/mm"},
      {"neutral"},
      0.0,
      {0.06, 1.21, 0.15, 1.0}};
  const auto cases = cases_of(setting, 7000);
  const auto test = std::ranges::find(cases, GetParam(), &BlindCase::planted_name);
  ASSERT_NE(test, cases.end());
  const auto result = run_blind(*test, by_record({60.0, 2e-4, 1.0}));
  EXPECT_TRUE(result.found) << verdict(result.diagnosis);
}

INSTANTIATE_TEST_SUITE_P(DiagnosisFromRig, ShortRecord,
                         testing::Values("nothing", "guide sleeve of leg 3",
                                         "rocking compliance of the base", "oil spring of leg 2"));

/// Blocks of a record of half a minute are short against the decay: all frequencies come out a
/// little too high, and a stiffer oil would explain that.
TEST(DiagnosisFromRig, BlamesNobodyForTheLeakageOfShortBlocks) {
  const Setting setting{
      "heavy-platform.toml",
      {"legs.oil_spring.cylinder.air.fraction=0.001",
       "legs.oil_spring.cylinder.bulk_modulus=0.8 GPa", "legs.guide_sleeve.stiffness=20 kN/mm"},
      {"neutral", "low"},
      0.0,
      {0.06, 1.21, 0.15, 1.0}};
  const auto cases = cases_of(setting, 8000);
  ASSERT_TRUE(cases.front().planted.empty());
  const auto result = run_blind(cases.front(), by_record({30.0, 2e-4, 1.0}));
  EXPECT_TRUE(result.found) << verdict(result.diagnosis);
}

}  // namespace
}  // namespace hydrapod::test
