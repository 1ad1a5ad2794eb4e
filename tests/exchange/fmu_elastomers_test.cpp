/// FMUs of machines whose elastomers soften under large amplitudes.

#include <gtest/gtest.h>

#include <algorithm>

#include "exchange/fmu_subject.hpp"
#include "support/softening_machine.hpp"

namespace hydrapod::test {
namespace {

/// An amplitude that the noise of the inputs reaches.
model::Machine machine() { return with_softening(machine_of("heavy-platform"), 2.3e-6, 0.31); }

class SofteningFmu : public testing::TestWithParam<Case> {};

TEST_P(SofteningFmu, HasTheStatesOfThePlant) {
  const Subject subject(GetParam(), machine());
  EXPECT_EQ(1U, subject.fmu.references.count("leg2.sleeve_amplitude_square"));
  EXPECT_EQ(1U, subject.fmu.references.count("leg6.sleeve_mean_a2"));
  EXPECT_EQ(0U, subject.fmu.references.count("leg1.sleeve_amplitude_square"));
  EXPECT_EQ(subject.states.size(), static_cast<std::size_t>(subject.plant.layout().size));
  const auto is_told = [&](const char* text) {
    return subject.fmu.description.find(text) != std::string::npos;
  };
  EXPECT_TRUE(is_told("description=\"way of a damper in an elastomer seal\""));
  EXPECT_TRUE(is_told("description=\"mean position of an elastomer seal\""));
  EXPECT_FALSE(is_told("description=\"bend of the seal"));  // there are no bristles
}

TEST_P(SofteningFmu, FollowsThePlant) {
  const Subject subject(GetParam(), machine());
  expect_same_motion(subject, 100);
}

TEST_P(SofteningFmu, DerivativesAreThoseOfDifferences) {
  Random random(13);
  expect_derivatives_of_differences(Subject(GetParam(), machine()), random);
}

TEST_P(SofteningFmu, SavedStatesContinueBitByBit) {
  expect_saved_states_continue(Subject(GetParam(), machine()));
}

/// Offsets count from the rest under the load at the start.
TEST_P(SofteningFmu, CannotBeTunedInWhatItRestsUnder) {
  const Subject subject(GetParam(), machine());
  const Slave slave(subject.fmu, true);
  EXPECT_EQ(error, slave.set("platform.mass", 1.01 * subject.machine.platform.mass));
  EXPECT_EQ(error, slave.set("leg2.guide_sleeve.stiffness", 3e7));
}

/// The same number of states, of other seals.
TEST_P(SofteningFmu, CannotBeTunedToSoftenOtherSeals) {
  const Subject subject(GetParam(), machine());
  ASSERT_EQ(subject.machine.legs[0].guide_sleeve.elastomer->softening, 0.0);
  const Slave slave(subject.fmu, true);
  EXPECT_EQ(error, slave.set({subject.fmu.reference("leg1.guide_sleeve.elastomer.softening"),
                              subject.fmu.reference("leg2.guide_sleeve.elastomer.softening")},
                             {0.3, 0.0}));
}

INSTANTIATE_TEST_SUITE_P(
    Fmu, SofteningFmu, testing::Values(Case{FmuVersion::fmi2, true}, Case{FmuVersion::fmi3, false}),
    [](const auto& of) { return std::string(of.param.hydraulics ? "Plant" : "Mechanics"); });

}  // namespace
}  // namespace hydrapod::test
