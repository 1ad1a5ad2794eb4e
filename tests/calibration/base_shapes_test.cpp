/// Shapes on a base that gives way: against the ground, as accelerometers feel them, or against the
/// base, as leg lengths show them.

#include <gtest/gtest.h>

#include <algorithm>

#include "calibration/problem.hpp"
#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/observation/pairing.hpp"
#include "support/calibration_machine.hpp"

namespace hydrapod::calibration {
namespace {

using namespace observation;

using dynamics::ModelKind;

const std::vector<std::string> parameters{"base.mount.stiffness.x",  "base.mount.stiffness.y",
                                          "base.mount.stiffness.rx", "base.mount.mass",
                                          "platform.mass",           "platform.mass_center[2]",
                                          "legs.rod.length",         "leg.3.oil_spring.stiffness"};

/// A random machine on a mount a few times as stiff as its legs, in every direction.
model::MachineFile on_soft_mount(std::uint64_t seed, bool gravity) {
  test::Random random(seed);
  const auto text = test::random_machine_text(random, gravity);
  const auto machine = test::machine_file(text).machine;
  const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::rigid);
  const double k = 1.7 * model.K(2, 2), height = model.p_BC.z();
  std::vector<std::string> overrides{
      fmt::format("base.mount.mass={:.17g}", 0.0031 * machine.platform.mass)};
  const auto add = [&](const char* direction, double stiffness) {
    overrides.push_back(fmt::format("base.mount.stiffness.{}={:.17g}", direction, stiffness));
  };
  add("x", 1.1 * k);
  add("y", 0.29 * k);
  add("z", 2.3 * k);
  add("rx", 1.3 * k * height * height);
  add("ry", 0.4 * k * height * height);
  return test::machine_file(text, overrides);
}

/// Those of its modes that the platform feels and that no measurement takes for another, with
/// shapes of a point, against ground or base, bent by `error` of themselves.
Targets targets_of(const model::MachineFile& file, ModelKind kind, MotionAgainst against,
                   const std::optional<spatial::Vector3>& point, double error) {
  test::Random random(41);
  Targets targets;
  for (const char* pose : {"neutral", "shifted"}) {
    const auto& X_BP = std::ranges::find(file.machine.poses, pose, &model::NamedPose::name)->X_BP;
    const auto model = dynamics::linear_model(file.machine, X_BP, kind);
    const auto modes = modal::normal_modes(model);
    const auto here = test::modes_of(file, pose, kind);
    for (int k = 0; k < modes.size(); ++k) {
      Vector6 shape = modes.shapes.col(k).head<6>();
      if (shape.dot(model.platform_mass * shape) < 0.01) continue;
      if (modal::neighbours(modes, k, 2.0 * ObservationOptions{}.same_frequency).size() > 1)
        continue;
      auto target = here[static_cast<std::size_t>(k)];
      if (against == MotionAgainst::base) shape = model.against_base * modes.shapes.col(k);
      if (point)
        shape.head<3>() += spatial::Vector3(shape.tail<3>()).cross(X_BP * *point - model.p_BC);
      for (double& s : shape) s *= 1.0 + error * test::normal(random);
      target.shape = -2.9 * shape;
      target.shape_deviation = 0.02;
      target.shape_point = point;
      target.shape_against = against;
      targets.modes.push_back(target);
    }
  }
  return targets;
}

struct Case {
  ModelKind kind;
  MotionAgainst against;
  bool of_point, gravity;
};

class BaseShapes : public testing::TestWithParam<Case> {};

/// The residuals' derivatives against differences of the residuals, six neighbours each: O(h⁶).
TEST_P(BaseShapes, HaveExactDerivatives) {
  const auto [kind, against, of_point, gravity] = GetParam();
  const auto file = on_soft_mount(29, gravity);
  std::optional<spatial::Vector3> point;
  if (of_point) point = {0.17, -0.23, 0.11};
  const auto targets = targets_of(file, kind, against, point, 0.07);
  std::vector<Variable> variables;
  for (const auto& path : parameters) {
    const auto number = find_number(file, path).value();
    const double value = number.value;
    variables.push_back({.paths = {path},
                         .ids = {number.id},
                         .start = value,
                         .lower = 0.1 * value,
                         .upper = 10.0 * value,
                         .scale = std::abs(value)});
  }
  const Problem problem(file.machine, targets, variables, kind, {.hold_to_physics = false});
  const Eigen::VectorXd x = problem.start();
  const auto at = [&](const Eigen::VectorXd& where, Eigen::MatrixXd* J) {
    State state;
    EXPECT_TRUE(problem.evaluate(where, J != nullptr, state));
    Eigen::VectorXd r;
    problem.residuals(where, state, r, J);
    return r;
  };
  Eigen::MatrixXd J;
  const Eigen::VectorXd r = at(x, &J);
  ASSERT_GE(targets.modes.size(), 8U);
  ASSERT_EQ(r.size(), 7 * std::ssize(targets.modes));
  constexpr double h = 3e-4;
  for (int j = 0; j < problem.size(); ++j) {
    const auto beside = [&](int steps) {
      return at(x + steps * h * Eigen::VectorXd::Unit(problem.size(), j), nullptr);
    };
    const Eigen::VectorXd expected = (45.0 * (beside(1) - beside(-1)) -
                                      9.0 * (beside(2) - beside(-2)) + (beside(3) - beside(-3))) /
                                     (60.0 * h);
    for (Eigen::Index row = 0; row < r.size(); ++row)
      EXPECT_NEAR(J(row, j), expected[row], 1e-6 * J.col(j).norm())
          << parameters[static_cast<std::size_t>(j)] << ", row " << row;
  }
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const auto against : {MotionAgainst::ground, MotionAgainst::base})
    for (const bool of_point : {false, true}) {
      all.push_back({ModelKind::rigid, against, of_point, true});
      all.push_back({ModelKind::guide, against, of_point, of_point});
    }
  return all;
}

std::string case_name(const testing::TestParamInfo<Case>& info) {
  const auto [kind, against, of_point, gravity] = info.param;
  return fmt::format("{}_{}_{}{}", dynamics::name(kind), name(against),
                     of_point ? "point" : "center", gravity ? "_gravity" : "");
}

INSTANTIATE_TEST_SUITE_P(, BaseShapes, testing::ValuesIn(cases()), case_name);

/// Shapes alone tell the mount's stiffness, if it is known what they are against.
TEST(BaseShapesAlone, TellTheStiffnessOfTheMount) {
  const auto truth = on_soft_mount(37, false);
  for (const auto against : {MotionAgainst::ground, MotionAgainst::base}) {
    auto targets = targets_of(truth, ModelKind::rigid, against, spatial::Vector3::Zero(), 0.0);
    for (auto& mode : targets.modes) mode.deviation = 0.05 * mode.omega;
    Plan plan;
    for (const char* path : {"base.mount.stiffness.x", "base.mount.stiffness.rx"}) {
      const double value = find_number(truth, path)->value;
      plan.free.push_back(
          {.paths = {path}, .start = 1.4 * value, .lower = 0.2 * value, .upper = 5.0 * value});
    }
    plan.options.starts = 1;
    const auto right = calibrate(truth, targets, plan, ModelKind::rigid).best();
    for (const auto& p : right.parameters) {
      const double value = find_number(truth, p.paths.front())->value;
      EXPECT_NEAR(p.value, value, 1e-4 * value) << p.paths.front() << " " << name(against);
    }
    for (auto& mode : targets.modes)
      mode.shape_against =
          against == MotionAgainst::base ? MotionAgainst::ground : MotionAgainst::base;
    EXPECT_GT(calibrate(truth, targets, plan, ModelKind::rigid).best().misfit,
              100.0 + right.misfit);
    const auto fits = [&](MotionAgainst taken) {
      double worst = 1.0;
      for (auto& mode : targets.modes) mode.shape_against = taken;
      for (const auto& fit : compare(truth, targets, ModelKind::rigid).targets)
        worst = std::min(worst, fit.shape_mac);
      return worst;
    };
    EXPECT_GT(fits(against), 1.0 - 1e-6);
    EXPECT_LT(fits(against == MotionAgainst::base ? MotionAgainst::ground : MotionAgainst::base),
              0.95);
  }
}

}  // namespace
}  // namespace hydrapod::calibration
