/// The paper's conclusion from records, and the remedy tried on the rig.

#include <fmt/format.h>

#include <numbers>

#include "from_rig.hpp"
#include "hydrapod/diagnosis/diagnose.hpp"

namespace hydrapod::test {
namespace {

const std::vector<std::string> rigid_seals{"legs.guide_sleeve.stiffness=100 kN/mm"};
const RigExperiment long_record{.duration = 600.0, .level = 3e-4, .seed = 41};

TEST(DiagnosisFromRigLong, NamesTheGuideSleevesOfThePublishedMachine) {
  expect_sleeves(diagnosed_on_rig("zhang-jiang-2021", rigid_seals, {}, long_record), 1.5732e5);
}

TEST(DiagnosisFromRigLong, NamesTheGuideSleevesOfTheHeavyMachine) {
  expect_sleeves(diagnosed_on_rig("heavy-platform", rigid_seals, {},
                                  {.duration = 600.0, .level = 1e-4, .seed = 42}),
                 0.84e6);
}

TEST(DiagnosisFromRigLong, BlamesNothingWhereTheSealsAreRigid) {
  for (const std::string name : {"zhang-jiang-2021", "heavy-platform"}) {
    const auto d = diagnosed_on_rig(name, rigid_seals, rigid_seals,
                                    {.duration = 300.0, .level = 2e-4, .seed = 43});
    EXPECT_EQ(d.finding, diagnosis::Finding::nothing_to_blame) << name;
  }
}

/// The stiffness that is said to bring x to 5.1 Hz does so on the rig.
TEST(DiagnosisFromRigLong, RemedyKeepsItsPromise) {
  constexpr double hertz = 2.0 * std::numbers::pi, wanted = 5.1;
  const auto text = read_text(source_file("models/heavy-platform.toml"));
  const auto machine = machine_file(text, {}).machine;
  const auto remedy =
      diagnosis::find_remedy(machine, {machine.poses.front()}, dynamics::ModelKind::guide,
                             {.omega = wanted * hertz, .direction = 0});
  ASSERT_EQ(remedy.status, diagnosis::RemedyStatus::found);
  const auto mended =
      machine_file(text,
                   {fmt::format("legs.guide_sleeve.stiffness={:.12g}", remedy.needed.stiffness)})
          .machine;
  const auto found = identified_on_rig(
      mended, {.X_BP = mended.neutral(), .duration = 600.0, .level = 2e-4, .seed = 44});
  double first = 0.0;  // the lowest mode that moves in x more than in y
  for (const auto& mode : found.modes)
    if (first == 0.0 && std::abs(mode.displacement[0]) > std::abs(mode.displacement[1]))
      first = mode.fit.omega() / hertz;
  EXPECT_NEAR(first / wanted, 1.0, 0.01);
}

/// Longer guided rods with soft rings: three resonances in x and y, two seals to blame.
TEST(DiagnosisFromRigLong, NamesGuideSleevesAndPistonRings) {
  const std::vector<std::string> frame{"legs.guide_sleeve.position=0.738", "platform.mass=400"};
  auto design = frame, truth = frame;
  design.push_back(rigid_seals.front());
  truth.push_back("legs.guide_sleeve.stiffness=30 kN/m");
  truth.push_back("legs.piston_ring={ stiffness = 3e4 }");
  const auto d = diagnosed_on_rig(
      "zhang-jiang-2021", design, truth,
      {.kind = dynamics::ModelKind::full, .duration = 1200.0, .level = 3e-4, .seed = 45});
  EXPECT_EQ(report::hypothesis_name(d, d.best()),
            "guide sleeves of all legs and piston rings of all legs");
  // which of the two is the softer one the frequencies do not say
  double sleeves = 0.0, rings = 0.0;  // each has resonances of its own
  for (const auto& mode : d.modes) {
    sleeves = std::max(sleeves, mode.guide_sleeves);
    rings = std::max(rings, mode.piston_rings);
  }
  EXPECT_GT(sleeves, 0.5);
  EXPECT_GT(rings, 0.5);
}

}  // namespace
}  // namespace hydrapod::test
