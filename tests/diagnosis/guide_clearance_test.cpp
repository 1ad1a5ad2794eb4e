/// Rods that lie on their guide rings: a gap that is not the one of the file.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "blind_series.hpp"
#include "diagnosis/evidence.hpp"

namespace hydrapod::diagnosis {
namespace {

using test::BlindCase;
using test::names_of;

constexpr const char* of_gaps = "gap at the guide rings of all legs";

/// The rods sag by more than the stated gap of 0.31 mm at their sleeves and lie on the rings. Worn
/// rings let them sag three times as far: fewer rods reach them, and O-rings alone hold the others.
BlindCase worn_rings() {
  return {.machine = "heavy-platform.toml",
          .design = {"legs.guide_sleeve.gap=0.31 mm", "legs.guide_sleeve.guide_stiffness=4.3e7"},
          .fault = {"legs.guide_sleeve.gap=0.93 mm"},
          .planted = {of_gaps},
          .poses = {"neutral", "low", "surge"},
          .noise = 5e-4,
          .repetition = 5};
}

TEST(GuideClearance, OfWornRingsIsFound) {
  const auto d = test::run_blind(worn_rings()).diagnosis;
  EXPECT_THAT(names_of(d), testing::Contains(of_gaps)) << test::verdict(d);
  const auto* gaps = test::find(d, of_gaps);
  ASSERT_NE(gaps, nullptr);
  EXPECT_NEAR(gaps->fit.parameters[0].value, 0.93e-3, 3.0 * gaps->fit.parameters[0].deviation);
  EXPECT_LT(gaps->fit.parameters[0].deviation, 0.1e-3);
  test::expect_round_trip_of({.diagnosis = d});
}

/// Of all legs and of each one where the file states a gap; of a leg alone where it alone has one.
TEST(GuideClearance, IsACauseWhereTheFileStatesAGap) {
  const auto count = [](const std::vector<std::string>& overrides) {
    const auto file =
        test::machine_file(BlindCase{.machine = "heavy-platform.toml"}.text(), overrides);
    return std::ranges::count(causes_of(file), Cause::Kind::guide_clearance, &Cause::kind);
  };
  EXPECT_EQ(count({}), 0);
  EXPECT_EQ(count({"legs.guide_sleeve.gap=0.2 mm"}), 7);
  EXPECT_EQ(count({"leg.3.guide_sleeve.gap=0.2 mm"}), 1);
}

}  // namespace
}  // namespace hydrapod::diagnosis
