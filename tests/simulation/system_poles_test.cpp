/// Poles and participation of systems whose answer is known.

#include "hydrapod/simulation/linear_system.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <numeric>

#include "support/loop_machine.hpp"

namespace hydrapod::simulation {
namespace {

/// Damped oscillators s² + 2ζω s + ω² side by side, each of two states and a part of its own.
LinearSystem oscillators(const std::vector<std::pair<double, double>>& omega_zeta) {
  LinearSystem system;
  const auto n = static_cast<Eigen::Index>(2 * omega_zeta.size());
  system.A = Eigen::MatrixXd::Zero(n, n);
  system.scales = Eigen::VectorXd::Ones(n);
  for (size_t k = 0; k < omega_zeta.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(2 * k);
    const auto [omega, zeta] = omega_zeta[k];
    system.A(i, i + 1) = 1.0;
    system.A(i + 1, i) = -omega * omega;
    system.A(i + 1, i + 1) = -2.0 * zeta * omega;
    for (int twice = 0; twice < 2; ++twice) system.parts.push_back({static_cast<Part>(k), -1});
  }
  return system;
}

TEST(SystemPoles, OfOscillatorsSideBySide) {
  const auto found = system_poles(oscillators({{11.3, 0.021}, {4.7, 0.3}, {29.0, -0.01}}));
  ASSERT_EQ(found.poles.size(), 3U);
  EXPECT_FALSE(found.stable);
  EXPECT_NEAR(found.largest_real, 0.29, 1e-12);
  EXPECT_NEAR(found.poles[0].omega, 29.0, 1e-12);
  EXPECT_NEAR(found.poles[1].omega, 11.3, 1e-12);
  EXPECT_NEAR(found.poles[1].damping_ratio, 0.021, 1e-13);
  EXPECT_NEAR(found.poles[2].damping_ratio, 0.3, 1e-13);
  for (const auto& [pole, part] : {std::pair{0, Part::z}, {1, Part::x}, {2, Part::y}})
    EXPECT_NEAR(found.poles[static_cast<size_t>(pole)].parts[static_cast<size_t>(part)], 1.0,
                1e-12);
}

/// A seal without a damper: the sign of what rounding leaves of its real part says nothing.
TEST(SystemPoles, AnUndampedOscillationDoesNotGrow) {
  for (const double rounding : {1e-13, -1e-13}) {
    const auto found = system_poles(oscillators({{1596.0, rounding}, {4.7, 0.3}}));
    EXPECT_TRUE(found.stable);
    EXPECT_TRUE(found.sampled_stable);
  }
  EXPECT_FALSE(system_poles(oscillators({{1596.0, -1e-7}})).stable);
}

TEST(SystemPoles, RealOnesAreOneEach) {
  const auto found = system_poles(oscillators({{3.0, 1.25}}));  // −1.5 and −6
  ASSERT_EQ(found.poles.size(), 2U);
  EXPECT_NEAR(found.poles[0].pole.real(), -1.5, 1e-12);
  EXPECT_NEAR(found.poles[1].pole.real(), -6.0, 1e-12);
  EXPECT_EQ(found.poles[0].damping_ratio, 1.0);
  EXPECT_FALSE(found.poles[0].oscillates());
}

/// Units do not matter to poles or participation.
TEST(SystemPoles, DoNotDependOnUnits) {
  auto system = oscillators({{11.3, 0.021}, {12.1, 0.3}});
  system.A(1, 2) = 17.0;  // coupled
  system.A(3, 0) = -23.0;
  const auto plain = system_poles(system);
  const Eigen::Vector4d units(1e-6, 3.0, 1e7, 20.0);
  auto other = system;
  other.A = units.asDiagonal() * system.A * units.cwiseInverse().asDiagonal();
  other.scales = units;
  const auto changed = system_poles(other);
  for (size_t k = 0; k < plain.poles.size(); ++k) {
    EXPECT_NEAR(std::abs(plain.poles[k].pole - changed.poles[k].pole), 0.0, 1e-11);
    for (size_t i = 0; i < part_count; ++i)
      EXPECT_NEAR(plain.poles[k].parts[i], changed.poles[k].parts[i], 1e-11);
  }
  EXPECT_GT(plain.poles[0].parts[1], 0.01);  // coupled indeed
}

/// Two equal oscillators, looked at in coordinates turned by 30°: any mix of their modes is one,
/// and each coordinate takes the same part in both.
TEST(SystemPoles, EqualOnesShareTheirParticipation) {
  auto system = oscillators({{7.0, 0.1}, {7.0, 0.1}});
  const double c = std::cos(0.52), s = std::sin(0.52);
  Eigen::Matrix4d T = Eigen::Matrix4d::Zero();
  for (int i = 0; i < 2; ++i) {
    T(i, i) = T(i + 2, i + 2) = c;
    T(i, i + 2) = -s;
    T(i + 2, i) = s;
  }
  system.A = (T * system.A * T.transpose()).eval();
  const auto found = system_poles(system);
  ASSERT_EQ(found.poles.size(), 2U);
  EXPECT_EQ(found.poles[0].group, found.poles[1].group);
  for (const auto& pole : found.poles) {
    EXPECT_NEAR(pole.parts[0], 0.5, 1e-6);
    EXPECT_NEAR(pole.parts[1], 0.5, 1e-6);
  }
}

/// An integral that is switched off moves nothing: it is no pole at zero.
TEST(SystemPoles, OfALoopWithoutIntegralAreStable) {
  for (const char* compensation : {"load", "none"}) {
    const auto machine = machine_of(
        "heavy-platform", {"controller.integral_time=0",
                           std::string("controller.compensation=\"") + compensation + "\""});
    const auto poles = system_poles(linear_system(machine, machine.neutral()));
    EXPECT_TRUE(poles.stable);
    EXPECT_TRUE(poles.sampled_stable);
    EXPECT_LT(poles.largest_real, -1e-3);
  }
}

TEST(SystemPoles, OfAMachineHaveSharesThatSumToOne) {
  const auto machine = machine_of("heavy-platform");
  for (const auto kind : {dynamics::ModelKind::rigid, dynamics::ModelKind::guide}) {
    const auto system = linear_system(machine, machine.neutral(), {.kind = kind});
    ASSERT_EQ(system.states.size(), static_cast<size_t>(system.A.rows()));
    ASSERT_EQ(system.parts.size(), static_cast<size_t>(system.A.rows()));
    const auto found = system_poles(system);
    EXPECT_TRUE(found.stable);
    EXPECT_TRUE(found.sampled_stable);
    Eigen::Index count = 0;
    for (const auto& pole : found.poles) {
      EXPECT_NEAR(std::accumulate(pole.parts.begin(), pole.parts.end(), 0.0), 1.0, 1e-9);
      count += pole.oscillates() ? 2 : 1;
    }
    EXPECT_EQ(count, system.A.rows());
  }
}

}  // namespace
}  // namespace hydrapod::simulation
