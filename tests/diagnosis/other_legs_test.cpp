/// Machines without oil: plain struts, and electric cylinders; machines whose legs differ.

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
  for (const auto& mode : d.modes) EXPECT_EQ(mode.leg_type, model::LegType::screw);
  expect_round_trip_of({.diagnosis = d});
}

TEST(DiagnoseScrews, FindsSoftSeals) {
  const auto d =
      diagnosed(screw_file, ModelKind::guide, {"legs.guide_sleeve.stiffness=1.7 kN/mm"}, 59);
  EXPECT_THAT(names_of(d), testing::Contains("guide sleeves of all legs")) << verdict(d);
}

/// Of heavy-platform.toml with `design`.
diagnosis::Diagnosis heavy(const std::vector<std::string>& design,
                           const std::vector<std::string>& fault, int seed) {
  return run_blind({.machine = "heavy-platform.toml",
                    .design = design,
                    .fault = fault,
                    .planted = {"any"},
                    .poses = {"neutral", "low"},
                    .noise = 5e-4,
                    .repetition = seed})
      .diagnosis;
}

/// One leg has a spring in place of chambers: the number of all legs is that of the others.
TEST(DiagnoseLegsThatDiffer, KnowsWhichHaveChambers) {
  for (const std::string odd : {"leg.1", "leg.3"}) {
    const auto d = heavy({odd + ".oil_spring.stiffness=14.7 kN/mm"},
                         {"legs.oil_spring.cylinder.bulk_modulus=0.83 GPa"}, 61);
    EXPECT_THAT(names_of(d), testing::Contains("bulk modulus of the oil")) << odd << verdict(d);
    for (const auto& cause : d.causes) EXPECT_NE(cause.kind, diagnosis::Cause::Kind::air);
  }
}

/// Six own values, as a calibration of each leg writes them.
TEST(DiagnoseLegsThatDiffer, FindsWhatIsCommonToLegsWithValuesOfTheirOwn) {
  std::vector<std::string> design, fault;
  for (int leg = 1; leg <= 6; ++leg) {
    const auto sleeve = fmt::format("leg.{}.guide_sleeve.stiffness=", leg);
    design.push_back(sleeve + fmt::format("{} kN/m", 840.0 + 0.1 * leg));
    fault.push_back(sleeve + "1.23 kN/mm");
  }
  const auto d = heavy(design, fault, 67);
  EXPECT_THAT(names_of(d), testing::Contains("guide sleeves of all legs")) << verdict(d);
  const auto* sleeves = find(d, "guide sleeves of all legs");
  ASSERT_NE(sleeves, nullptr);
  const auto& found = sleeves->fit.parameters[0];
  EXPECT_EQ(found.paths.size(), 6U);
  EXPECT_NEAR(found.value, 1.23e6, 4.0 * found.deviation);
  EXPECT_THAT(report::parameter_words(*sleeves),
              testing::ElementsAre(testing::HasSubstr("(nominal 840.1 kN/m to 840.6 kN/m)")));
  expect_round_trip_of({.diagnosis = d});
}

/// Who calculates with rigid legs learns what their sleeves are.
TEST(DiagnoseLegsThatDiffer, FindsSleevesThatAreStatedAsRigid) {
  const auto d =
      heavy({"legs.guide_sleeve.stiffness=rigid"}, {"legs.guide_sleeve.stiffness=0.84 kN/mm"}, 71);
  EXPECT_THAT(names_of(d), testing::Contains("guide sleeves of all legs")) << verdict(d);
  const auto* sleeves = find(d, "guide sleeves of all legs");
  ASSERT_NE(sleeves, nullptr);
  const auto& found = sleeves->fit.parameters[0];
  EXPECT_NEAR(found.value, 0.84e6, 4.0 * found.deviation);
}

}  // namespace
}  // namespace hydrapod::test
