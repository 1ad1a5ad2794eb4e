/// Derivatives of eigenvalues and shapes against differences of whole eigensolutions.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "calibration/problem.hpp"
#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "support/calibration_machine.hpp"
#include "support/run_program.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod {
namespace {

using dynamics::ModelKind;

const std::vector<std::string> every_sort{"platform.mass",
                                          "platform.mass_center[2]",
                                          "platform.mass_center[0]",
                                          "platform.inertia.xx",
                                          "platform.inertia.xy",
                                          "platform.joints.circle.radius",
                                          "base.joints.circle.spacing",
                                          "legs.case.mass",
                                          "legs.case.mass_center",
                                          "leg.4.case.transverse_inertia",
                                          "legs.rod.length",
                                          "leg.2.rod.mass",
                                          "legs.rod.mass_center",
                                          "legs.guide_sleeve.position",
                                          "leg.1.guide_sleeve.stiffness",
                                          "legs.oil_spring.stiffness",
                                          "legs.added_axial_inertia",
                                          "poses.shifted.position[2]",
                                          "poses.shifted.rotation[1]"};

/// f(h) of seven points: error O(h⁶).
template <class F>
auto high_order_difference(const F& f, double h) {
  return ((45.0 * (f(h) - f(-h)) - 9.0 * (f(2 * h) - f(-2 * h)) + (f(3 * h) - f(-3 * h))) /
          (60.0 * h))
      .eval();
}

class Derivatives : public testing::TestWithParam<bool> {};

TEST_P(Derivatives, OfEigenvaluesAgreeWithHighOrderDifferences) {
  const bool gravity = GetParam();
  test::Random random(gravity ? 71 : 17);
  for (int trial = 0; trial < 12; ++trial) {
    const auto file = test::machine_file(test::random_machine_text(random, gravity));
    const auto machine = test::varied(file, every_sort);
    const auto at = machine.values();
    std::vector<double> scales;
    for (const double value : at) scales.push_back(std::max(std::abs(value), 0.01));
    auto point = calibration::mode_point(machine.at(at), 1, ModelKind::guide);
    calibration::add_derivatives(machine, at, 1, scales, point);
    const double largest = point.modes.omega2.maxCoeff();
    for (std::size_t j = 0; j < at.size(); ++j) {
      const auto omega2_at = [&](double h) -> Eigen::VectorXd {
        auto values = at;
        values[j] += h;
        return calibration::mode_point(machine.at(values), 1, ModelKind::guide).modes.omega2;
      };
      const Eigen::VectorXd expected = high_order_difference(omega2_at, 1e-5 * scales[j]);
      const Eigen::VectorXd error =
          (point.domega2.col(static_cast<Eigen::Index>(j)) - expected) * scales[j];
      // seal modes come in close clusters, and rounding of ω² is of the largest one
      const Eigen::VectorXd size = (expected * scales[j]).cwiseAbs();
      for (Eigen::Index k = 0; k < error.size(); ++k)
        EXPECT_LE(std::abs(error[k]), 1e-6 * size[k] + 1e-9 * largest)
            << every_sort[j] << ", mode " << k << ", trial " << trial;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutGravity, Derivatives, testing::Bool());

TEST(Derivatives, OfShapesAgreeWithHighOrderDifferences) {
  test::Random random(23);
  for (int trial = 0; trial < 6; ++trial) {
    const auto file = test::machine_file(test::random_machine_text(random, false));
    const auto machine = test::varied(file, {"platform.mass", "leg.3.oil_spring.stiffness"});
    const auto values = machine.values();
    auto point = calibration::mode_point(machine.at(values), 1, ModelKind::rigid);
    calibration::add_derivatives(machine, values, 1, values, point);
    for (int k = 0; k < 6; ++k) {
      const Eigen::MatrixXd d = modal::shape_derivatives(point.modes, k, point.derivatives);
      for (int j = 0; j < 2; ++j) {
        const auto shape_at = [&](double h) -> Eigen::VectorXd {
          auto moved = values;
          moved[j] += h;
          Eigen::VectorXd shape =
              calibration::mode_point(machine.at(moved), 1, ModelKind::rigid).modes.shapes.col(k);
          const double same = shape.dot(point.model.M * point.modes.shapes.col(k));
          return same < 0.0 ? Eigen::VectorXd(-shape) : shape;
        };
        const Eigen::VectorXd expected = high_order_difference(shape_at, 1e-4 * values[j]);
        EXPECT_LE(((d.col(j) - expected) * values[j]).norm(),
                  1e-6 * point.modes.shapes.col(k).norm())
            << "mode " << k << ", parameter " << j;
      }
    }
  }
}

/// Of frequencies and damping ratios by all of `free`.
void expect_derivatives(const model::MachineFile& file, const std::vector<std::string>& free) {
  for (const auto kind : {ModelKind::rigid, ModelKind::guide}) {
    observation::Targets targets;
    targets.modes = test::modes_of(file, "shifted", kind);
    if (kind == ModelKind::guide) targets.modes.resize(2);  // above, seals have close ones
    for (auto& mode : targets.modes) {
      mode.damping = 0.021;
      mode.damping_deviation = 0.0017;
    }
    std::vector<calibration::Variable> variables;
    for (const auto& path : free) {
      const auto number = find_number(file, path).value();
      variables.push_back({.paths = {path},
                           .ids = {number.id},
                           .start = number.value,
                           .lower = 0.1 * number.value,
                           .upper = 10.0 * number.value,
                           .scale = number.value});
    }
    const calibration::Problem problem(file.machine, targets, variables, kind,
                                       {.hold_to_physics = false});
    const auto at = [&](const Eigen::VectorXd& x, Eigen::MatrixXd* J) {
      calibration::State state;
      EXPECT_TRUE(problem.evaluate(x, J != nullptr, state));
      Eigen::VectorXd r;
      problem.residuals(x, state, r, J);
      return r;
    };
    const Eigen::VectorXd x = problem.start();
    Eigen::MatrixXd J;
    ASSERT_EQ(at(x, &J).size(), 2 * std::ssize(targets.modes));
    for (int j = 0; j < problem.size(); ++j) {
      const Eigen::VectorXd expected = high_order_difference(
          [&](double h) -> Eigen::VectorXd {
            return at(x + h * Eigen::VectorXd::Unit(problem.size(), j), nullptr);
          },
          3e-3);  // poles are known to 1e-13, residuals are changes over 2e-3 of a frequency
      for (Eigen::Index row = 0; row < expected.size(); ++row)
        EXPECT_NEAR(J(row, j), expected[row], 1e-6 * J.col(j).norm())
            << free[static_cast<std::size_t>(j)] << ", row " << row;
    }
  }
}

/// With dampers in sleeves and oil and a ratio for all modes.
TEST(Derivatives, OfDampingResidualsAgreeWithHighOrderDifferences) {
  test::Random random(83);
  expect_derivatives(
      test::machine_file(test::random_machine_text(random, true), {"damping.modal_ratio=0.0137"}),
      {"platform.mass", "leg.3.oil_spring.stiffness", "legs.guide_sleeve.stiffness",
       "leg.2.oil_spring.damping", "legs.guide_sleeve.damping", "damping.modal_ratio"});
}

/// Seals of the cylinders that stick, of all legs and of one.
TEST(Derivatives, OfSealsThatStickAgreeWithHighOrderDifferences) {
  for (const char* oil : {"viscous", "chambers"}) {
    test::Random random(89);  // whose pistons stand within their strokes
    expect_derivatives(
        test::machine_file(test::random_machine_text(random, true),
                           {fmt::format("damping.oil={}", oil), "damping.modal_ratio=0.0137",
                            "legs.stick_stiffness=1.3e6", "leg.2.stick_stiffness=3.7e6"}),
        {"platform.mass", "legs.stick_stiffness", "leg.2.stick_stiffness"});
  }
}

/// With chambers: leakage has no effect on undamped frequencies, and all of it on damping ratios.
TEST(Derivatives, OfDampingResidualsWithChambersAgreeWithHighOrderDifferences) {
  test::Random random(89);
  expect_derivatives(
      test::machine_file(test::random_machine_text(random, true),
                         {"damping.oil=chambers", "damping.modal_ratio=0.0137",
                          "legs.leakage.internal=2.9e-12", "leg.2.leakage.internal=7.1e-12"}),
      {"platform.mass", "leg.3.oil_spring.stiffness", "legs.guide_sleeve.stiffness",
       "leg.2.leakage.internal", "legs.leakage.internal", "damping.modal_ratio"});
}

/// Poles of modes whose seals are elastomers, and of which the undamped ones are up to a quarter
/// off.
TEST(Derivatives, OfDampedModesOfElastomersAgreeWithHighOrderDifferences) {
  test::Random random(91);
  expect_derivatives(test::machine_file(test::random_machine_text(random, true),
                                        {"legs.guide_sleeve.elastomer={ dynamic_ratio = 2.17, "
                                         "loss_factor = 0.37, frequency = 4.3 }"}),
                     {"platform.mass", "leg.3.oil_spring.stiffness", "legs.guide_sleeve.stiffness",
                      "legs.guide_sleeve.elastomer.dynamic_ratio",
                      "leg.2.guide_sleeve.elastomer.loss_factor", "leg.2.oil_spring.damping"});
}

/// With a ratio for all undamped modes besides.
TEST(Derivatives, OfDampedModesOfElastomersWithARatioForAllModesAgreeWithDifferences) {
  test::Random random(97);
  expect_derivatives(test::machine_file(test::random_machine_text(random, true),
                                        {"damping.modal_ratio=0.0137",
                                         "legs.guide_sleeve.elastomer={ dynamic_ratio = 1.83, "
                                         "loss_factor = 0.29, frequency = 5.1 }"}),
                     {"platform.mass", "leg.3.oil_spring.stiffness", "legs.guide_sleeve.stiffness",
                      "leg.2.guide_sleeve.elastomer.loss_factor", "damping.modal_ratio"});
}

/// Six equal legs with elastomers: x and y are one pole, twice, which a change of one leg parts.
TEST(Derivatives, OfARepeatedPoleOfElastomersArePartedByTheParameterThatSplitsIt) {
  const auto file = test::machine_file(
      test::read_text(test::source_file("models/zhang-jiang-2021-transverse.toml")),
      {"legs.guide_sleeve.elastomer={ dynamic_ratio = 1.91, loss_factor = 0.23, frequency = 5.3 "
       "}"});
  const auto pose = file.machine.poses[0].name;
  observation::Targets targets;
  targets.modes = test::modes_of(file, pose, ModelKind::guide);
  targets.modes.resize(2);
  const auto number = find_number(file, "leg.2.oil_spring.stiffness").value();
  const calibration::Problem problem(file.machine, targets,
                                     {{.paths = {"leg.2.oil_spring.stiffness"},
                                       .ids = {number.id},
                                       .start = number.value,
                                       .lower = 0.1 * number.value,
                                       .upper = 10.0 * number.value,
                                       .scale = number.value}},
                                     ModelKind::guide, {.hold_to_physics = false});
  const Eigen::VectorXd x = problem.start();
  calibration::State state;
  ASSERT_TRUE(problem.evaluate(x, true, state));
  Eigen::VectorXd r;
  Eigen::MatrixXd J;
  problem.residuals(x, state, r, &J);
  const auto omega = [&](double h) {
    const auto machine = test::varied(file, {"leg.2.oil_spring.stiffness"});
    const auto point =
        calibration::mode_point(machine.at({number.value * (1.0 + h)}), 0, ModelKind::guide);
    const double a = point.omega(0), b = point.omega(1);
    return Eigen::Vector2d(std::min(a, b), std::max(a, b));
  };
  const double h = 1e-4;
  const Eigen::Vector2d above = omega(h) - omega(0.0), below = omega(0.0) - omega(-h);
  const double first = J(0, 0) * targets.modes[0].deviation,
               second = J(1, 0) * targets.modes[1].deviation;
  const double low = std::min(first, second), high = std::max(first, second);
  ASSERT_GT(high, 1.5 * low);
  // the lower derivative belongs to the lower mode above, to the higher one below
  EXPECT_NEAR(above[0], low * h, 1e-3 * high * h);
  EXPECT_NEAR(above[1], high * h, 1e-3 * high * h);
  EXPECT_NEAR(below[0], high * h, 1e-3 * high * h);
  EXPECT_NEAR(below[1], low * h, 1e-3 * high * h);
}

/// Six equal legs: x and y are one frequency, twice. A change of one leg parts them by the
/// eigenvalues of G, to both sides.
TEST(Derivatives, OfARepeatedPairArePartedByTheParameterThatSplitsIt) {
  const auto file =
      model::read_machine_file(test::source_file("models/zhang-jiang-2021-transverse.toml"));
  const auto machine = test::varied(file, {"leg.2.oil_spring.stiffness"});
  const auto values = machine.values();
  auto point = calibration::mode_point(machine.at(values), 0, ModelKind::guide);
  calibration::add_derivatives(machine, values, 0, values, point);
  ASSERT_EQ(point.modes.group[0], point.modes.group[1]);
  const double h = 1e-4 * values[0];
  const auto after = calibration::mode_point(machine.at({values[0] + h}), 0, ModelKind::guide);
  const auto before = calibration::mode_point(machine.at({values[0] - h}), 0, ModelKind::guide);
  for (int k = 0; k < 2; ++k) {
    const double change = point.domega2(k, 0) * h;
    // the lower derivative belongs to the lower mode above, to the higher one below; only the
    // first order is claimed, so twice the step is off by four times as much
    EXPECT_NEAR(after.modes.omega2[k] - point.modes.omega2[k], change,
                1e-3 * std::abs(point.domega2(1, 0) * h));
    EXPECT_NEAR(before.modes.omega2[1 - k] - point.modes.omega2[k], -change,
                1e-3 * std::abs(point.domega2(1, 0) * h));
  }
  EXPECT_GT(point.domega2(1, 0), 1.5 * point.domega2(0, 0));
}

/// Six legs with equal springs have many undamped modes of one frequency, in which all legs move.
/// Dampers that differ make damped modes of single legs of them, each like several undamped ones.
TEST(DampedModes, BelongToOneUndampedModeEach) {
  auto machine = test::symmetric_machine(9.81);
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    auto& sleeve = machine.legs[i].guide_sleeve;
    sleeve.elastomer = {.dynamic_ratio = 2.1, .loss_factor = 0.31, .frequency = 5.7};
    sleeve.damping = 31.0 * static_cast<double>(i * i);
  }
  const auto point = calibration::mode_point(machine, 0, ModelKind::guide);
  auto damped = modal::damped_modes(point.model, point.modes, 0.0);
  ASSERT_EQ(point.damped.size(), damped.size());
  std::vector<double> found;
  for (const auto& mode : point.damped) found.push_back(mode->omega);
  std::ranges::sort(found);
  for (std::size_t k = 0; k < damped.size(); ++k) EXPECT_EQ(found[k], damped[k].omega) << k;
}

/// Against differences of what `modes` lists: dampers and elastomers move |λ|.
TEST(Sensitivities, AreThoseOfTheDampedFrequencies) {
  const std::string path = "legs.guide_sleeve.stiffness";
  for (const std::string seal : {"", "{ dynamic_ratio = 1.6, loss_factor = 0.2, frequency = 8 }"}) {
    std::vector<std::string> overrides;
    if (!seal.empty()) overrides.push_back("legs.guide_sleeve.elastomer=" + seal);
    const auto file = test::machine_file(
        test::read_text(test::source_file("models/heavy-platform.toml")), overrides);
    const auto listed = [&](double factor) {
      auto machine = file.machine;
      for (auto& leg : machine.legs) leg.guide_sleeve.stiffness *= factor;
      const auto model =
          dynamics::linear_model(machine, machine.neutral(), dynamics::ModelKind::guide);
      const auto modes = modal::normal_modes(model);
      Eigen::VectorXd omega(modes.size());
      Eigen::Index k = 0;
      for (const auto& mode : modal::damped_modes(model, modes, modal::modal_ratio(machine).value))
        omega[k++] = mode.omega;
      return omega;
    };
    const auto s = calibration::sensitivities(file, 0, ModelKind::guide, {path});
    const Eigen::VectorXd omega = listed(1.0);
    constexpr double h = 1e-4;
    const Eigen::VectorXd expected =
        ((listed(1.0 + h) - listed(1.0 - h)).array() / (2.0 * h * omega.array())).matrix();
    for (int k = 0; k < 6; ++k) {
      EXPECT_NEAR(s.omega[k], omega[k], 1e-10 * omega[k]) << seal << k;
      EXPECT_NEAR(s.percent_per_percent(k, 0), expected[k], 1e-5) << seal << k;
    }
  }
}

/// ω scales with the root of all springs, and with 1/√ of all that has mass.
TEST(Sensitivities, OfAllSpringsSumToAHalfAndOfAllInertiasToMinusAHalf) {
  test::Random random(5);
  const auto file = test::machine_file(
      test::random_machine_text(random, false),
      {"legs.oil_spring.damping=0", "legs.guide_sleeve.damping=0", "damping.modal_ratio=0"});
  const auto s = calibration::sensitivities(file, 1, ModelKind::guide);
  const Eigen::Index modes = s.omega.size();
  Eigen::VectorXd springs = Eigen::VectorXd::Zero(modes), inertias = springs;
  for (std::size_t j = 0; j < s.parameters.size(); ++j) {
    const auto& unit = s.parameters[j].unit;
    const auto column = s.percent_per_percent.col(static_cast<Eigen::Index>(j));
    if (unit == "N/m") springs += column;
    if (unit == "kg" || unit == "kg m^2") inertias += column;
  }
  for (Eigen::Index k = 0; k < modes; ++k) {
    EXPECT_NEAR(springs[k], 0.5, 1e-9) << k;
    EXPECT_NEAR(inertias[k], -0.5, 1e-9) << k;
  }
}

}  // namespace
}  // namespace hydrapod
