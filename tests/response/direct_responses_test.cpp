/// The sum over damped modes is what the other ways give, whatever the modes are like.

#include "response/direct_responses.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/modal/damped_modes.hpp"
#include "support/kinds.hpp"
#include "support/random_machine.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {
namespace {

using response::DampedShapes;

/// A model with its damped modes, as the page's core hands them over.
struct Damped {
  response::ResponseModel model{};
  DampedShapes shapes{};

  Damped(const model::Machine& machine, dynamics::ModelKind kind, double ratio) {
    const auto linear = dynamics::linear_model(machine, machine.poses.back().X_BP, kind);
    const auto modes = modal::normal_modes(linear);
    model = response::response_model(linear, modes, ratio, machine.platform.mass_center);
    const auto list = modal::damped_modes(linear, modes, ratio);
    const auto n = static_cast<Eigen::Index>(list.size());
    shapes.real.resize(n, n);
    shapes.imaginary.resize(n, n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const auto& mode = list[static_cast<std::size_t>(k)];
      shapes.poles.push_back(mode.pole);
      shapes.real.col(k) = mode.real;
      shapes.imaginary.col(k) = mode.imaginary;
    }
  }

  [[nodiscard]] std::vector<double> band(int points) const {
    return response::log_space(0.2 * model.modes.omega(0),
                               3.0 * model.modes.omega(model.modes.size() - 1), points);
  }
};

/// Largest difference of H_dd against |H_dd|.
double apart(const std::vector<response::DirectLine>& H,
             const std::vector<response::Matrix6c>& expected) {
  double worst = 0.0;
  for (std::size_t i = 0; i < H.size(); ++i)
    for (int d = 0; d < 6; ++d) {
      const auto is = H[i][static_cast<std::size_t>(d)], ought = expected[i](d, d);
      const double now = std::abs(is - ought) / std::abs(ought);
      worst = now <= worst ? worst : now;  // keeps NaN
    }
  return worst;
}

model::Machine with_dampers(model::Machine machine, double sleeve, double oil, double ring = 0.0) {
  for (auto& leg : machine.legs) {
    leg.guide_sleeve.damping = sleeve;
    leg.oil_spring.damping = oil;
    if (leg.piston_ring) leg.piston_ring->damping = ring;
  }
  return machine;
}

class RandomMachines : public testing::TestWithParam<AxesAndKind> {};

/// Whether it is the sum or not: legs, masses and dampers of all sizes.
TEST_P(RandomMachines, HaveTheDiagonalAsDirectResponses) {
  Random random(911);
  const auto [axes, kind] = GetParam();
  constexpr double rounding = 3e-12;  // condition of D near lightly damped resonances
  double worst = 0.0;
  int sums = 0;
  constexpr int machines = 24;
  for (int i = 0; i < machines; ++i) {
    SCOPED_TRACE(fmt::format("machine {}", i));
    const auto gravity = i % 2 == 0 ? Gravity::none : Gravity::down;
    const auto machine = random_machine(random, {.axes = axes, .gravity = gravity});
    const Damped damped(machine, kind, i % 4 < 2 ? 0.0 : 0.01);
    const auto omega = damped.band(501);
    const auto found = response::direct_responses(damped.model, damped.shapes, omega);
    const double error = apart(found.H, response::frequency_response(damped.model, omega));
    EXPECT_LE(error, rounding);
    worst = std::max(worst, error);
    sums += found.is_sum ? 1 : 0;
  }
  RecordProperty("worst", fmt::format("{:.1e}", worst));
  RecordProperty("sums", sums);
}

INSTANTIATE_TEST_SUITE_P(, RandomMachines,
                         testing::Combine(both_axes(), testing::Values(dynamics::ModelKind::rigid,
                                                                       dynamics::ModelKind::guide,
                                                                       dynamics::ModelKind::full)),
                         [](const auto& test) { return name(test); });

/// Six equal legs: pairs of modes, and seal modes that repeat six times.
TEST(DirectResponses, OfRepeatedModesAreSums) {
  constexpr double rounding = 1e-12;
  for (const double gravity : {0.0, 9.81})
    for (const double ratio : {0.0, 0.003})
      for (const double ring : {0.0, 25.0}) {
        SCOPED_TRACE(fmt::format("gravity {}, ratio {}, rings {}", gravity, ratio, ring));
        const auto machine = with_dampers(symmetric_machine(gravity), 60.0, 4000.0, ring);
        const Damped damped(machine, dynamics::ModelKind::full, ratio);
        const auto omega = damped.band(2000);
        const auto found = response::direct_responses(damped.model, damped.shapes, omega);
        EXPECT_TRUE(found.is_sum || gravity > 0.0);  // near buckling digits are lost
        const double error = apart(found.H, response::frequency_response(damped.model, omega));
        EXPECT_LE(error, rounding);
        RecordProperty(fmt::format("g{}_z{}_r{}", gravity, ratio, ring),
                       fmt::format("{:.1e}", error));
      }
}

/// Without dampers each mode is its own term.
TEST(DirectResponses, OfUndampedModesAreTheModalSum) {
  constexpr double rounding = 1e-13;
  const Damped damped(symmetric_machine(9.81), dynamics::ModelKind::full, 0.01);
  const auto omega = damped.band(501);
  const auto found = response::direct_responses(damped.model, {}, omega);
  EXPECT_TRUE(found.is_sum);
  EXPECT_LE(apart(found.H, response::frequency_response(damped.model, omega)), rounding);
}

/// Modes of few digits are corrected, or found out.
TEST(DirectResponses, OfRoughModesAreExact) {
  constexpr double rounding = 1e-12;
  Random random(5);
  for (const double share : {1e-12, 1e-9, 1e-6, 1e-3}) {
    SCOPED_TRACE(share);
    Damped damped(with_dampers(symmetric_machine(), 60.0, 4000.0), dynamics::ModelKind::full,
                  0.003);
    for (auto& pole : damped.shapes.poles) pole *= 1.0 + share * random.uniform(-1.0, 1.0);
    for (auto* part : {&damped.shapes.real, &damped.shapes.imaginary})
      for (Eigen::Index k = 0; k < part->size(); ++k)
        part->data()[k] *= 1.0 + share * random.uniform(-1.0, 1.0);
    const auto omega = response::log_space(5.0, 500.0, 1000);  // of modes that move the platform
    const auto found = response::direct_responses(damped.model, damped.shapes, omega);
    EXPECT_LE(apart(found.H, response::frequency_response(damped.model, omega)), rounding);
    EXPECT_FALSE(found.is_sum && share >= 1e-3);
  }
}

/// Seals that creep back have real poles, which the sum has no terms for.
TEST(DirectResponses, OfOverdampedModesAreThoseOfTheOtherWays) {
  const Damped damped(with_dampers(symmetric_machine(9.81), 3e4, 4000.0), dynamics::ModelKind::full,
                      0.003);
  EXPECT_TRUE(std::ranges::any_of(damped.shapes.poles,
                                  [](const auto& pole) { return pole.imag() == 0.0; }));
  const auto omega = damped.band(101);
  const auto found = response::direct_responses(damped.model, damped.shapes, omega);
  EXPECT_FALSE(found.is_sum);
  EXPECT_EQ(apart(found.H, response::frequency_response(damped.model, omega)), 0.0);
}

/// From below to beyond critical damping of the seals: two poles meet, and their shapes.
TEST(DirectResponses, AtCriticalDampingAreExact) {
  constexpr double rounding = 1e-11;
  for (const double damping : response::log_space(1e3, 3e4, 40)) {
    SCOPED_TRACE(damping);
    const Damped damped(with_dampers(symmetric_machine(9.81), damping, 4000.0),
                        dynamics::ModelKind::guide, 0.003);
    const auto omega = damped.band(301);
    const auto found = response::direct_responses(damped.model, damped.shapes, omega);
    EXPECT_LE(apart(found.H, response::frequency_response(damped.model, omega)), rounding);
  }
}

}  // namespace
}  // namespace hydrapod::test
