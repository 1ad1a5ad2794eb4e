/// Hypotheses that go on from what others found.

#include <gtest/gtest.h>

#include "blind_series.hpp"
#include "diagnosis/evidence.hpp"

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

}  // namespace
}  // namespace hydrapod::diagnosis
