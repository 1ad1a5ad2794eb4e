/// Rows computed in SIMD lanes against rows computed one at a time.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hydrapod/study/study.hpp"
#include "support/kinds.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::study {
namespace {

using dynamics::ModelKind;
using test::Gravity;

struct Difference {
  int computed{}, refused{};
  std::size_t alone{};
  double relative{};  ///< of any output but the next, largest
  double shapes{};    ///< of what follows from shapes: MAC, shares and peaks
};

bool is_of_shapes(const std::string& name) {
  return name == "mac" || name.starts_with("share") || name.starts_with("peak");
}

/// Both ways through `plan`. Equal in status and in what is missing.
Difference compared(const Problem& problem, const Plan& plan) {
  const std::size_t inputs = problem.inputs.size(), outputs = problem.outputs.size();
  std::vector<double> numbers(plan.samples * (inputs + outputs)), expected(outputs);
  Difference difference;
  difference.alone = Evaluator(problem).rows(plan, 0, numbers).value();
  const auto model = problem.model();
  for (std::uint64_t row = 0; row < plan.samples; ++row) {
    const auto values = std::span(numbers).subspan(row * (inputs + outputs), inputs + outputs);
    model(values.first(inputs), expected);
    ++(expected[0] == 0.0 ? difference.computed : difference.refused);
    for (std::size_t k = 0; k < outputs; ++k) {
      const double found = values[inputs + k];
      EXPECT_EQ(std::isnan(found), std::isnan(expected[k])) << problem.outputs[k].name;
      if (std::isnan(found) || found == expected[k]) continue;
      const bool share = problem.outputs[k].unit == "1";  // of a drop: against 1
      const double scale = share ? std::max(1.0, std::abs(expected[k])) : std::abs(expected[k]);
      auto& largest =
          is_of_shapes(problem.outputs[k].name) ? difference.shapes : difference.relative;
      largest = std::max(largest, std::abs(found - expected[k]) / scale);
    }
  }
  return difference;
}

/// Frequencies are Rayleigh quotients: their error is the square of that of the shapes.
constexpr double same = 1e-12;
/// Of the shapes of close modes themselves; epsilons of ω²_max over the distance to the next mode.
constexpr double same_shapes = 1e-7;

class Batches : public testing::TestWithParam<test::AxesAndKind> {
 protected:
  void SetUp() override {
    if (std::get<1>(GetParam()) == ModelKind::rigid) GTEST_SKIP() << "nothing varies in its legs";
  }
  [[nodiscard]] Problem problem_of(Gravity gravity, const char* mass) {
    const auto [axes, kind] = GetParam();
    model::MachineFile file;
    file.machine = test::random_machine(random_, {.axes = axes, .gravity = gravity});
    auto inputs = read_variation(file, "legs.guide_sleeve.stiffness", "uniform ± 20 % per leg", "");
    inputs.push_back(read_variation(file, "platform.mass", mass, "").front());
    return machine_problem(file.machine, inputs,
                           {.kind = kind, .X_BP = file.machine.poses.back().X_BP});
  }
  test::Random random_{2102};
};

TEST_P(Batches, HaveTheRowsOfSingleSamples) {
  for (int machine = 0; machine < 12; ++machine) {
    const auto problem =
        problem_of(machine % 2 == 0 ? Gravity::none : Gravity::down, "uniform ± 10 %");
    const auto difference = compared(problem, {.samples = 45, .seed = 7});
    EXPECT_GT(difference.computed, 0);
    EXPECT_EQ(difference.alone, 0U);
    EXPECT_LE(difference.relative, same) << "machine " << machine;
    EXPECT_LE(difference.shapes, same_shapes) << "machine " << machine;
  }
}

/// Platforms up to twenty times as heavy: legs fold, buckle or have no equilibrium.
TEST_P(Batches, RefuseTheSameSamples) {
  int refused = 0, computed = 0;
  for (int machine = 0; machine < 6; ++machine) {
    auto problem = problem_of(Gravity::down, "uniform ± 10 %");
    auto& mass = problem.inputs.back().distribution;
    mass.a = -0.5 * mass.b;  // also masses that are not allowed
    mass.b *= 20.0;
    const auto difference = compared(problem, {.samples = 60, .seed = 8});
    refused += difference.refused;
    computed += difference.computed;
    EXPECT_LE(difference.relative, same) << "machine " << machine;
    EXPECT_LE(difference.shapes, same_shapes) << "machine " << machine;
  }
  EXPECT_GT(refused, 50);
  EXPECT_GT(computed, 20);
}

INSTANTIATE_TEST_SUITE_P(, Batches,
                         testing::Combine(test::both_axes(),
                                          testing::Values(ModelKind::guide, ModelKind::full)),
                         [](const auto& one) { return test::name(one); });

TEST(BatchesOfPoses, HaveTheRowsOfSinglePoses) {
  test::Random random(2103);
  const auto machine = test::random_machine(random);
  std::vector<Input> inputs;
  for (const char* name : {"x", "z", "ry"})
    inputs.push_back({.name = name,
                      .unit = name[0] == 'r' ? "rad" : "m",
                      .distribution = {.shape = Shape::uniform, .a = -0.05, .b = 0.05}});
  const auto problem = machine_problem(
      machine, inputs, {.kind = ModelKind::guide, .X_BP = machine.neutral(), .poses = true});
  const auto difference = compared(problem, {.samples = 200, .seed = 9});
  EXPECT_GT(difference.computed, 20);
  EXPECT_LE(difference.relative, same);
  EXPECT_LE(difference.shapes, same_shapes);
}

}  // namespace
}  // namespace hydrapod::study
