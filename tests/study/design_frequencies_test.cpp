/// Frequencies of many designs at once are those of modal::normal_modes() of each.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/study/study.hpp"
#include "support/kinds.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;

constexpr int designs = 19;  // whole lanes and a part

/// Row by row.
std::vector<double> one_at_a_time(const model::Machine& machine,
                                  const std::vector<model::ParameterId>& ids,
                                  const std::vector<double>& values, ModelKind kind) {
  std::vector<double> all;
  for (std::size_t row = 0; row < values.size() / ids.size(); ++row) {
    std::vector<model::Assignment> assignments;
    for (std::size_t k = 0; k < ids.size(); ++k)
      assignments.push_back({ids[k], values[row * ids.size() + k]});
    try {
      const auto modes = modal::normal_modes(dynamics::linear_model(
          model::with(machine, assignments), machine.poses.back().X_BP, kind));
      for (int k = 0; k < modes.size(); ++k) all.push_back(modes.omega(k));
    } catch (const base::ComputationError&) {
      all.insert(all.end(), static_cast<std::size_t>(dynamics::degrees_of_freedom(machine, kind)),
                 std::nan(""));
    }
  }
  return all;
}

/// What differs between designs: sleeves from soft ones, whose legs may fold, to nearly rigid ones,
/// which no kernel without shapes takes; the mass; one leg's case.
struct Table {
  std::vector<model::ParameterId> ids{};
  std::vector<double> values{};
  Table(const model::Machine& machine, Random& random, double softest, double stiffest) {
    for (const char* path :
         {"legs.guide_sleeve.stiffness", "platform.mass", "leg.3.case.transverse_inertia"})
      ids.push_back(*model::find_parameter(machine, path));
    for (int k = 0; k < designs; ++k) {
      values.push_back(machine.legs[0].guide_sleeve.stiffness *
                       random.log_uniform(softest, stiffest));
      values.push_back(machine.platform.mass * random.uniform(0.7, 1.9));
      values.push_back(machine.legs[2].cylinder_case.transverse_inertia * random.uniform(0.4, 1.3));
    }
  }
};

class DesignFrequencies : public testing::TestWithParam<AxesAndKind> {
 protected:
  /// Calls each(ω, ω of one design at a time).
  template <class Each>
  void compare(const model::Machine& machine, const Table& table, const Each& each) const {
    const auto kind = std::get<1>(GetParam());
    study::DesignFrequencies frequencies(machine, machine.poses.back().X_BP, kind, table.ids);
    const auto expected = one_at_a_time(machine, table.ids, table.values, kind);
    std::vector<double> omega(expected.size());
    frequencies(table.values, omega);
    for (std::size_t k = 0; k < omega.size(); ++k) each(omega[k], expected[k]);
  }
  Random random_{3307};
};

/// Under gravity they have what Newton's last step leaves; beside sleeves that are nearly rigid,
/// their share of what rounding leaves in the matrices.
TEST_P(DesignFrequencies, AreThoseOfOneDesignAtATime) {
  for (int trial = 0; trial < 12; ++trial) {
    const auto gravity = Gravity{trial % 3};
    const auto machine =
        random_machine(random_, {.axes = std::get<0>(GetParam()), .gravity = gravity});
    const bool stiff = trial % 2 == 1;
    const double tolerance = stiff ? 5e-11 : gravity == Gravity::none ? 1e-12 : 1e-11;
    compare(machine, Table(machine, random_, 0.3, stiff ? 1e5 : 100.0),
            [&](double omega, double expected) {
              EXPECT_EQ(std::isnan(omega), std::isnan(expected));
              if (!std::isnan(expected)) {
                EXPECT_NEAR(omega, expected, tolerance * expected);
              }
            });
  }
}

TEST_P(DesignFrequencies, OfLegsThatFoldAreNone) {
  if (std::get<1>(GetParam()) == ModelKind::rigid) return;
  int buckled = 0, none = 0;
  for (int trial = 0; trial < 12; ++trial) {
    const auto machine =
        random_machine(random_, {.axes = std::get<0>(GetParam()), .gravity = Gravity::down});
    compare(machine, Table(machine, random_, 1e-6, 1e-2), [&](double omega, double expected) {
      EXPECT_EQ(std::isnan(omega), std::isnan(expected));
      EXPECT_EQ(omega == 0.0, expected == 0.0);
      buckled += expected == 0.0 ? 1 : 0;
      none += std::isnan(expected) ? 1 : 0;
    });
  }
  EXPECT_GT(buckled, 0);
  EXPECT_GT(none, 0);
}

INSTANTIATE_TEST_SUITE_P(, DesignFrequencies,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

/// Bit for bit, in whatever lane they stand; also of parts that no kernel knows.
TEST(DesignFrequenciesOfATable, DoNotDependOnTheDesignsBeside) {
  Random random(91);
  for (const bool gap : {false, true}) {
    auto machine = random_machine(random, {.gravity = Gravity::down});
    if (gap) machine.legs[4].guide_sleeve.gap = 1.7e-4;
    const Table table(machine, random, 0.2, 1e4);
    study::DesignFrequencies frequencies(machine, machine.poses.back().X_BP, ModelKind::guide,
                                         table.ids);
    std::vector<double> together(designs * 18), alone(18);
    frequencies(table.values, together);
    const std::size_t columns = table.ids.size();
    for (std::size_t row = 0; row < designs; ++row) {
      frequencies(std::span(table.values).subspan(row * columns, columns), alone);
      for (std::size_t k = 0; k < 18; ++k) EXPECT_EQ(alone[k], together[row * 18 + k]);
    }
  }
}

}  // namespace
}  // namespace hydrapod::test
