/// Table 2 of Zhang & Jiang 2021 from their Table 1.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/model/machine_file.hpp"
#include "support/calibration_machine.hpp"
#include "support/places.hpp"
#include "support/run_program.hpp"

namespace hydrapod::calibration {
namespace {

using namespace observation;

using testing::Contains;
using testing::HasSubstr;

struct Published {
  model::MachineFile file = model::read_machine_file(
      test::source_file("examples/zhang-jiang-2021/table-1.toml"), {}, kinematics::check_machine);
  TargetsFile measured =
      read_targets(test::source_file("examples/zhang-jiang-2021/table-2.toml").string());
};

/// The set of models/zhang-jiang-2021.toml must not be where the search begins.
TEST(Published, NoStartingValueIsNearTheKnownSet) {
  const Published published;
  const auto known = model::read_machine_file(test::source_file("models/zhang-jiang-2021.toml"));
  for (const auto& free : published.measured.plan.free)
    for (const auto& path : free.paths) {
      const double ratio =
          find_number(published.file, path)->value / find_number(known, path)->value;
      EXPECT_GT(std::abs(ratio - 1.0), 0.3) << path;
    }
  // nor where piston and sleeve stand, which follow from the lengths
  const double l = 0.8734095285480141;
  const auto guided = [&](const model::MachineFile& file) {
    return find_number(file, "legs.guide_sleeve.position")->value -
           (l - find_number(file, "legs.rod.length")->value);
  };
  EXPECT_GT(std::abs(guided(published.file) / guided(known) - 1.0), 0.3);
}

void expect_table_2(const Calibration& calibrated) {
  const Published published;
  const auto& best = calibrated.best();
  EXPECT_EQ(
      best.name,
      "joint circles swapped, mass centre below the joints, flexible axes along the gimbal's");
  EXPECT_TRUE(best.admissible());
  for (std::size_t i = 0; i < best.targets.size(); ++i) {
    const double printed = published.measured.targets.modes[i].omega;
    const bool of_platform = printed > 100.0 || printed < 50.0;
    EXPECT_NEAR(best.targets[i].omega, printed, of_platform ? 0.006 : 0.045) << i;
  }
  EXPECT_GE(best.worst, 0.040);  // what the cross of the gimbal explains, below
  EXPECT_GE(best.identifiability.numerical_rank, 8);
  EXPECT_LE(best.identifiability.numerical_rank, 11);
}

/// Of the others that can be built, one misses the group of one, the rest miss by far.
void expect_no_other_reading(const Calibration& calibrated) {
  const auto& candidates = calibrated.candidates;
  for (std::size_t k = 1; k < candidates.size(); ++k) {
    const bool axes_alone = candidates[k].choice == std::vector<std::size_t>{1, 1, 0};
    EXPECT_TRUE(!candidates[k].admissible() || candidates[k].worst > (axes_alone ? 0.06 : 1.0))
        << candidates[k].name;
  }
}

/// With "upper" = platform and the mass centre above, only bodies that cannot be come near Table 2.
void expect_bodies_that_cannot_be(const Calibration& calibrated) {
  int readings = 0;
  for (const auto& candidate : calibrated.candidates) {
    if (candidate.choice[0] != 0 || candidate.choice[1] != 0) continue;
    ++readings;
    ASSERT_TRUE(candidate.unbound) << candidate.name;
    EXPECT_LT(candidate.unbound->worst, 0.25 * candidate.worst) << candidate.name;
    EXPECT_THAT(candidate.unbound->violated, Contains(HasSubstr("no principal moment of inertia")));
  }
  EXPECT_EQ(readings, 2);
}

void expect_a_file_with_comments(const Calibration& calibrated) {
  const Published published;
  const auto& best = calibrated.best();
  const std::string text = calibrated_text(published.file, best, published.measured.targets);
  EXPECT_THAT(text, HasSubstr("# The hexapod of Zhang & Jiang"));
  EXPECT_THAT(text, HasSubstr("# kg [guess]; calibrated: mass "));
  EXPECT_THAT(text, HasSubstr("radius = 0.5995, spacing = 0.17"));
  EXPECT_THAT(text, HasSubstr("not determined by the data (was 12)"));
  const auto machine = test::machine_file(text).machine;
  const auto modes = modal::normal_modes(
      dynamics::linear_model(machine, machine.neutral(), dynamics::ModelKind::guide));
  for (const auto& fit : best.targets) EXPECT_NEAR(modes.omega(fit.mode), fit.omega, 1e-5);
}

/// The whole search takes minutes under sanitizers, where the tests of recovery run the same code.
class PublishedTables : public testing::Test {
 protected:
  void SetUp() override {
    if (test::sanitized) GTEST_SKIP() << "too slow under sanitizers";
  }
};

/// All eight readings of Table 1, with half of the starts of the documented command.
TEST_F(PublishedTables, Table2FollowsFromTable1) {
  const Published published;
  auto plan = published.measured.plan;
  plan.options.starts = 8;
  const auto calibrated =
      calibrate(published.file, published.measured.targets, plan, dynamics::ModelKind::guide);
  expect_table_2(calibrated);
  expect_no_other_reading(calibrated);
  expect_bodies_that_cannot_be(calibrated);
  expect_a_file_with_comments(calibrated);
}

/// The gimbal's cross separates the two bending planes of a leg, which no other number does.
TEST_F(PublishedTables, TheCrossOfTheGimbalExplainsTheRestOfTable2) {
  const std::vector<std::string> reading{
      "base.joints.circle.radius=0.5995", "platform.joints.circle.radius=0.4",
      "platform.mass_center[2]=-0.163", "model.flexible_axes=gimbal",
      "legs.gimbal_cross_inertia=0.05"};
  const auto file =
      model::read_machine_file(test::source_file("examples/zhang-jiang-2021/table-1.toml"), reading,
                               kinematics::check_machine);
  Plan plan = Published{}.measured.plan;
  plan.alternatives.clear();
  plan.options.starts = 128;
  plan.free.push_back({.paths = {"legs.gimbal_cross_inertia"}, .lower = 0.001, .upper = 3.0});
  const auto best =
      calibrate(file, Published{}.measured.targets, plan, dynamics::ModelKind::guide).best();
  EXPECT_TRUE(best.admissible());
  EXPECT_LE(best.worst, 0.030);
}

}  // namespace
}  // namespace hydrapod::calibration
