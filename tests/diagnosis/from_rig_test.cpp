/// Diagnosis of a record short enough for every day.

#include "from_rig.hpp"

namespace hydrapod::test {
namespace {

TEST(DiagnosisFromRig, NamesTheGuideSleevesOfTheHeavyMachine) {
  const auto d = diagnosed_on_rig("heavy-platform", {"legs.guide_sleeve.stiffness=100 kN/mm"}, {},
                                  {.duration = 100.0, .level = 2e-4, .seed = 31});
  expect_sleeves(d, 0.84e6);
}

}  // namespace
}  // namespace hydrapod::test
