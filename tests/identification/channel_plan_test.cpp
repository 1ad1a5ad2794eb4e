/// Which channels are inputs, outputs and instruments, and which estimate that asks for.

#include "identification/channel_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hydrapod/base/error.hpp"

namespace hydrapod::identification {
namespace {

using testing::ElementsAre;

/// r1, r2, u1, u2, y1: motions and forces as units tell them, so that no role says that there is a
/// loop.
data::RecordHeader told_by_units() {
  data::RecordHeader header;
  for (const char* name : {"r1", "r2", "u1", "u2", "y1"})
    header.channels.push_back(
        {.name = name,
         .unit = name[0] == 'u' ? "N" : "m",
         .role = name[0] == 'u' ? data::Role::excitation : data::Role::response});
  return header;
}

/// H1 from inputs in a loop is biased: who names the excitation wants the other one.
TEST(ChannelPlan, NamedInstrumentsAreUsedAndAreNoOutputs) {
  const auto plan = plan_channels("run.csv", told_by_units(), {.instruments = {"r1", "r2"}});
  EXPECT_EQ(plan.estimator, Estimator::instrumental);
  EXPECT_THAT(plan.choice.inputs, ElementsAre(2, 3));
  EXPECT_THAT(plan.choice.outputs, ElementsAre(4));
  EXPECT_THAT(plan.choice.instruments, ElementsAre(0, 1));
}

TEST(ChannelPlan, WithoutThemExcitationsAreInputs) {
  const auto plan = plan_channels("run.csv", told_by_units(), {});
  EXPECT_EQ(plan.estimator, Estimator::h1);
  EXPECT_THAT(plan.choice.inputs, ElementsAre(2, 3));
  EXPECT_THAT(plan.choice.outputs, ElementsAre(0, 1, 4));
  EXPECT_THAT(plan.choice.instruments, ElementsAre());
}

/// An estimate that is asked for stays: h1 is compared with the instrumental one then.
TEST(ChannelPlan, TheEstimateThatIsAskedForStays) {
  const auto plan = plan_channels("run.csv", told_by_units(),
                                  {.instruments = {"r1", "r2"}, .estimator = Estimator::h1});
  EXPECT_EQ(plan.estimator, Estimator::h1);
  EXPECT_THAT(plan.choice.instruments, ElementsAre(0, 1));
}

TEST(ChannelPlan, InputsAreOtherChannelsThanTheInstruments) {
  auto header = told_by_units();
  for (int c : {0, 1}) header.channels[c].role = data::Role::excitation;
  for (int c : {2, 3}) header.channels[c].role = data::Role::drive;
  const auto plan = plan_channels("run.csv", header, {.instruments = {"r1", "r2"}});
  EXPECT_THAT(plan.choice.inputs, ElementsAre(2, 3)) << "forces in the drives";
  EXPECT_EQ(plan.estimator, Estimator::instrumental);
  EXPECT_THROW(
      plan_channels("run.csv", header, {.inputs = {"r1", "r2"}, .instruments = {"r1", "r2"}}),
      base::InputError);
}

}  // namespace
}  // namespace hydrapod::identification
