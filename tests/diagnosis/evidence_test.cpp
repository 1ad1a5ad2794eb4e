/// What counts as measured, shares of shapes, and hypotheses that go on from what others found.

#include <gtest/gtest.h>

#include <bit>

#include "blind_series.hpp"
#include "diagnosis/evidence.hpp"
#include "diagnosis/ranking.hpp"
#include "hydrapod/modal/normal_modes.hpp"

namespace hydrapod::diagnosis {
namespace {

constexpr double soft = 0.12586e6;  // [N/m]

/// The published machine with soft sleeves, its plant measured, and hypotheses of that.
class Learning : public testing::Test {
 protected:
  Learning() : causes_(causes_of(file_)), evidence_(file_, targets_, kind, causes_) {}

  [[nodiscard]] std::size_t index_of(const std::string& name) const {
    return static_cast<std::size_t>(std::ranges::find(causes_, name, report::cause_name) -
                                    causes_.begin());
  }
  /// With its first number at `value`.
  [[nodiscard]] Hypothesis at(std::vector<std::size_t> causes, double value) const {
    auto e = evidence_.explain(causes, nullptr, {});
    e.fit.parameters[0].value = value;
    evidence_.see(e);
    return e;
  }
  [[nodiscard]] std::vector<std::vector<const Hypothesis*>> known(const Hypothesis& of) const {
    std::vector<std::vector<const Hypothesis*>> found(causes_.size());
    for (const auto k : of.causes) found[k].push_back(&of);
    return found;
  }

  static constexpr auto kind = dynamics::ModelKind::guide;
  const test::BlindCase case_{.machine = "zhang-jiang-2021.toml", .repetition = 3};
  const model::MachineFile file_ = test::machine_file(case_.text(), {});
  const observation::Targets targets_ = weighted_targets(file_, measured(), {});
  const std::vector<Cause> causes_;
  const Evidence evidence_;

 private:
  [[nodiscard]] observation::Targets measured() const {
    test::Random random(163u);
    const auto truth =
        test::machine_file(case_.text(), {fmt::format("legs.guide_sleeve.stiffness={}", soft)});
    return test::noisy_plant_modes(truth.machine, {"neutral"}, kind,
                                   {.frequency = 1e-3, .shape = 0.03}, random);
  }
};

TEST_F(Learning, GoesOnFromBetterNumbersOfAnother) {
  const auto sleeves = index_of("guide sleeves of all legs");
  const auto pair = at({sleeves, index_of("oil springs of all legs")}, 1.03 * soft);
  auto single = at({sleeves}, 2.7 * soft);
  const double before = single.misfit;
  ASSERT_FALSE(same_numbers(pair, single));
  evidence_.learn(single, known(pair), {});
  EXPECT_LT(single.misfit, 0.1 * before);
  EXPECT_NEAR(single.fit.parameters[0].value, soft, 3.0 * single.fit.parameters[0].deviation);
  // what the file states, not where the other ended
  EXPECT_DOUBLE_EQ(single.fit.parameters[0].start, file_.machine.legs[0].guide_sleeve.stiffness);
}

TEST_F(Learning, KeepsItsOwnWhereThoseAreWorse) {
  const auto sleeves = index_of("guide sleeves of all legs");
  const auto pair = at({sleeves, index_of("oil springs of all legs")}, 2.7 * soft);
  auto single = at({sleeves}, 0.99 * soft);
  const double before = single.misfit, value = single.fit.parameters[0].value;
  evidence_.learn(single, known(pair), {});
  EXPECT_EQ(single.misfit, before);
  EXPECT_EQ(single.fit.parameters[0].value, value);
}

/// The machine that made the modes of the plant is found again by mechanics, without a misfit.
TEST(ByMechanics, ThePlantOfTheMachineItselfIsExplained) {
  constexpr auto kind = dynamics::ModelKind::guide;
  const auto file =
      test::machine_file(test::read_text(test::source_file("models/heavy-platform.toml")), {});
  test::Random random(5);
  const auto targets = weighted_targets(
      file,
      test::noisy_plant_modes(file.machine, {"neutral"}, kind,
                              {.frequency = 0.0, .damping = 0.0, .shape = 0.0}, random),
      {.frequency_error = 1e-4});
  const auto causes = causes_of(file);
  const Evidence evidence(file, targets, kind, causes);
  const auto leg3 = std::ranges::find(causes, "guide sleeve of leg 3", report::cause_name);
  ASSERT_NE(leg3, causes.end());
  const auto found =
      evidence.explain({static_cast<std::size_t>(leg3 - causes.begin())}, nullptr, {});
  const double stated = file.machine.legs[2].guide_sleeve.stiffness;
  EXPECT_TRUE(found.by_mechanics);
  EXPECT_NEAR(found.fit.parameters[0].value, stated, 1e-3 * stated);
  EXPECT_LT(found.misfit, 1e-3);
}

/// As many hypotheses of m causes as there are ways to choose them, counted one by one.
TEST(Penalty, IsTwiceTheLogarithmOfTheNumberOfHypotheses) {
  for (const std::size_t causes : {2U, 3U, 7U, 13U})
    for (const std::size_t held : {1U, 2U}) {
      int ways = 0;
      for (unsigned chosen = 0; chosen < 1U << causes; ++chosen)
        ways += std::popcount(chosen) == static_cast<int>(held) ? 1 : 0;
      EXPECT_NEAR(hypothesis_penalty(causes, held), 2.0 * std::log(ways), 1e-12)
          << held << " of " << causes;
    }
  EXPECT_EQ(hypothesis_penalty(9, 0), 0.0);
}

/// Of frequencies, damping ratios and shapes: what the measurement states and what the model
/// leaves.
TEST(WeightedTargets, HaveBothErrors) {
  const auto file =
      test::machine_file(test::read_text(test::source_file("models/zhang-jiang-2021.toml")), {});
  observation::Targets measured{.deviations_given = true};
  measured.modes.resize(2);
  for (auto& mode : measured.modes) mode.pose = "neutral";
  measured.modes[0].direction = measured.modes[1].direction = 2;
  measured.modes[0].omega = 41.0;
  measured.modes[0].deviation = 0.07;
  measured.modes[0].shape = spatial::Vector6::Unit(2);
  measured.modes[0].shape_deviation = 0.011;
  measured.modes[1].omega = 57.0;
  measured.modes[1].damping = 0.03;
  measured.modes[1].damping_deviation = 0.002;
  const DiagnoseOptions options{
      .frequency_error = 1.3e-3, .shape_error = 0.04, .damping = true, .damping_error = 0.21};
  const auto weighted = weighted_targets(file, measured, options);
  EXPECT_NEAR(weighted.modes[0].deviation, std::sqrt(0.07 * 0.07 + std::pow(1.3e-3 * 41.0, 2)),
              1e-14);
  EXPECT_NEAR(weighted.modes[0].shape_deviation, std::sqrt(0.011 * 0.011 + 0.04 * 0.04), 1e-14);
  EXPECT_NEAR(weighted.modes[1].damping_deviation,
              std::sqrt(0.002 * 0.002 + std::pow(0.21 * 0.03, 2)), 1e-14);
  // a shape of six numbers has a scale that says nothing
  EXPECT_EQ(values_in(weighted), 1 + 5 + 1 + 1);
  measured.deviations_given = false;
  EXPECT_NEAR(weighted_targets(file, measured, options).modes[0].deviation, 1.3e-3 * 41.0, 1e-14);
}

/// With the whole basis of the flexible machine's shapes a rigid shape is had to the full.
TEST(RigidShare, OfAllShapesSumsToOne) {
  const auto machine =
      test::machine_file(test::read_text(test::source_file("models/heavy-platform.toml")), {})
          .machine;
  const auto flexible =
      dynamics::linear_model(machine, machine.neutral(), dynamics::ModelKind::guide);
  const auto modes = modal::normal_modes(flexible);
  spatial::Vector6 psi;
  psi << 0.7, -1.2, 0.4, 2.1, -0.3, 0.9;
  double sum = 0.0;
  for (int k = 0; k < modes.size(); ++k) sum += rigid_share(flexible, psi, modes.shapes.col(k));
  EXPECT_NEAR(sum, 1.0, 1e-9);
}

}  // namespace
}  // namespace hydrapod::diagnosis
