/// Machines without oil: plain struts, and electric cylinders.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planted_faults.hpp"
#include "support/other_legs.hpp"

namespace hydrapod::test {
namespace {

using diagnosis::Finding;
using dynamics::ModelKind;

/// Of a machine with `fault`, given the file without it.
diagnosis::Diagnosis diagnosed(const std::string& text, ModelKind kind,
                               const std::vector<std::string>& fault, int seed) {
  const BlindCase test{
      .fault = fault, .poses = {"neutral", "up"}, .noise = 5e-4, .kind = kind, .repetition = seed};
  const auto design = machine_file(text, {});
  return diagnosis::diagnose(design, by_noise(test, machine_file(text, fault)), kind,
                             design.machine.poses);
}

TEST(DiagnoseStruts, FindsTheOneThatIsSofter) {
  const auto d = diagnosed(strut_file, ModelKind::rigid, {"leg.4.strut.stiffness=11.9 kN/mm"}, 41);
  // its gimbals are a spring in series with it
  EXPECT_THAT(names_of(d), testing::UnorderedElementsAre("strut of leg 4", "gimbals of leg 4"))
      << verdict(d);
  const auto* strut = find(d, "strut of leg 4");
  ASSERT_NE(strut, nullptr);
  const auto& stiffness = strut->fit.parameters[0];
  EXPECT_NEAR(stiffness.value, 11.9e6, 3.0 * stiffness.deviation);
  EXPECT_LT(stiffness.deviation, 0.02 * stiffness.value);
  expect_round_trip_of({.diagnosis = d});
}

TEST(DiagnoseStruts, TriesPairsOfTwoStruts) {
  const auto d =
      diagnosed(strut_file, ModelKind::rigid,
                {"leg.2.strut.stiffness=9.7 kN/mm", "leg.5.strut.stiffness=12.3 kN/mm"}, 43);
  EXPECT_THAT(names_of(d), testing::ElementsAre("strut of leg 2 and strut of leg 5")) << verdict(d);
}

TEST(DiagnoseStruts, BlamesNobodyInASoundMachine) {
  const auto d = diagnosed(strut_file, ModelKind::rigid, {}, 47);
  EXPECT_TRUE(d.finding == Finding::nominal || d.finding == Finding::nothing_to_blame)
      << verdict(d);
}

TEST(DiagnoseScrews, FindsTheOneThatIsSofter) {
  const auto d = diagnosed(screw_file, ModelKind::guide, {"leg.3.screw.stiffness=52 N/um"}, 53);
  EXPECT_THAT(names_of(d), testing::Contains("screw of leg 3")) << verdict(d);
  for (const auto& name : names_of(d)) EXPECT_THAT(name, testing::EndsWith("of leg 3"));
}

TEST(DiagnoseScrews, FindsSoftSeals) {
  const auto d =
      diagnosed(screw_file, ModelKind::guide, {"legs.guide_sleeve.stiffness=1.7 kN/mm"}, 59);
  EXPECT_THAT(names_of(d), testing::Contains("guide sleeves of all legs")) << verdict(d);
}

}  // namespace
}  // namespace hydrapod::test
