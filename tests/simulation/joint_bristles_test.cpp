/// Joints that stick before they slide: the law against closed forms, the plant against the linear
/// model with springs, the harmonic balance and its own account of energy.

#include "simulation/joint_bristles.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "hydrapod/simulation/linear_system.hpp"
#include "support/free_flight.hpp"
#include "support/kinds.hpp"
#include "support/loop_machine.hpp"
#include "support/sustained_swing.hpp"
#include "support/symmetric_machine.hpp"
#include "support/vibrations.hpp"

namespace hydrapod::simulation {
namespace {

using dynamics::Vector2;

constexpr JointBristles stuck_law{.coulomb = 37.3, .stiffness = 2.31e5};
constexpr double slack = stuck_law.coulomb / stuck_law.stiffness;  // T_c/σ0 [rad]

/// The bend after turning by `turn(t)`, whose rate is `rate(t)`, from `z` on.
template <class Rate>
Vector2 bent_by(const Rate& rate, Vector2 z, double from, double to, int steps) {
  const double h = (to - from) / steps;
  for (int k = 0; k < steps; ++k) {
    const double t = from + k * h;
    const auto f = [&](double at, const Vector2& bend) {
      return stuck_law.bend(rate(at), bend).rate;
    };
    const Vector2 k1 = f(t, z), k2 = f(t + 0.5 * h, z + 0.5 * h * k1),
                  k3 = f(t + 0.5 * h, z + 0.5 * h * k2), k4 = f(t + h, z + h * k3);
    z += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return z;
}

/// Along one direction, whichever it is: z = T_c/σ0 (1 − exp(−σ0 θ/T_c)), at any speed.
TEST(JointBristles, BreakAwayAlongAnExponential) {
  for (const double angle : {0.0, 0.83, 2.9})
    for (const double turned : {0.07, 0.9, 6.1}) {  // of T_c/σ0
      const Vector2 along(std::cos(angle), std::sin(angle));
      const double theta = turned * slack;
      const auto speed = [&](double t) -> Vector2 {  // from 0 to θ in 1.7 s, ever faster
        return along * (theta * 2.0 * t / (1.7 * 1.7));
      };
      const Vector2 z = bent_by(speed, Vector2::Zero(), 0.0, 1.7, 4000);
      const double expected = slack * (1.0 - std::exp(-theta / slack));
      EXPECT_LT((z - expected * along).norm(), 1e-10 * slack) << angle << ' ' << turned;
      const auto bent = stuck_law.bend(along, z);
      EXPECT_NEAR(bent.torque.norm(), stuck_law.stiffness * expected, 1e-9 * stuck_law.coulomb);
    }
}

/// Turning to and fro by ±A: the bend at the reversals is T_c/σ0 tanh(σ0 A/T_c), and a period takes
/// 4 T_c A − 4 T_c²/σ0 tanh(σ0 A/T_c), which is also what the harmonic balance has for it.
TEST(JointBristles, LoseTheAreaOfTheirHysteresisLoop) {
  for (const double turned : {0.11, 1.3, 9.7}) {
    const double A = turned * slack, omega = 31.0;
    const auto rate = [&](double t) -> Vector2 {
      return Vector2(0.6, -0.8) * (A * omega * std::cos(omega * t));
    };
    const double period = 2.0 * std::numbers::pi / omega, reversal = 0.25 * period;
    const double z_A = slack * std::tanh(turned);
    constexpr int settled = 40;
    Vector2 z = bent_by(rate, Vector2::Zero(), 0.0, reversal, 4000);
    for (int k = 0; k < settled; ++k)
      z = bent_by(rate, z, reversal + k * period, reversal + (k + 1) * period, 4000);
    EXPECT_LT((z - z_A * Vector2(0.6, -0.8)).norm(), 1e-7 * slack) << turned;

    double work = 0.0;
    constexpr int parts = 4000;
    double t = reversal + settled * period;
    for (int k = 0; k < parts; ++k) {  // midpoint rule
      const double h = period / parts;
      const Vector2 middle = bent_by(rate, z, t, t + 0.5 * h, 1);
      const Vector2 w = rate(t + 0.5 * h);
      work += h * stuck_law.bend(w, middle).torque.dot(w);
      z = bent_by(rate, z, t, t + h, 2);
      t += h;
    }
    const double T = stuck_law.coulomb;
    const double area = 4.0 * T * A - 4.0 * T * slack * std::tanh(turned);
    EXPECT_NEAR(work, area, 2e-5 * area) << turned;

    hydraulics::Friction law;
    law.coulomb = law.breakaway = T;
    law.bristle_stiffness = stuck_law.stiffness;
    const auto balance = hydraulics::friction_equivalent(law, A, omega);
    EXPECT_NEAR(std::numbers::pi * A * A * omega * balance.damping, area, 1e-4 * area) << turned;
  }
}

/// Turning whose direction goes round at Ω with the speed w: the bend follows it at the distance
/// w/√(λ² + Ω²), λ = σ0 w/T_c, later by atan(Ω/λ).
TEST(JointBristles, FollowATurningThatGoesRound) {
  for (const double ratio : {0.2, 1.0, 7.0}) {  // Ω/λ
    const double speed = 0.0213, lambda = speed / slack, Omega = ratio * lambda;
    const auto rate = [&](double t) -> Vector2 {
      return Vector2(speed * std::cos(Omega * t), speed * std::sin(Omega * t));
    };
    const double end = 40.0 / lambda;
    const Vector2 z = bent_by(rate, Vector2::Zero(), 0.0, end, 40000);
    const double angle = Omega * end - std::atan(ratio);
    const double size = speed / std::hypot(lambda, Omega);
    EXPECT_LT((z - size * Vector2(std::cos(angle), std::sin(angle))).norm(), 1e-9 * slack);
  }
}

// ---- The plant ------------------------------------------------------------------------------

model::Machine with_stuck_joints(model::Machine machine, double stiffness, double damping = 0.0) {
  machine.damping.modal_ratio = 0.0;
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    auto& leg = machine.legs[i];
    leg.oil_spring.damping = 0.0;
    leg.guide_sleeve.damping = 0.0;
    leg.hydraulics.joint_friction = {
        .coulomb = 40.0 + 3.0 * static_cast<double>(i),
        .bristle_stiffness = stiffness * (1.0 + 0.1 * static_cast<double>(i)),
        .bristle_damping = damping};
  }
  return machine;
}

/// Directions of all legs in the base and in the platform per motion of the platform, 36 × 6, by
/// central differences: bristles that stick are springs between them and both.
Eigen::Matrix<double, 36, 6> turned_by(const model::Machine& machine) {
  const auto& X_BP = machine.neutral();
  const Vector3 C = X_BP.p_BP + X_BP.R_BP * machine.platform.mass_center;
  constexpr double step = 1e-6;
  Eigen::Matrix<double, 36, 6> per;
  for (int k = 0; k < 6; ++k) {
    Eigen::Matrix<double, 36, 2> at;
    for (const int side : {0, 1}) {
      Vector6 q = Vector6::Unit(k) * (side == 0 ? step : -step);
      const spatial::Matrix3 R =
          (k < 3 ? spatial::Matrix3(spatial::Matrix3::Identity())
                 : Eigen::AngleAxisd(q[k], Vector3::Unit(k - 3)).toRotationMatrix()) *
          X_BP.R_BP;
      for (int i = 0; i < model::leg_count; ++i) {
        const auto& leg = machine.legs[static_cast<std::size_t>(i)];
        const Vector3 joint =
            C + q.head<3>() + R * (leg.platform_joint - machine.platform.mass_center);
        const Vector3 n = (joint - leg.base_joint).normalized();
        at.col(side).segment<6>(6 * i) << n, R.transpose() * n;
      }
    }
    per.col(k) = (at.col(0) - at.col(1)) / (2.0 * step);
  }
  return per;
}

/// Poles of the linearised plant against those of M ÿ + σ1 Tᵀ T ẏ + (K + σ0 Tᵀ T) y = 0.
TEST(StuckJoints, AreRotationalSpringsAndDampersOfTheLinearisedPlant) {
  for (const double damping : {0.0, 61.0}) {
    const auto machine = with_stuck_joints(test::symmetric_machine(), 2.3e5, damping);
    const auto& X_BP = machine.neutral();
    const auto linear = dynamics::linear_model(machine, X_BP, ModelKind::rigid);
    Eigen::Matrix<double, 36, 1> sigma;
    for (int i = 0; i < model::leg_count; ++i)
      sigma.segment<6>(6 * i).setConstant(
          *machine.legs[static_cast<std::size_t>(i)].hydraulics.joint_friction.bristle_stiffness);
    const auto T = turned_by(machine);
    Eigen::Matrix<double, 12, 12> A = Eigen::Matrix<double, 12, 12>::Zero();
    const spatial::Matrix6 M = linear.M, K = linear.K;
    A.topRightCorner<6, 6>().setIdentity();
    A.bottomLeftCorner<6, 6>() = -M.inverse() * (K + T.transpose() * sigma.asDiagonal() * T);
    A.bottomRightCorner<6, 6>() = -M.inverse() * (damping * T.transpose() * T);
    std::vector<std::complex<double>> expected;
    for (const std::complex<double> pole : A.eigenvalues())
      if (pole.imag() > 1.0) expected.push_back(pole);
    std::ranges::sort(expected, {}, [](auto pole) { return pole.imag(); });
    ASSERT_EQ(expected.size(), 6U);

    const auto poles_with = [&](Friction friction) {
      const Plant plant(machine, ModelKind::rigid, {.hydraulics = false, .friction = friction},
                        X_BP);
      return test::vibrations(plant, X_BP);
    };
    for (const auto friction : {Friction::all, Friction::viscous}) {  // with states and without
      const auto found = poles_with(friction);
      ASSERT_EQ(found.size(), 6);
      for (int k = 0; k < 6; ++k)
        EXPECT_LT(std::abs(found[k] - expected[static_cast<std::size_t>(k)]),
                  2e-6 * std::abs(found[k]))
            << damping << ' ' << found[k];
      EXPECT_GT(found[0].imag(), 1.01 * poles_with(Friction::none)[0].imag());
    }
  }
}

/// The harmonic balance has the turning of straight legs as rows of its own: at 1 nm its modes are
/// those of the linearised plant, with all bending of the legs.
class StuckJointsOfKinds : public testing::TestWithParam<test::AxesAndKind> {};

TEST_P(StuckJointsOfKinds, VibrateAsInTheHarmonicBalance) {
  const auto [axes, kind] = GetParam();
  auto machine = test::symmetric_machine();
  machine.flexible_axes = axes;
  machine.gravity.setZero();  // legs are straight
  if (kind == ModelKind::full)
    for (auto& leg : machine.legs) leg.piston_ring = model::PistonRing{.stiffness = 3.1e6};
  machine = with_stuck_joints(machine, 1.7e5);
  const auto& X_BP = machine.neutral();
  const Plant plant(machine, kind, {.hydraulics = false, .friction = Friction::viscous}, X_BP);
  const auto poles = test::undamped_frequencies(plant, X_BP);
  const auto curves = modal::modes_at_amplitudes(machine, X_BP, kind, std::vector{1e-9});
  ASSERT_GE(curves.size(), 6U);
  for (const auto& curve : curves) {
    ASSERT_TRUE(curve.points.front().converged);
    const double omega = curve.points.front().omega;
    EXPECT_LT((poles.array() - omega).abs().minCoeff(), 3e-6 * omega) << curve.mode;
  }
}

INSTANTIATE_TEST_SUITE_P(, StuckJointsOfKinds,
                         testing::Combine(test::both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return test::name(test); });

/// Bristles that stick for the most part, slide at the turns, and slide for long. Valves are shut.
TEST(SwingsOfStuckJoints, HaveFrequencyAndLossOfTheHarmonicBalance) {
  auto machine = machine_of("zhang-jiang-2021", {"damping.modal_ratio=0"});
  test::block_cylinders(machine);
  for (auto& leg : machine.legs) {
    leg.oil_spring.damping = 0.0;
    leg.hydraulics.joint_friction = {
        .coulomb = 83.0, .bristle_stiffness = 6.1e5, .bristle_damping = 310.0};
  }
  const double ratio = swing_as_in_the_balance(
      machine, {1.1e-5, 1.3e-4, 2.3e-3}, {.amplitude = 0.02, .frequency = 0.07, .damping = 0.08});
  EXPECT_GT(ratio, 2.0);
  // where sticking gives way to sliding, frequency and loss change most with the amplitude
  swing_as_in_the_balance(machine, {9.1e-4},
                          {.amplitude = 0.02, .frequency = 0.1, .damping = 0.09});
}

/// What the platform and the legs lose in large motions is what the bristles keep and dissipate:
/// their torques do the work of the rates that bend them.
TEST(StuckJoints, AccountForTheEnergyOfLargeMotions) {
  for (const auto axes : {model::FlexibleAxes::transverse, model::FlexibleAxes::gimbal})
    for (const auto kind : {ModelKind::rigid, ModelKind::guide}) {
      test::FreeFlight flight(axes, kind);
      flight.stick();
      const auto result =
          flight.run(1.0, {.relative_tolerance = 1e-12, .absolute_tolerance = 1e-12}, 1e-4);
      EXPECT_GT(result.lost, 0.05 * result.first_energy);
      EXPECT_NEAR(result.dissipated / result.lost, 1.0, 1e-7);
      EXPECT_GE(result.smallest_dissipation, 0.0);
    }
}

/// Under a load that the joints can carry they bend and stay; the smooth law creeps.
TEST(StuckJoints, DoNotCreep) {
  auto machine = test::symmetric_machine();
  for (auto& leg : machine.legs)
    leg.hydraulics.joint_friction = {
        .coulomb = 400.0, .smoothing_rate = 0.01, .bristle_damping = 1200.0};
  const auto creep = [&](std::optional<double> stiffness) {
    for (auto& leg : machine.legs) leg.hydraulics.joint_friction.bristle_stiffness = stiffness;
    const Plant plant(machine, ModelKind::rigid, {.hydraulics = false, .oil_springs = false});
    auto rest = plant.equilibrium(machine.neutral());
    rest.input.wrench[5] = 60.0;  // about z, where nothing else holds
    Integrator run(plant, {.relative_tolerance = 1e-8, .absolute_tolerance = 1e-8});
    run.start(0.0, rest.x);
    run.advance(1.0, rest.input);
    const double before = plant.pose(run.state().data()).R_BP(1, 0);
    run.advance(2.0, rest.input);
    return std::abs(plant.pose(run.state().data()).R_BP(1, 0) - before);
  };
  const double smooth = creep({}), bristles = creep(3e5);
  EXPECT_GT(smooth, 1e-5);
  EXPECT_LT(bristles, 1e-3 * smooth);
}

TEST(StuckJoints, StandInTheStateBehindTheLines) {
  auto machine = machine_of("heavy-platform", {"base.mount.stiffness.x=\"800 kN/mm\""});
  const Plant before(machine, ModelKind::guide);
  machine.legs[2].hydraulics.joint_friction = {.coulomb = 41.0, .bristle_stiffness = 2e5};
  const Plant plant(machine, ModelKind::guide);
  const auto& layout = plant.layout();
  EXPECT_EQ(layout.size, before.layout().size + 24);
  EXPECT_EQ(layout.joints, before.layout().base);
  EXPECT_EQ(layout.base, layout.joints + 24);
  const auto names = plant.state_names();
  EXPECT_EQ(names.at(static_cast<std::size_t>(layout.joint(2, false))),
            "leg3.base_joint_bristle_t");
  EXPECT_EQ(names.at(static_cast<std::size_t>(layout.joint(2, true) + 1)),
            "leg3.platform_joint_bristle_a2");
  EXPECT_EQ(plant.state_units().at(static_cast<std::size_t>(layout.joint(5, true))), "rad");
  const Plant none(machine, ModelKind::guide, {.friction = Friction::none});
  EXPECT_EQ(none.layout(), before.layout());
}

/// No state of its own, so that nothing stands still at a pole of zero.
TEST(StuckJoints, AreSpringsInThePolesOfTheWholeSystem) {
  auto machine = machine_of("heavy-platform");
  const auto lowest_of = [](const model::Machine& of) {
    const auto system = linear_system(of, of.neutral(), {.sampled = false});
    const auto poles = system_poles(system);
    EXPECT_TRUE(poles.stable);
    double lowest = 1e9;
    for (const auto& pole : poles.poles)
      if (pole.oscillates() && pole.parts[0] + pole.parts[1] > 0.2)
        lowest = std::min(lowest, pole.omega);
    return std::pair(lowest, system.A.rows());
  };
  const auto [sliding, states] = lowest_of(machine);
  for (auto& leg : machine.legs)
    leg.hydraulics.joint_friction = {.coulomb = 41.0, .bristle_stiffness = 3e6};
  const auto [sticking, as_many] = lowest_of(machine);
  EXPECT_EQ(as_many, states);
  EXPECT_GT(sticking, 1.01 * sliding);
}

}  // namespace
}  // namespace hydrapod::simulation
