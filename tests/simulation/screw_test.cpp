/// Electric cylinders against closed forms: held and free motors, what torque and speed allow.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/simulation/capability.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "hydrapod/simulation/plant.hpp"
#include "support/other_legs.hpp"
#include "support/symmetric_screws.hpp"

namespace hydrapod::simulation {
namespace {

using dynamics::ModelKind;

using test::rise;
using test::symmetric_screws;
using S = test::SymmetricScrews;

constexpr double lead = S::lead, inertia = S::inertia, k_a = S::k_a, torque = S::torque,
                 friction = S::friction;

double reflected() { return S::reflected; }

/// The eigenvalue nearest to i omega.
double distance_to(const Eigen::MatrixXd& A, double omega) {
  const Eigen::VectorXcd poles = Eigen::EigenSolver<Eigen::MatrixXd>(A, false).eigenvalues();
  return (poles.array() - std::complex<double>(0.0, omega)).abs().minCoeff();
}

/// Two masses on a spring: the platform in heave, and six rotors.
TEST(Screws, VibrateAgainstTheirFreeMotors) {
  const auto machine = symmetric_screws(0.0);
  const double n_z = rise(machine), m = machine.platform.mass;
  const double omega = std::sqrt(k_a * (6.0 * n_z * n_z / m + 1.0 / reflected()));
  const auto system = screw_system(machine, machine.neutral(), ModelKind::rigid);
  ASSERT_EQ(system.A.rows(), 24);
  EXPECT_LT(distance_to(system.A, omega), 1e-8 * omega);
  // Motors that are held leave the platform on its springs.
  const auto held = dynamics::linear_model(machine, machine.neutral(), ModelKind::rigid);
  const Eigen::MatrixXd K = held.K;
  EXPECT_NEAR(K(2, 2), 6.0 * k_a * n_z * n_z, 1e-9 * K(2, 2));
  const auto poles = system_poles(system);
  double found = 0.0;
  for (const auto& pole : poles.poles) {
    for (const double part : pole.parts) EXPECT_TRUE(std::isfinite(part));
    if (std::abs(pole.omega - omega) < 1e-6 * omega) found = pole.parts[2];
  }
  // Shares of a mode of two masses are as those of the kinetic energy: 1/m' of each.
  const double by_platform = 6.0 * n_z * n_z / m, by_motors = 1.0 / reflected();
  EXPECT_NEAR(found, by_platform / (by_platform + by_motors), 1e-5);
}

/// A torque on all motors at once accelerates platform and rotors together: with the spring still
/// unstretched only the rotors.
TEST(Screws, AreMovedByTheTorqueOfTheirMotors) {
  const auto machine = symmetric_screws(0.0);
  const auto system = screw_system(machine, machine.neutral(), ModelKind::rigid);
  const Eigen::VectorXd rates = system.B_valve * Eigen::VectorXd::Constant(6, 1.7);
  const double ratio = 2.0 * std::numbers::pi / lead;
  EXPECT_LT(rates.head(18).norm(), 1e-12);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(rates[18 + i], 1.7 / (inertia * ratio), 1e-9);
}

/// Dampers alone damp: b (2π/p)² on the rotor and c_a along the screw.
TEST(Screws, AreDampedByScrewAndMotor) {
  const auto machine = test::damped_screws();
  constexpr double c_a = test::SymmetricScrews::c_a, b = test::SymmetricScrews::b;
  const double n_z = rise(machine), m = machine.platform.mass, m_r = reflected();
  const double b_r = b * m_r / inertia, q = 6.0 * n_z;
  Eigen::Matrix4d A;  // z, s_n, rates: m z̈ = q F, m_r s̈_n = −F − b_r ṡ_n, F = k e + c ė
  A << 0, 0, 1, 0, 0, 0, 0, 1, -q * n_z * k_a / m, q * k_a / m, -q * n_z * c_a / m, q * c_a / m,
      n_z * k_a / m_r, -k_a / m_r, n_z * c_a / m_r, -(c_a + b_r) / m_r;
  const auto system = screw_system(machine, machine.neutral(), ModelKind::rigid);
  const Eigen::VectorXcd poles = Eigen::EigenSolver<Eigen::MatrixXd>(system.A, false).eigenvalues();
  const Eigen::VectorXcd wanted = Eigen::EigenSolver<Eigen::Matrix4d>(A, false).eigenvalues();
  for (int k = 0; k < 4; ++k)
    // two of them are zero: the free cylinder has no spring, and its motion no end
    EXPECT_LT((poles.array() - wanted[k]).abs().minCoeff(),
              1e-9 * std::abs(wanted[k]) + 1e-6 * b_r / m_r)
        << wanted[k];
}

/// From rest under the weight, up and down: (F_max ∓ f) 6 n_z over platform and rotors.
TEST(Screws, AccelerateWhatTheirTorqueAllows) {
  constexpr double g = 9.81;
  const auto machine = symmetric_screws(g);
  const double n_z = rise(machine), m = machine.platform.mass;
  const double most = 2.0 * std::numbers::pi / lead * (torque - friction);
  const double load = m * g / (6.0 * n_z);
  const auto able = capability(machine, machine.neutral(), ModelKind::rigid);
  ASSERT_TRUE(able);
  const double mass = m + 6.0 * n_z * n_z * reflected();
  EXPECT_NEAR(able->of(Ability::acceleration, 2, 0).value, 6.0 * n_z * (most - load) / mass, 1e-9);
  EXPECT_NEAR(able->of(Ability::acceleration, 2, 1).value, 6.0 * n_z * (most + load) / mass, 1e-9);
  EXPECT_EQ(able->of(Ability::acceleration, 2, 0).limit, Limit::torque);
  EXPECT_NEAR(able->of(Ability::velocity, 2, 0).value,
              303.7 * lead / (2.0 * std::numbers::pi) / n_z, 1e-12);
  EXPECT_EQ(able->of(Ability::velocity, 2, 0).limit, Limit::motor_speed);
  EXPECT_NEAR(able->of(Ability::force, 2, 1).value, 6.0 * n_z * (most + load), 1e-6);
}

/// A slender rod buckles under what accelerates the platform; its rotor's own inertia is not in it.
TEST(Screws, AccelerateWhatTheirRodsBear) {
  auto machine = symmetric_screws(0.0);
  for (auto& leg : machine.legs) {
    leg.rod.diameter = 0.0113;
    leg.screw->torque_limit = 91.0;
  }
  const auto able = capability(machine, machine.neutral(), ModelKind::rigid);
  ASSERT_TRUE(able && able->legs[0].column);
  const double n_z = rise(machine), m = machine.platform.mass;
  const double rods = able->legs[0].column->strength, motors = able->legs[0].push;
  ASSERT_LT(rods * (1.0 + 6.0 * n_z * n_z * reflected() / m), motors);
  const auto& up = able->of(Ability::acceleration, 2, 0);
  EXPECT_NEAR(up.value, 6.0 * n_z * rods / m, 1e-9 * up.value);
  EXPECT_EQ(up.limit, Limit::column);
  EXPECT_EQ(able->of(Ability::acceleration, 2, 1).limit, Limit::torque);
  EXPECT_NEAR(able->of(Ability::force, 2, 0).value, 6.0 * n_z * rods, 1e-9 * 6.0 * n_z * rods);
}

/// Viscous friction takes up what the load leaves.
TEST(Screws, AreSlowerThanTheirLimitUnderFriction) {
  auto machine = symmetric_screws(9.81);
  const double n_z = rise(machine), load = machine.platform.mass * 9.81 / (6.0 * n_z);
  constexpr double b = 0.3;
  for (auto& leg : machine.legs) leg.screw->viscous_friction = b;
  const auto able = capability(machine, machine.neutral(), ModelKind::rigid);
  ASSERT_TRUE(able);
  const double per = lead / (2.0 * std::numbers::pi);
  EXPECT_NEAR(able->of(Ability::velocity, 2, 0).value,
              (torque - friction - load * per) / b * per / n_z, 1e-9);
  EXPECT_EQ(able->of(Ability::velocity, 2, 0).limit, Limit::torque);
}

/// The guide bush yields as in a hydraulic cylinder: only the axial spring is another one.
TEST(Screws, AreHeldAsCylindersWithTheSameAxialSpring) {
  const auto screws = test::machine_of(test::screw_file);
  auto oil = screws;
  for (auto& leg : oil.legs) {
    leg.oil_spring = {.stiffness = leg.screw->stiffness, .damping = leg.screw->damping};
    leg.screw.reset();
  }
  const auto a = dynamics::linear_model(screws, screws.neutral(), ModelKind::guide);
  const auto b = dynamics::linear_model(oil, oil.neutral(), ModelKind::guide);
  EXPECT_EQ(a.M, b.M);
  EXPECT_EQ(a.K, b.K);
  EXPECT_EQ(a.C, b.C);
  // The plant of the mechanics too.
  const Plant plant(screws, ModelKind::guide, {.hydraulics = false});
  const Plant other(oil, ModelKind::guide, {.hydraulics = false});
  const auto x = plant.equilibrium(screws.neutral()).x;
  EXPECT_EQ(x, other.equilibrium(oil.neutral()).x);
  const Eigen::MatrixXd A = plant.linearise(x, {}).A, B = other.linearise(x, {}).A;
  EXPECT_EQ(A, B);
}

/// On a mount, with a payload that sways, compliant gimbals, seals that are elastomers, dampers of
/// every kind and gravity: heavy rotors stand still.
TEST(Screws, WithEverythingAroundThemAreAsHeldWhenTheirRotorsAreHeavy) {
  auto machine = test::machine_of(test::screw_file);
  machine.damping.rayleigh_mass = 0.37;
  machine.damping.rayleigh_stiffness = 1.3e-5;
  machine.damping.modal_ratio = 0.0;
  machine.payload_modes.push_back(
      {.name = "mast", .frequency = 9.7, .mass = 131.0, .position = {0.2, -0.1, 0.9}});
  model::BaseMount mount{.mass = 713.0, .inertia = {91.0, 113.0, 171.0}};
  mount.stiffness = {6.1e7, {}, 8.3e7, 4.7e7, {}, {}};
  machine.base_mount = mount;
  for (auto& leg : machine.legs) {
    leg.gimbal_stiffness = 1.9e8;
    leg.guide_sleeve.elastomer = {
        .arms = model::MaxwellArms{.strength = {0.21, 0.13, 0.37}, .time = {0.31, 0.023, 0.0019}}};
    leg.screw->inertia = 1e7;
  }
  const auto held = dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
  const auto free = screw_system(machine, machine.neutral(), ModelKind::guide);
  ASSERT_EQ(std::ssize(free.states), free.A.rows());
  ASSERT_EQ(std::ssize(free.parts), free.A.rows());
  const Eigen::VectorXcd poles = Eigen::EigenSolver<Eigen::MatrixXd>(free.A, false).eigenvalues();
  int compared = 0;
  for (const auto& mode : modal::damped_modes(held, modal::normal_modes(held), 0.0)) {
    if (!(mode.pole.imag() > 0.0)) continue;
    EXPECT_LT((poles.array() - mode.pole).abs().minCoeff(), 1e-6 * std::abs(mode.pole))
        << mode.pole;
    ++compared;
  }
  EXPECT_GE(compared, 12);
}

/// Legs whose rotors hardly move.
TEST(Screws, AreAsHeldWhenTheirRotorsAreHeavy) {
  auto machine = test::machine_of(test::screw_file);
  for (auto& leg : machine.legs) {
    leg.screw->inertia = 1e6;
    leg.screw->damping = leg.screw->viscous_friction = 0.0;
  }
  const auto held = dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
  const Eigen::MatrixXd M = held.M, K = held.K;
  const Eigen::VectorXd omega2 =
      Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(K, M).eigenvalues();
  const auto free = screw_system(machine, machine.neutral(), ModelKind::guide);
  for (const double square : omega2) {
    const double omega = std::sqrt(square);
    EXPECT_LT(distance_to(free.A, omega), 1e-5 * omega);
  }
}

}  // namespace
}  // namespace hydrapod::simulation
