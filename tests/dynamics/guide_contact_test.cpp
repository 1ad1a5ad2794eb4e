/// Rods that lie on their guide rings: the law, the leg, statics, and the nonlinear mechanics.

#include "dynamics/guide_contact.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <algorithm>

#include <cmath>
#include <limits>

#include "exact/leg_potential.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/dynamics/nonlinear.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "support/guide_gaps.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::guide_contact;
using dynamics::GuideContact;
using dynamics::LegState;
using dynamics::Matrix7;
using dynamics::ModelKind;
using dynamics::Vector7;
using spatial::Vector3;

constexpr double gap = 2.3e-4, k_c = 4.7e7, w = GuideContact::smoothing * gap;

double force(double offset) { return guide_contact(offset, gap, k_c).secant * offset; }

TEST(GuideContactLaw, IsTheSharpCornerOutsideOfItsRoundingAndExceedsItByTheBoundInside) {
  double largest = 0.0;
  for (int i = 1; i <= 4000; ++i) {
    const double offset = gap * i / 1000.0, sharp = k_c * std::max(offset - gap, 0.0);
    const double excess = force(offset) - sharp;
    constexpr double rounding = 1e-12 * k_c * gap;
    EXPECT_GE(excess, -rounding);
    if (std::abs(offset - gap) >= w) EXPECT_LE(excess, rounding) << offset;
    largest = std::max(largest, excess);
  }
  EXPECT_NEAR(largest, 3.0 / 16.0 * k_c * w, 1e-9 * k_c * w);
}

TEST(GuideContactLaw, ForceIsTheSlopeOfTheEnergyAndTheTangentThatOfTheForce) {
  // Central differences of fourth order: h = w/100, what is left is of the order 1e-8.
  constexpr double h = 0.01 * w, tolerance = 1e-6;
  const auto slope = [&](const auto& f, double at) {
    return (8.0 * (f(at + h) - f(at - h)) - (f(at + 2.0 * h) - f(at - 2.0 * h))) / (12.0 * h);
  };
  for (double t = -0.97; t < 3.0; t += 0.173) {
    const double at = gap + t * w;
    const auto energy = [](double d) { return guide_contact(d, gap, k_c).energy; };
    EXPECT_NEAR(slope(energy, at), force(at), tolerance * k_c * w) << t;
    EXPECT_NEAR(slope(force, at), guide_contact(at, gap, k_c).tangent, tolerance * k_c) << t;
    EXPECT_GE(guide_contact(at, gap, k_c).tangent, guide_contact(at, gap, k_c).secant);
  }
}

TEST(GuideContactLaw, ThereIsNoneWithoutAGapNorBelowIt) {
  EXPECT_EQ(guide_contact(model::GuideSleeve{.stiffness = 1e6}, 0.1).secant, 0.0);
  const auto below = guide_contact(gap - w, gap, k_c);
  EXPECT_EQ(below.secant, 0.0);
  EXPECT_EQ(below.tangent, 0.0);
  EXPECT_EQ(below.energy, 0.0);
}

TEST(GuideContactLeg, IsTheDerivativeOfItsPotentialEnergyAlongAndAcrossTheOffset) {
  // Differences of eighth order of an offset that is a root: four steps over the offset, to the
  // eighth power, and rounding.
  constexpr double tolerance = 1e-6;
  Random random(91);
  int pressed = 0;
  for (int i = 0; i < 6; ++i) {
    const auto machine = random_machine(random, {.axes = model::FlexibleAxes::gimbal});
    for (model::Leg leg : machine.legs) {
      LegState state;
      state.flexible << random.uniform(0.1, 0.15), random.uniform(0.1, 0.15), 0.0, 0.0;
      state.oil_force = random.uniform(-2e4, 1e4);
      const Vector3 a = machine.poses[0].X_BP * leg.platform_joint, gravity = random.vector(9.81);
      const auto axes = machine.flexible_axes;
      const auto free = bent_leg(leg, a, axes, gravity, state);
      ASSERT_TRUE(free.exists);
      leg.guide_sleeve.gap = 0.2 * free.element.sleeve_offset.norm();
      leg.guide_sleeve.guide_stiffness = 3.3 * leg.guide_sleeve.stiffness;
      const auto bent = bent_leg(leg, a, axes, gravity, state);
      ASSERT_GT(bent.element.k_contact, 0.0);
      ++pressed;
      LegPotential::Coordinates x;
      x << a.cast<long double>(), state.flexible.cast<long double>();
      const LegPotential potential(leg, leg.gimbal_axis, gravity, state.oil_force, x);
      Vector7 gradient;
      gradient << bent.joint_force, bent.flexible_gradient;
      const Vector7 expected = potential.gradient(x, LegPotential::contact_step);
      EXPECT_LE((gradient - expected).norm(), tolerance * expected.norm());
      Matrix7 to_base = Matrix7::Identity();
      to_base.topLeftCorner<3, 3>() = bent.element.frame.R_BL;
      const Matrix7 hessian =
          to_base.transpose() * potential.hessian(x, LegPotential::contact_step) * to_base;
      EXPECT_LE((bent.K_without_oil - hessian).norm(), tolerance * hessian.norm());
      EXPECT_GT((bent.K_without_oil - free.K_without_oil).norm(), 0.1 * hessian.norm());
    }
  }
  EXPECT_EQ(pressed, 36);
}

/// A machine whose rods sag through three times their gap.
model::Machine pressed_machine(Random& random) {
  auto machine =
      random_machine(random, {.axes = model::FlexibleAxes::gimbal, .gravity = Gravity::anywhere});
  lay_on_guides(machine);
  return machine;
}

TEST(GuideContactMachine, StandsOnItsGuidesWhereTheSealsAloneWouldLetItDown) {
  Random random(5021);
  for (int i = 0; i < 20; ++i) {
    const auto machine = pressed_machine(random);
    const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
    ASSERT_EQ(model.statics.status, dynamics::StaticsStatus::converged);
    for (int leg = 0; leg < model::leg_count; ++leg) {
      const double free = 3.0 * *machine.legs[leg].guide_sleeve.gap;
      EXPECT_LT(model.legs[leg].sleeve_offset.norm(), free);
    }
    EXPECT_GT(modal::normal_modes(model).omega2[0], 0.0);
  }
}

/// Without a gap a guide ring's stiffness changes no bit. A gap that no rod uses up changes nothing
/// but the way to the equilibrium; one that is used up does.
TEST(GuideContactMachine, WithoutAGapIsBitForBitTheOneWithoutARing) {
  Random random(313);
  for (const auto kind : {ModelKind::rigid, ModelKind::guide, ModelKind::full}) {
    const auto without =
        random_machine(random, {.axes = model::FlexibleAxes::gimbal, .gravity = Gravity::anywhere});
    const auto& X = without.neutral();
    const auto expected = dynamics::linear_model(without, X, kind);
    auto ring = without;
    for (auto& leg : ring.legs)
      leg.guide_sleeve.guide_stiffness = 43.0 * leg.guide_sleeve.stiffness;
    const auto same = dynamics::linear_model(ring, X, kind);
    EXPECT_EQ(same.M, expected.M);
    EXPECT_EQ(same.K, expected.K);
    EXPECT_EQ(same.C, expected.C);
    for (std::size_t i = 0; i < model::leg_count; ++i) {
      EXPECT_EQ(same.statics.legs[i].flexible, expected.statics.legs[i].flexible);
      EXPECT_EQ(same.statics.legs[i].oil_force, expected.statics.legs[i].oil_force);
    }
    if (kind == ModelKind::rigid) continue;
    const auto with_gaps = [&](double share) {
      auto machine = ring;
      for (std::size_t i = 0; i < model::leg_count; ++i)
        machine.legs[i].guide_sleeve.gap = share * expected.legs[i].sleeve_offset.norm();
      return dynamics::linear_model(machine, X, kind);
    };
    constexpr double converged = 1e-9;
    const auto open = with_gaps(1.0 / (1.0 - 1.01 * GuideContact::smoothing)),
               used = with_gaps(0.7);
    EXPECT_LE((open.K - expected.K).norm(), converged * expected.K.norm());
    EXPECT_LE((open.M - expected.M).norm(), converged * expected.M.norm());
    EXPECT_GT((used.K - expected.K).norm(), 1e-3 * expected.K.norm());
  }
}

/// At rest nothing accelerates, and small tilts meet the stiffness of the linear model.
TEST(GuideContactMachine, IsTheSameInTheNonlinearMechanics) {
  Random random(77);
  for (int i = 0; i < 10; ++i) {
    const auto machine = pressed_machine(random);
    const auto& X = machine.neutral();
    const dynamics::NonlinearModel mechanics(machine, ModelKind::guide, X);
    const auto rest = mechanics.equilibrium(X);
    ASSERT_EQ(rest.status, dynamics::StaticsStatus::converged);
    Eigen::VectorXd y(mechanics.positions()), v = Eigen::VectorXd::Zero(mechanics.velocities());
    mechanics.configuration(X, rest.legs, y.data());
    dynamics::Loads loads;
    for (int k = 0; k < model::leg_count; ++k) loads.axial[k] = -rest.legs[k].oil_force;
    const auto forces = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
      dynamics::Motion motion;
      mechanics.motion(at.data(), v.data(), motion);
      Eigen::VectorXd rate(v.size());
      mechanics.accelerations(motion, loads, rate.data());
      return mechanics.mass_matrix(motion) * rate;
    };
    EXPECT_LE(forces(y).norm(), 1e-8 * machine.platform.mass * machine.gravity.norm());
    const auto model = dynamics::linear_model(machine, X, ModelKind::guide);
    constexpr double h = 2e-8;  // rad: the corner is curved over micrometres of the offset
    // The nonlinear coordinates turn the rod otherwise than the linear ones where it is tilted;
    // what does not depend on coordinates are the frequencies of a leg with the platform held.
    dynamics::Motion at_rest;
    mechanics.motion(y.data(), v.data(), at_rest);
    const Eigen::MatrixXd M = mechanics.mass_matrix(at_rest);
    for (int leg = 0; leg < model::leg_count; ++leg) {
      const int first = 6 + 2 * leg;
      Eigen::Matrix2d stiffness;
      for (int k = 0; k < 2; ++k) {
        Eigen::VectorXd ahead = y, behind = y;
        ahead[7 + 2 * leg + k] += h;
        behind[7 + 2 * leg + k] -= h;
        stiffness.col(k) = ((forces(behind) - forces(ahead)) / (2.0 * h)).segment<2>(first);
      }
      const auto& element = model.legs[leg];
      const Matrix7 K = element.K - element.k_h * element.s_x * element.s_x.transpose();
      const auto squares = [](const Eigen::Matrix2d& of_K, const Eigen::Matrix2d& of_M) {
        return Eigen::Vector2d((of_M.inverse() * of_K).eigenvalues().real());
      };
      Eigen::Vector2d found = squares(stiffness, M.block<2, 2>(first, first)),
                      expected = squares(K.block<2, 2>(3, 3), element.M.block<2, 2>(3, 3));
      std::sort(found.begin(), found.end());
      std::sort(expected.begin(), expected.end());
      EXPECT_LE((found - expected).norm(), 1e-4 * expected.norm()) << leg;
    }
  }
}

/// The power of the forces is what the energy loses.
TEST(GuideContactMachine, KeepsItsEnergy) {
  Random random(313);
  auto machine = pressed_machine(random);
  for (auto& leg : machine.legs) leg.guide_sleeve.damping = 0.0;
  const auto& X = machine.neutral();
  const dynamics::NonlinearModel mechanics(machine, ModelKind::guide, X);
  const auto rest = mechanics.equilibrium(X);
  Eigen::VectorXd y(mechanics.positions()), v(mechanics.velocities());
  mechanics.configuration(X, rest.legs, y.data());
  for (int k = 0; k < v.size(); ++k) v[k] = random.uniform(-0.3, 0.3);
  // Fourth-order differences of the total energy along the motion: the rates at (y, v) kept, the
  // error is of the order of the squared step.
  const auto energy_at = [&](double t) {
    Eigen::VectorXd y_rate(y.size()), v_rate(v.size());
    dynamics::Motion motion;
    mechanics.motion(y.data(), v.data(), motion);
    mechanics.rates(y.data(), v.data(), y_rate.data());
    mechanics.accelerations(motion, {}, v_rate.data());
    const Eigen::VectorXd there = y + t * y_rate, moving = v + t * v_rate;
    mechanics.motion(there.data(), moving.data(), motion);
    return mechanics.energies(motion).total();
  };
  constexpr double h = 1e-6;
  const double power = (energy_at(h) - energy_at(-h)) / (2.0 * h);
  dynamics::Motion motion;
  mechanics.motion(y.data(), v.data(), motion);
  const double scale = mechanics.energies(motion).platform * 1e2;  // J/s at rates of 100 1/s
  EXPECT_NEAR(power, 0.0, 1e-6 * scale);
  EXPECT_GT(mechanics.energies(motion).sleeves, 0.0);
}

}  // namespace
}  // namespace hydrapod::test
