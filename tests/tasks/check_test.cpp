/// `check`: springs of legs that are bent; seals that are elastomers, against ideal springs.

#include <gtest/gtest.h>

#include <cmath>

#include "hydrapod/hydraulics/servo_axis.hpp"
#include "hydrapod/tasks/linear.hpp"
#include "support/loop_machine.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;

report::PoseCheck check_of(const model::Machine& machine, ModelKind kind = ModelKind::guide) {
  model::MachineFile file;
  file.machine = machine;
  return tasks::check({.file = file, .pose = {"neutral", machine.neutral()}, .kind = kind}, {})
      .front();
}

/// A tilted rod lets the piston out of its case: by the law of cosines in the triangle of base
/// joint, piston and platform joint. The oil spring is the one there, as in K.
TEST(CheckOfOilSprings, HasThoseOfTheModes) {
  const auto machine =
      simulation::machine_of("heavy-platform", {"legs.guide_sleeve.stiffness=2e6 N/m"});
  const auto found = check_of(machine);
  ASSERT_TRUE(found.equilibrium);
  const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
  double most = 0.0;
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine.legs[i];
    const auto& of = found.legs[i];
    EXPECT_NEAR(of.oil_stiffness, model.legs[i].k_h, 1e-12 * model.legs[i].k_h);
    const double across = leg.rod.length * std::sin(of.tilt),
                 piston = std::sqrt(of.length * of.length - across * across) -
                          leg.rod.length * std::cos(of.tilt),
                 bent = hydraulics::oil_stiffness(leg, piston);
    EXPECT_NEAR(of.oil_stiffness, bent, 1e-9 * bent);
    const double straight = hydraulics::oil_stiffness(leg, of.length - leg.rod.length);
    most = std::max(most, std::abs(of.oil_stiffness / straight - 1.0));
  }
  EXPECT_GT(most, 1e-6);  // it would be seen
}

/// A rod that hangs in its seals alone, farther from the axis than any guide ring is.
TEST(CheckOfOffsets, SaysThatAGuideIsNotStated) {
  using Kind = report::PoseWarning::Kind;
  const auto warnings_of = [](const std::vector<std::string>& changes, Kind kind) {
    auto found = check_of(simulation::machine_of("heavy-platform", changes)).warnings;
    std::erase_if(found, [&](const auto& warning) { return warning.kind != kind; });
    return found;
  };
  const auto found = warnings_of({}, Kind::no_gap_stated);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].legs, (std::vector{0, 1, 2, 3, 4, 5}));
  EXPECT_NEAR(found[0].value, 3.422e-3, 1e-6);
  const std::string gap = "legs.guide_sleeve.gap=0.2 mm",
                    guide = "legs.guide_sleeve.guide_stiffness=5e7";
  EXPECT_TRUE(warnings_of({gap, guide}, Kind::no_gap_stated).empty());
  EXPECT_EQ(warnings_of({gap, guide}, Kind::rod_on_guide).size(), 1U);
  EXPECT_TRUE(warnings_of({"environment.gravity=0"}, Kind::no_gap_stated).empty());
  const std::string stiff = "legs.guide_sleeve.stiffness=2e7";
  EXPECT_TRUE(warnings_of({stiff}, Kind::no_gap_stated).empty());
}

TEST(CheckOfElastomers, HasTheOffsetsOfSealsUnderPressure) {
  auto machine = symmetric_machine(9.81);
  for (auto& leg : machine.legs) {
    leg.hydraulics.equivalent_cylinder = {.area_ratio = 0.53, .area = 1.3e-3};
    leg.bending = model::LegBending::elastic;  // in series with the seals
    leg.rod.diameter = 0.021;
    leg.guide_sleeve.gap = 0.61e-3;  // the rods lie on their guides
    leg.guide_sleeve.guide_stiffness = 2.3e7;
    leg.guide_sleeve.elastomer = {.dynamic_ratio = 1.7,
                                  .loss_factor = 0.21,
                                  .frequency = 13.0,
                                  .pressure_stiffening = 4.1e-8};
    leg.piston_ring->elastomer = leg.guide_sleeve.elastomer;
  }
  auto ideal = dynamics::with_pressed_seals(machine, ModelKind::full, machine.neutral());
  for (auto& leg : ideal.legs) {
    leg.guide_sleeve.elastomer.reset();
    leg.piston_ring->elastomer.reset();
  }
  const auto found = check_of(machine, ModelKind::full), wanted = check_of(ideal, ModelKind::full);
  ASSERT_TRUE(found.equilibrium);
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    const auto &a = found.legs[i], &b = wanted.legs[i];
    EXPECT_GT(a.sleeve_offset, 1e-4);
    EXPECT_NEAR(a.sleeve_offset, b.sleeve_offset, 1e-12 * b.sleeve_offset);
    EXPECT_NEAR(*a.ring_offset, *b.ring_offset, 1e-12 * *b.ring_offset);
    EXPECT_NEAR(a.tilt, b.tilt, 1e-12 * b.tilt);
    EXPECT_EQ(a.on_guide, b.on_guide);
  }
}

/// Heavy legs end at a limit point, where quick motions still meet stiff seals.
TEST(CheckOfElastomers, StatesTheLowestFrequencyOfSlowMotionsAtTheBucklingLoad) {
  const auto ideal = symmetric_machine(9.81);
  auto machine = ideal;
  for (auto& leg : machine.legs)
    leg.guide_sleeve.elastomer = {.dynamic_ratio = 1.9, .loss_factor = 0.13, .frequency = 17.0};
  const auto found = check_of(machine), wanted = check_of(ideal);
  ASSERT_TRUE(wanted.lowest_at_buckling);
  ASSERT_TRUE(found.lowest_at_buckling);
  // Both loads are bisected to 1e-6, and near a limit point ω² goes with the root of what is left.
  EXPECT_NEAR(*found.lowest_at_buckling, *wanted.lowest_at_buckling,
              0.05 * *wanted.lowest_at_buckling);
  auto rigid_arms = machine;
  rigid_arms.platform.mass += wanted.buckling.payload * 0.999;
  const auto quick = dynamics::linear_model(rigid_arms, machine.neutral(), ModelKind::guide);
  EXPECT_LT(*found.lowest_at_buckling, 0.8 * modal::normal_modes(quick).omega(0));
}

}  // namespace
}  // namespace hydrapod::test
