/// Modes whose seals are as stiff as at the frequency of each.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/modal/damped_modes.hpp"
#include "support/random_machine.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;

model::Machine with_rubber(model::Machine machine, double ratio = 1.9, double loss = 0.24) {
  for (std::size_t i = 0; i < model::leg_count; ++i)
    machine.legs[i].guide_sleeve.elastomer = {.dynamic_ratio = ratio,
                                              .loss_factor = loss,
                                              .frequency = 8.3 + 0.7 * static_cast<double>(i)};
  return machine;
}

modal::NormalModes of(const model::Machine& machine, ModelKind kind) {
  return modal::modes_with_elastomers(
      machine, dynamics::linear_model(machine, machine.poses.back().X_BP, kind));
}

/// They are all damped modes, each once, and lie between those of seals as stiff as at slow and at
/// quick motions.
TEST(ModesWithElastomers, HaveTheFrequenciesOfDampedModes) {
  Random random(4711);
  for (const auto kind : {ModelKind::guide, ModelKind::full}) {
    const auto machine = with_rubber(random_machine(random));
    const auto linear = dynamics::linear_model(machine, machine.poses.back().X_BP, kind);
    const auto quick = modal::normal_modes(linear);
    auto at_rest = linear;
    at_rest.K = dynamics::slow_stiffness(linear);
    const auto slow = modal::normal_modes(at_rest);
    const auto found = modal::modes_with_elastomers(machine, linear);
    std::vector<double> damped;
    for (const auto& mode : modal::damped_modes(linear, quick, modal::modal_ratio(machine).value))
      damped.push_back(mode.omega);
    std::ranges::sort(damped);
    ASSERT_EQ(static_cast<int>(damped.size()), found.size());
    bool between = false;
    for (int k = 0; k < found.size(); ++k) {
      const double omega = damped[static_cast<std::size_t>(k)];
      EXPECT_NEAR(found.omega(k), omega, 1e-12 * omega);
      EXPECT_GT(omega, (1.0 - 1e-9) * slow.omega(k));
      EXPECT_LT(omega, 1.0005 * quick.omega(k)) << "dampers beside the seals make some stiffer";
      between = between || (omega > 1.02 * slow.omega(k) && omega < 0.99 * quick.omega(k));
    }
    EXPECT_TRUE(between);
  }
}

/// Poles of equal seals that creep are real and repeat. Rounding makes pairs of them, which are no
/// modes.
TEST(ModesWithElastomers, AreAsManyAsCoordinatesWhereSealsAreEqual) {
  auto machine = symmetric_machine(9.81);
  for (const double stiffer : {1.0, 1.37})
    for (const double ratio : {1.07, 1.29, 1.61, 1.83, 2.7})
      for (const double loss : {0.04, 0.13, 0.26, 0.41})
        for (const double frequency : {0.9, 7.7, 23.0}) {
          auto soft = machine;
          for (auto& leg : soft.legs) {
            leg.guide_sleeve.stiffness *= stiffer;
            leg.guide_sleeve.elastomer = {
                .dynamic_ratio = ratio, .loss_factor = loss, .frequency = frequency};
          }
          for (const auto kind : {ModelKind::guide, ModelKind::full}) {
            const auto linear = dynamics::linear_model(soft, soft.neutral(), kind);
            const auto modes = modal::damped_modes(linear, modal::normal_modes(linear), 0.002);
            EXPECT_EQ(static_cast<int>(modes.size()), linear.dof())
                << stiffer << " " << ratio << " " << loss << " " << frequency;
          }
        }
}

/// Modes of the symmetric machine in x and y repeat, with elastomers as well.
TEST(ModesWithElastomers, KeepTheirGroups) {
  auto machine = symmetric_machine(9.81);
  for (auto& leg : machine.legs)
    leg.guide_sleeve.elastomer = {.dynamic_ratio = 1.7, .loss_factor = 0.19, .frequency = 11.0};
  const auto linear = dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
  const auto found = modal::modes_with_elastomers(machine, linear);
  for (int k = 0; k + 1 < found.size(); ++k) {
    EXPECT_LE(found.omega2[k], found.omega2[k + 1]);
    const bool together = found.group[k] == found.group[k + 1];
    EXPECT_EQ(together, found.omega2[k + 1] - found.omega2[k] <= 1e-10 * found.omega2[k + 1]);
    EXPECT_GE(found.group[k + 1], found.group[k]);
  }
  EXPECT_LT(found.group[found.size() - 1], found.size() - 1) << "none repeats";
  const Eigen::MatrixXd unit = found.shapes.transpose() * linear.M * found.shapes;
  EXPECT_LT((unit - Eigen::MatrixXd::Identity(found.size(), found.size())).norm(), 1e-9);
}

TEST(ModesWithElastomers, AreTheUndampedOnesOfIdealSeals) {
  Random random(4712);
  const auto ideal = random_machine(random);
  const auto linear = dynamics::linear_model(ideal, ideal.poses.back().X_BP, ModelKind::guide);
  EXPECT_EQ(of(ideal, ModelKind::guide).omega2, modal::normal_modes(linear).omega2);
  const auto rubber = with_rubber(ideal);
  const auto rigid = dynamics::linear_model(rubber, rubber.poses.back().X_BP, ModelKind::rigid);
  EXPECT_EQ(of(rubber, ModelKind::rigid).omega2, modal::normal_modes(rigid).omega2);
}

}  // namespace
}  // namespace hydrapod::test
