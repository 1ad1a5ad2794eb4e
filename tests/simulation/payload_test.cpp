/// Modes of the payload under the nonlinear mechanics and the plant: small motions are those of the
/// linear model, large ones keep energy and momentum.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "support/calibration_machine.hpp"
#include "support/energy_account.hpp"
#include "support/kinds.hpp"
#include "support/payload_modes.hpp"
#include "support/random_machine.hpp"
#include "support/vibrations.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using simulation::Plant;
using spatial::Vector3;
using spatial::Vector6;

/// Oil springs, `count` modes, dampers of legs and payload where `damped`.
model::Machine machine_with(int count, std::uint64_t seed, bool damped) {
  Random random(seed);
  auto machine = random_machine(
      random, {.gravity = Gravity::anywhere, .lowest_load = 0.02, .highest_load = 0.2});
  machine.damping.modal_ratio = 0.0;
  for (auto& leg : machine.legs) {
    leg.stroke.reset();
    const double k_h = machine.platform.mass * random.uniform(2e3, 5e3);
    leg.oil_spring = {.stiffness = k_h, .damping = damped ? 1e-3 * k_h : 0.0};
    leg.guide_sleeve.damping = damped ? 1e-4 * leg.guide_sleeve.stiffness : 0.0;
    if (leg.piston_ring)
      leg.piston_ring->damping = damped ? 1e-4 * leg.piston_ring->stiffness : 0.0;
  }
  put_modes_on(machine, count, random);
  for (auto& mode : machine.payload_modes) mode.damping_ratio = damped ? 0.043 : 0.0;
  return machine;
}

class SmallMotions : public testing::TestWithParam<AxesAndKind> {};

/// The plant linearised by differences, and M, K, C: the same poles, with gravity and dampers.
TEST_P(SmallMotions, HaveThePolesOfTheLinearModel) {
  const auto [axes, kind] = GetParam();
  for (int trial = 0; trial < 3; ++trial) {
    auto machine = machine_with(2 + trial, 11 + static_cast<std::uint64_t>(trial), true);
    machine.flexible_axes = axes;
    const auto& X_BP = machine.poses[1].X_BP;
    const auto linear = dynamics::linear_model(machine, X_BP, kind);
    const auto modes = modal::normal_modes(linear);
    const Plant plant(machine, kind, {.hydraulics = false}, X_BP);
    const auto rest = plant.equilibrium(X_BP);
    VectorXd rate(plant.layout().size);
    ASSERT_TRUE(plant.derivative(0.0, rest.x.data(), rest.input, rate.data()));
    EXPECT_LT(rate.cwiseAbs().maxCoeff(), 1e-6);
    const auto found = vibrations(plant, X_BP);
    std::vector<std::complex<double>> expected;
    for (const auto& mode : modal::damped_modes(linear, modes, 0.0))
      if (mode.damping_ratio < 1.0) expected.push_back(mode.pole);
    for (const auto& pole : expected) {
      if (pole.real() < -100.0) continue;  // vibrations() takes these for spools
      EXPECT_LT((found.array() - pole).abs().minCoeff(), 3e-6 * std::abs(pole)) << pole;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, SmallMotions,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

TEST(PayloadInMotion, HasStatesOfItsOwn) {
  auto machine = machine_with(2, 3, false);
  const Plant plant(machine, ModelKind::rigid, {.hydraulics = false});
  EXPECT_EQ(plant.layout().size, 13 + 4);
  EXPECT_EQ(plant.layout().payload, 2);
  const auto names = plant.state_names();
  EXPECT_EQ(names[7], "payload.mass1");
  EXPECT_EQ(names[8], "payload.mass2");
  EXPECT_EQ(names[9], "vx");
  EXPECT_EQ(names[16], "payload.mass2_rate");
}

/// On a base at rest and on one that moves, undamped and damped.
TEST(PayloadInMotion, KeepsItsEnergyAndAccountsForWhatIsLost) {
  for (const bool base : {false, true})
    for (const bool damped : {false, true}) {
      auto machine = machine_with(3, 17, damped);
      for (auto& leg : machine.legs) leg.oil_spring.stiffness = machine.platform.mass * 70.0;
      if (damped) {
        machine.damping.rayleigh_mass = 0.21;
        machine.damping.rayleigh_stiffness = 3e-5;
      }
      if (base) {
        machine.base_mount = model::BaseMount{.mass = 0.4 * machine.platform.mass};
        machine.base_mount->inertia = 0.5 * machine.platform.inertia.diagonal();
        machine.base_mount->stiffness.fill(3e2 * machine.platform.mass);
      }
      const Plant plant(machine, ModelKind::guide, {.hydraulics = false});
      auto x = plant.equilibrium(machine.neutral()).x;
      Random random(3);
      const int v = plant.layout().velocity(), n = plant.layout().velocities;
      x.segment<6>(v) << random.vector(0.4), random.vector(0.4);
      x.segment<3>(v + n - 3) = random.vector(2.0);
      double elastic = 0.0;
      const auto account = energy_account(plant, x, 1000, 4e-4, [&](const auto& now) {
        elastic = std::max(elastic, now.energies.payload);
      });
      const double scale = account.first.energies.platform + account.first.energies.legs;
      EXPECT_GT(elastic, 1e-3 * scale);  // the modes take part
      if (damped)
        EXPECT_NEAR(account.dissipated, account.lost, 1e-6 * account.lost);
      else
        EXPECT_LT(account.drift, 1e-9 * scale);
    }
}

/// Next to nothing has mass but the platform.
void make_legs_light(model::Machine& machine) {
  for (auto& leg : machine.legs) {
    leg.cylinder_case.mass = leg.rod.mass = 1e-9;
    leg.cylinder_case.transverse_inertia = leg.rod.transverse_inertia = 1e-9;
    leg.cylinder_case.axial_inertia = leg.rod.axial_inertia = 0.0;
    leg.added_axial_inertia = leg.gimbal_cross_inertia = 0.0;
  }
}

/// Without gravity and legs that push, momentum and its moment about the origin change by nothing:
/// dP/dt along accelerations() is zero but for what the bases of the legs take.
TEST(PayloadInMotion, MomentumFollowsTheForces) {
  auto machine = machine_with(3, 23, false);
  machine.gravity.setZero();
  make_legs_light(machine);
  const dynamics::NonlinearModel model(machine, ModelKind::rigid);
  const int n = model.velocities();
  Random random(9);
  VectorXd y(n + 1), v(n), v_rate(n), y_rate(n + 1);
  model.configuration(machine.neutral(), {}, y.data());
  y.tail<3>() = random.vector(0.8);
  v << random.vector(0.6), random.vector(0.8), random.vector(2.0);
  dynamics::Loads loads;
  loads.wrench << 131.0, -77.0, 210.0, 31.0, 17.0, -23.0;
  dynamics::Motion motion;
  model.motion(y.data(), v.data(), motion);
  model.accelerations(motion, loads, v_rate.data());
  model.rates(y.data(), v.data(), y_rate.data());
  const auto momentum_at = [&](double t) -> Vector6 {
    const VectorXd y_t = y + t * y_rate, v_t = v + t * v_rate;
    dynamics::Motion at;
    model.motion(y_t.data(), v_t.data(), at);
    return model.momentum(at);
  };
  constexpr double h = 1e-4;
  const Vector6 change =
      (8.0 * (momentum_at(h) - momentum_at(-h)) - (momentum_at(2.0 * h) - momentum_at(-2.0 * h))) /
      (12.0 * h);
  Vector6 expected = loads.wrench;
  expected.tail<3>() += motion.p_BC.cross(Vector3(loads.wrench.head<3>()));
  EXPECT_LT((change - expected).norm(), 1e-6 * expected.norm());
}

/// Galilei: a platform that moves at a constant velocity feels nothing of it.
TEST(PayloadInMotion, DoesNotFeelAConstantVelocity) {
  auto machine = machine_with(2, 29, false);
  make_legs_light(machine);
  const dynamics::NonlinearModel model(machine, ModelKind::rigid);
  const int n = model.velocities();
  Random random(13);
  VectorXd y(n + 1), v(n), still(n), moving(n);
  model.configuration(machine.neutral(), {}, y.data());
  y.tail<2>() << 0.31, -0.57;
  v << random.vector(0.3), random.vector(0.8), 1.7, -2.1;
  dynamics::Motion motion;
  model.motion(y.data(), v.data(), motion);
  model.accelerations(motion, {}, still.data());
  v.head<3>() += Vector3(1.3, -0.7, 0.9);
  model.motion(y.data(), v.data(), motion);
  model.accelerations(motion, {}, moving.data());
  EXPECT_LT((moving - still).norm(), 1e-6 * still.norm());
}

/// Away from the reference orientation the payload hangs by its weight, and the plant rests there.
TEST(PayloadInMotion, RestsWhereItsWeightHoldsIt) {
  auto machine = machine_with(2, 37, false);
  const Plant plant(machine, ModelKind::guide, {.hydraulics = false, .oil_springs = false});
  const auto& X_BP = machine.poses[1].X_BP;
  const auto rest = plant.equilibrium(X_BP);
  VectorXd rate(plant.layout().size);
  ASSERT_TRUE(plant.derivative(0.0, rest.x.data(), rest.input, rate.data()));
  EXPECT_LT(rate.cwiseAbs().maxCoeff(), 1e-7);
  const auto& mode = machine.payload_modes[0];
  const Vector3 l = model::participation(mode).head<3>();
  const auto g_P = [&](const spatial::Pose& X) -> Vector3 {
    return X.R_BP.transpose() * machine.gravity;
  };
  EXPECT_NEAR(rest.x[plant.layout().positions - 2],
              l.dot(g_P(X_BP) - g_P(machine.neutral())) / std::pow(omega_of(mode), 2), 1e-12);
}

/// Seals' ratio and Rayleigh's dampers reach the payload, too, and poles of the system know it.
TEST(PayloadInMotion, TakesPartInPolesOfTheSystem) {
  Random random(41);
  auto machine = machine_file(random_machine_text(random, true)).machine;
  machine.damping.modal_ratio = 0.013;
  model::PayloadMode mode{.name = "lamp", .frequency = 33.0 / base::two_pi, .damping_ratio = 0.05};
  mode.mass = 1e-6 * machine.platform.mass;  // feels the platform, which does not feel it
  machine.payload_modes = {mode};
  const auto system = simulation::linear_system(machine, machine.neutral(), {.closed = false});
  const auto poles = simulation::system_poles(system);
  const auto lamp =
      std::max_element(poles.poles.begin(), poles.poles.end(), [](const auto& a, const auto& b) {
        const auto part = static_cast<std::size_t>(simulation::Part::payload);
        return a.parts[part] < b.parts[part];
      });
  EXPECT_GT(lamp->parts[static_cast<std::size_t>(simulation::Part::payload)], 0.99);
  EXPECT_NEAR(lamp->omega, 33.0, 1e-4 * 33.0);
  EXPECT_NEAR(lamp->damping_ratio, 0.063, 1e-4);
}

}  // namespace
}  // namespace hydrapod::test
