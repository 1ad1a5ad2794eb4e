/// Rods that bend more than stated, and the tie with the guide sleeves that one pose leaves.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "blind_series.hpp"
#include "diagnosis/evidence.hpp"

namespace hydrapod::diagnosis {
namespace {

using dynamics::ModelKind;
using test::BlindCase;
using test::names_of;

/// Seals so stiff that the rods bend about as much: rods of 63.7 mm instead of 70 mm.
const std::vector<std::string> elastic{"legs.bending=elastic", "legs.guide_sleeve.stiffness=3.7e6"};
constexpr const char* of_rods = "rods of all legs that bend";
constexpr const char* of_sleeves = "guide sleeves of all legs";

BlindCase thin_rods(const std::vector<std::string>& poses) {
  return {.machine = "heavy-platform.toml",
          .design = elastic,
          .fault = {"legs.rod.diameter=63.7 mm"},
          .planted = {of_rods},
          .poses = poses,
          .noise = 5e-4,
          .repetition = 23};
}

/// One pose: rods and seals are springs in series, of which the data know the sum. Several poses:
/// the overhang of the rod differs, the seal does not.
TEST(RodsThatBend, AreTiedWithSleevesAtOnePoseAndFoundAtSeveral) {
  const auto one = test::run_blind(thin_rods({"neutral"})).diagnosis;
  EXPECT_EQ(one.finding, Finding::undecided);
  EXPECT_THAT(names_of(one), testing::IsSupersetOf({of_rods, of_sleeves}));
  const auto d = test::run_blind(thin_rods({"neutral", "low", "surge"})).diagnosis;
  EXPECT_THAT(names_of(d), testing::Contains(of_rods)) << test::verdict(d);
  EXPECT_THAT(names_of(d), testing::Not(testing::Contains(of_sleeves)));
  const auto* rods = test::find(d, of_rods);
  ASSERT_NE(rods, nullptr);
  const auto& diameter = rods->fit.parameters[0];
  EXPECT_NEAR(diameter.value, 63.7e-3, 3.0 * diameter.deviation);
  EXPECT_LT(diameter.deviation, 1e-3);
  test::expect_round_trip_of({.diagnosis = d});
}

/// Thicker than the wall twice and thinner than the bore.
TEST(RodsThatBend, AreSoughtAmongThoseThatCanBeBuilt) {
  const auto file = test::machine_file(
      BlindCase{.machine = "heavy-platform.toml"}.text(),
      {"legs.bending=elastic", "legs.rod.diameter=93 mm", "legs.rod.wall=29 mm"});
  const auto causes = causes_of(file);
  const auto rods = std::ranges::find(causes, Cause::Kind::rods_bend, &Cause::kind);
  ASSERT_NE(rods, causes.end());
  EXPECT_GT(std::get<double>(*rods->free[0].lower), 58e-3);
  EXPECT_LT(std::get<double>(*rods->free[0].upper), 100e-3);
  const auto straight =
      causes_of(test::machine_file(BlindCase{.machine = "heavy-platform.toml"}.text(), {}));
  EXPECT_EQ(std::ranges::count(straight, Cause::Kind::rods_bend, &Cause::kind), 0);
  EXPECT_EQ(std::ranges::count(straight, Cause::Kind::elastomer_ratio, &Cause::kind), 0);
}

}  // namespace
}  // namespace hydrapod::diagnosis
