/// Damped modes: poles and shapes of λ² M + λ C + K, whatever the damping does to them.

#include "hydrapod/modal/damped_modes.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "exact/symmetric_hexapod.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "support/kinds.hpp"
#include "support/random_machine.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::LinearModel;
using dynamics::ModelKind;
using modal::DampedMode;
using Complex = std::complex<double>;
using ComplexVector = Eigen::VectorXcd;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

LinearModel linear(const model::Machine& machine, ModelKind kind) {
  return dynamics::linear_model(machine, machine.poses.back().X_BP, kind);
}

std::vector<DampedMode> damped(const LinearModel& model, double ratio = 0.0) {
  return modal::damped_modes(model, modal::normal_modes(model), ratio);
}

/// ‖D^{-1/2} (λ² M + λ C + K) φ‖ against the largest eigenvalue, with D the diagonal of M.
double residual(const LinearModel& model, const DampedMode& mode) {
  const ComplexVector phi = mode.real.cast<Complex>() + Complex(0, 1) * mode.imaginary;
  const Eigen::MatrixXcd pencil = mode.pole * mode.pole * model.M.cast<Complex>() +
                                  mode.pole * model.C.cast<Complex>() + model.K.cast<Complex>();
  const Eigen::VectorXd weight = model.M.diagonal().cwiseSqrt().cwiseInverse();
  return (weight.asDiagonal() * (pencil * phi)).norm();
}

/// Σ λ over all poles is −tr(M⁻¹ C), and every mode brings −2ζω, whatever kind it is.
double sum_of_poles_error(const LinearModel& model, const std::vector<DampedMode>& modes) {
  double sum = 0.0;
  for (const auto& mode : modes) sum += 2.0 * mode.damping_ratio * mode.omega;
  const double trace = Eigen::MatrixXd(model.M).llt().solve(Eigen::MatrixXd(model.C)).trace();
  return std::abs(sum / trace - 1.0);
}

class Damped : public testing::TestWithParam<AxesAndKind> {};

TEST_P(Damped, ModesSolveTheEquationOfMotion) {
  const auto [axes, kind] = GetParam();
  Random random(21);
  constexpr double rounding = 1e4 * epsilon;  // a non-symmetric eigenproblem of twice the size
  double worst = 0.0;
  for (int i = 0; i < 30; ++i) {
    SCOPED_TRACE(i);
    const auto gravity = i % 2 == 0 ? Gravity::none : Gravity::down;
    const auto model = linear(random_machine(random, {.axes = axes, .gravity = gravity}), kind);
    const auto modes = damped(model);
    ASSERT_EQ(static_cast<int>(modes.size()), model.dof());
    const double largest = std::pow(modes.back().omega, 2);
    for (const auto& mode : modes) {
      EXPECT_LE(residual(model, mode), rounding * largest);
      worst = std::max(worst, residual(model, mode) / largest);
      EXPECT_TRUE(mode.stable);
      const ComplexVector phi = mode.real.cast<Complex>() + Complex(0, 1) * mode.imaginary;
      EXPECT_NEAR(std::abs(phi.dot(model.M.cast<Complex>() * phi)), 1.0, 1e-12);
    }
    EXPECT_LE(sum_of_poles_error(model, modes), 1e-10);
    EXPECT_TRUE(std::is_sorted(modes.begin(), modes.end(),
                               [](auto& a, auto& b) { return a.omega < b.omega; }));
  }
  RecordProperty("worst", fmt::format("{:.1e}", worst));
}

/// C = α M + β K leaves the shapes real: 2 ζ ω = α + β ω².
TEST_P(Damped, RayleighDampingIsThatOfTheClosedForm) {
  const auto [axes, kind] = GetParam();
  Random random(22);
  auto machine = random_machine(random, {.axes = axes});
  for (auto& leg : machine.legs) {
    leg.guide_sleeve.damping = leg.oil_spring.damping = 0.0;
    leg.piston_ring->damping = 0.0;
  }
  machine.damping.rayleigh_mass = 0.7;
  machine.damping.rayleigh_stiffness = 3e-5;
  const auto model = linear(machine, kind);
  const auto normal = modal::normal_modes(model);
  constexpr double ratio = 0.01;
  const auto modes = modal::damped_modes(model, normal, ratio);
  for (int k = 0; k < normal.size(); ++k) {
    const double omega = normal.omega(k);
    EXPECT_EQ(modes[k].omega, omega);
    EXPECT_FALSE(modes[k].is_complex());
    EXPECT_NEAR(modes[k].damping_ratio, ratio + 0.5 * (0.7 / omega + 3e-5 * omega), 1e-12);
    EXPECT_NEAR(std::abs(modes[k].pole), omega, 1e-12 * omega);
    EXPECT_NEAR(modes[k].pole.real(), -modes[k].damping_ratio * omega, 1e-12 * omega);
  }
}

INSTANTIATE_TEST_SUITE_P(, Damped,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

/// Six knees swing alone, with m λ² + c λ + k = 0 each; c from below to far above critical.
TEST(OverdampedSleeves, AreOneModeEachAlsoWhenTheyRepeat) {
  auto machine = symmetric_machine();
  const SymmetricHexapod exact(machine);
  const double m = exact.knee_mass(), k = exact.knee_stiffness();
  const double lever = k / machine.legs[0].guide_sleeve.stiffness;  // l_mh²
  for (const double zeta : {0.1, 0.9, 1.1, 2.0, 10.0, 100.0}) {
    SCOPED_TRACE(zeta);
    for (auto& leg : machine.legs) leg.guide_sleeve.damping = 2.0 * zeta * std::sqrt(k * m) / lever;
    const auto model = linear(machine, ModelKind::guide);
    const auto modes = damped(model);
    ASSERT_EQ(modes.size(), 18U);
    const double omega = std::sqrt(k / m);
    int knees = 0;
    for (const auto& mode : modes) {
      constexpr double slow_pole = 1e-8;  // the slow one is known to ε (2ζ)² of itself
      if (std::abs(mode.omega / omega - 1.0) > slow_pole) continue;
      if (std::abs(mode.damping_ratio / zeta - 1.0) > slow_pole) continue;
      ++knees;
      EXPECT_TRUE(mode.stable);
      EXPECT_LE(mode.real.head<6>().norm(), 1e-6) << "the platform rests";
      if (zeta < 1.0) continue;
      EXPECT_EQ(mode.pole.imag(), 0.0);
      const double slow = -omega / (zeta + std::sqrt(zeta * zeta - 1.0));
      EXPECT_NEAR(mode.pole.real() / slow, 1.0, slow_pole);
    }
    EXPECT_EQ(knees, 6);
    EXPECT_LE(sum_of_poles_error(model, modes), 1e-9);
  }
}

/// The platform's own overdamped modes of a symmetric machine come in pairs x, y.
TEST(OverdampedSleeves, OfASymmetricMachineKeepTheirPairs) {
  auto machine = symmetric_machine();
  for (auto& leg : machine.legs) leg.guide_sleeve.damping = 3e4;
  const auto model = linear(machine, ModelKind::guide);
  const auto modes = damped(model);
  const double largest = modes.back().omega;
  int overdamped = 0;
  for (const auto& mode : modes) {
    overdamped += mode.damping_ratio > 1.0;
    EXPECT_LE(residual(model, mode), 1e-9 * largest * largest);
  }
  EXPECT_EQ(overdamped, 12);
  EXPECT_LE(sum_of_poles_error(model, modes), 1e-9);
}

TEST(DampedModes, SharesOfComplexShapesSumToOne) {
  Random random(24);
  for (int i = 0; i < 20; ++i) {
    const auto model = linear(random_machine(random, {.gravity = Gravity::down}), ModelKind::full);
    for (const auto& mode : damped(model)) {
      const auto shares = modal::energy_shares(model, mode.real, mode.imaginary);
      EXPECT_NEAR(shares.platform.sum() + shares.legs.sum(), 1.0, 1e-12);
      EXPECT_NEAR(shares.oil.sum() + shares.guide_sleeve.sum() + shares.piston_ring.sum(), 1.0,
                  1e-12);
    }
  }
}

/// Weightless legs stand straight, also beyond the load at which they fold.
model::Machine buckled_machine() {
  auto machine = symmetric_machine(9.81);
  for (auto& leg : machine.legs) {
    leg.cylinder_case.mass = leg.rod.mass = 0.0;  // inertia stays: the model needs a mass matrix
  }
  machine.platform.mass = 3000.0;
  return machine;
}

TEST(DampedModes, OfABuckledMachineSayTheyAreUnstable) {
  for (const double sleeve_damping : {0.0, 50.0}) {
    auto machine = buckled_machine();
    for (auto& leg : machine.legs) leg.guide_sleeve.damping = sleeve_damping;
    const auto model = linear(machine, ModelKind::guide);
    const auto normal = modal::normal_modes(model);
    ASSERT_LT(normal.omega2[0], 0.0);
    const auto modes = damped(model);
    const auto unstable = std::count_if(modes.begin(), modes.end(),
                                        [](const DampedMode& mode) { return !mode.stable; });
    EXPECT_EQ(unstable, (normal.omega2.array() < 0.0).count())
        << "as many as K has negative eigenvalues, damped or not";
    for (const auto& mode : modes) {
      if (mode.stable) continue;
      EXPECT_EQ(mode.omega, 0.0);
      EXPECT_TRUE(std::isfinite(mode.damping_ratio));
    }
    EXPECT_FALSE(modes.front().stable) << "they come first";
  }
}

TEST(ModalRatio, IsTwoPercentOnlyWhereNothingElseDamps) {
  auto machine = symmetric_machine();
  EXPECT_EQ(modal::modal_ratio(machine).value, modal::default_modal_ratio);
  EXPECT_TRUE(modal::modal_ratio(machine).is_default);

  machine.damping.modal_ratio = 0.0;
  EXPECT_EQ(modal::modal_ratio(machine).value, 0.0);
  EXPECT_FALSE(modal::modal_ratio(machine).is_default);
  machine.damping.modal_ratio = 0.05;
  EXPECT_EQ(modal::modal_ratio(machine).value, 0.05);
  machine.damping.modal_ratio.reset();

  const auto expect_none_with = [&](const auto& set) {
    auto damped_machine = machine;
    set(damped_machine);
    EXPECT_EQ(modal::modal_ratio(damped_machine).value, 0.0);
    EXPECT_FALSE(modal::modal_ratio(damped_machine).is_default);
  };
  expect_none_with([](auto& m) { m.legs[3].guide_sleeve.damping = 1.0; });
  expect_none_with([](auto& m) { m.legs[5].oil_spring.damping = 1.0; });
  expect_none_with([](auto& m) { m.legs[0].piston_ring->damping = 1.0; });
  expect_none_with([](auto& m) { m.damping.rayleigh_mass = 1.0; });
  expect_none_with([](auto& m) { m.damping.rayleigh_stiffness = 1e-5; });
}

}  // namespace
}  // namespace hydrapod::test
