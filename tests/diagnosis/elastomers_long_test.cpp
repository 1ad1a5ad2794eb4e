/// Seals that are elastomers of another compound, and the tie with their static stiffness that
/// frequencies leave. Each diagnosis computes damped modes some ten thousand times.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "blind_series.hpp"
#include "hydrapod/modal/mode_table.hpp"

namespace hydrapod::diagnosis {
namespace {

using dynamics::ModelKind;
using test::BlindCase;
using test::names_of;

/// The heavy machine with seals of rubber under 4.1 m/s².
model::MachineFile heavy(const std::string& fault) {
  return test::machine_file(
      BlindCase{.machine = "heavy-platform.toml"}.text(),
      {"environment.gravity=4.1", "legs.guide_sleeve.stiffness=0.617e6",
       "legs.guide_sleeve.damping=0",
       "legs.guide_sleeve.elastomer={ dynamic_ratio = 1.57, loss_factor = 0.19, frequency = 6.3 }",
       fault});
}

/// A random machine without weight, with seals of rubber.
model::MachineFile weightless(const std::string& fault) {
  test::Random random(77);
  return test::machine_file(
      test::random_machine_text(random, false),
      {"legs.guide_sleeve.stiffness=0.1878e6",
       "legs.guide_sleeve.elastomer={ dynamic_ratio = 1.57, loss_factor = 0.23, frequency = 9.3 }",
       fault});
}

constexpr const char* nothing = "name=\"as stated\"";
using Make = model::MachineFile (*)(const std::string& fault);

/// Damped modes that move the platform, with noise of frequencies, damping ratios and shapes.
observation::Targets damped_modes(const model::Machine& machine) {
  constexpr double noise = 5e-4, damping_noise = 0.03, shape_noise = 0.02, least_energy = 0.02;
  constexpr double most_damped = 0.08;  // shapes of others are complex
  test::Random random(1709);
  observation::Targets targets;
  const auto table = modal::mode_table(machine, machine.neutral(), ModelKind::guide);
  for (const auto& mode : table.real.modes) {
    const double omega = mode.mode.omega, ratio = mode.mode.damping_ratio;
    if (mode.energy.platform.sum() < least_energy || ratio > most_damped) continue;
    spatial::Vector6 shape = mode.mode.real.head<6>();
    for (double& u : shape) u *= 1.0 + shape_noise * test::normal(random);
    targets.modes.push_back({.name = mode.label,
                             .omega = omega * (1.0 + noise * test::normal(random)),
                             .deviation = noise * omega,
                             .damping = ratio * (1.0 + damping_noise * test::normal(random)),
                             .damping_deviation = damping_noise * ratio,
                             .shape = shape,
                             .shape_deviation = shape_noise});
  }
  return targets;
}

Diagnosis of_fault(Make make, const std::string& fault, bool damping) {
  const auto design = make(nothing);
  return diagnose(
      design, damped_modes(make(fault).machine), ModelKind::guide, design.machine.poses,
      {.frequency_error = 5e-4, .damping = damping, .damping_error = 0.1, .strongest = 0});
}

constexpr const char* of_sleeves = "guide sleeves of all legs";
constexpr const char* of_ratio = "dynamic stiffening of the guide sleeves' elastomers";
constexpr const char* of_loss = "loss factor of the guide sleeves' elastomers";

std::string words_of(const Diagnosis& d) {
  return test::verdict(d) + testing::PrintToString(report::reason_words(d));
}

/// The parameter of a hypothesis, and its standard deviation, which is below `most`.
void expect_found(const Diagnosis& d, const char* name, double value, double most) {
  const auto* hypothesis = test::find(d, name);
  ASSERT_NE(hypothesis, nullptr);
  const auto& found = hypothesis->fit.parameters[0];
  EXPECT_NEAR(found.value, value, 3.0 * found.deviation);
  EXPECT_LT(found.deviation, most);
}

/// Seals are stiffer at a frequency because they are stiffer or because they stiffen more:
/// frequencies do not tell which.
TEST(Elastomers, AreTiedWithSleevesByFrequenciesWithoutWeight) {
  const auto d = of_fault(weightless, "legs.guide_sleeve.elastomer.dynamic_ratio=2.19", false);
  EXPECT_EQ(d.finding, Finding::undecided) << words_of(d);
  EXPECT_THAT(names_of(d), testing::UnorderedElementsAre(of_ratio, of_sleeves)) << words_of(d);
  expect_found(d, of_ratio, 2.19, 0.05);
  test::expect_round_trip_of({.diagnosis = d});
}

/// The static stiffness alone carries the weight, which the frequencies show.
TEST(Elastomers, AreToldFromSleevesByWeight) {
  const auto d = of_fault(heavy, "legs.guide_sleeve.elastomer.dynamic_ratio=1.193", false);
  EXPECT_THAT(names_of(d), testing::ElementsAre(of_ratio)) << words_of(d);
  expect_found(d, of_ratio, 1.193, 0.05);
}

/// Loss is damping.
TEST(Elastomers, LoseWhatDampingRatiosShow) {
  const auto d = of_fault(heavy, "legs.guide_sleeve.elastomer.loss_factor=0.53", true);
  EXPECT_THAT(names_of(d), testing::ElementsAre(of_loss)) << words_of(d);
  expect_found(d, of_loss, 0.53, 0.05);
}

TEST(Elastomers, AsStatedAreNotBlamed) {
  const auto d = of_fault(heavy, nothing, true);
  EXPECT_EQ(d.finding, Finding::nominal) << words_of(d);
}

}  // namespace
}  // namespace hydrapod::diagnosis
