/// A base on springs under the plant: its vibrations against a system of twelve coordinates that
/// was built apart from it, its energy, and what everybody sees of it.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "support/calibration_machine.hpp"
#include "support/energy_account.hpp"
#include "support/kinds.hpp"
#include "support/random_machine.hpp"
#include "support/unreduced_mount.hpp"
#include "support/vibrations.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using simulation::Plant;
using simulation::PlantInput;
using spatial::Vector3;
using spatial::Vector6;

/// No damping, no gravity, on a mount of `times` the legs' stiffness, with `mass` of the
/// platform's.
model::Machine machine_on(std::uint64_t seed, double times, double mass, bool gravity = false) {
  Random random(seed);
  auto machine = machine_file(random_machine_text(random, gravity)).machine;
  machine.damping.modal_ratio = 0.0;
  for (auto& leg : machine.legs) {
    leg.oil_spring.damping = leg.guide_sleeve.damping = 0.0;
    leg.piston_ring = model::PistonRing{3.7e6, 0.0};
  }
  const double k = times * *machine.legs[0].oil_spring.stiffness;
  model::BaseMount mount{.mass = mass * machine.platform.mass};
  mount.stiffness = {1.1 * k, 0.9 * k, 1.4 * k, 0.8 * k, 1.2 * k, 1.7 * k};
  mount.inertia = mass * Vector3(0.9, 1.1, 1.3) * machine.platform.inertia.trace() / 3.0;
  machine.base_mount = mount;
  return machine;
}

const spatial::Pose& tilted_pose(const model::Machine& machine) {
  return machine.poses.back().X_BP;
}

VectorXd expected_frequencies(const model::Machine& machine) {
  const auto system = unreduced_mount(machine, tilted_pose(machine));
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(system.K, system.M);
  return solver.eigenvalues().cwiseSqrt();
}

TEST(MovingBase, VibratesAsTheTwelveCoordinatesDo) {
  for (const double times : {0.7, 3.0, 20.0}) {
    const auto machine = machine_on(41, times, 0.6);
    const Plant plant(machine, ModelKind::rigid, {.hydraulics = false}, tilted_pose(machine));
    EXPECT_TRUE(plant.base().added_inertia.isZero(0.0));
    const auto found = undamped_frequencies(plant, tilted_pose(machine));
    const auto expected = expected_frequencies(machine);
    ASSERT_EQ(found.size(), 12);
    for (int k = 0; k < 12; ++k) EXPECT_NEAR(found[k], expected[k], 1e-7 * expected[k]) << k;
  }
}

TEST(MovingBase, InSomeDirectionsOnlyHasAsManyCoordinates) {
  auto machine = machine_on(43, 2.0, 0.4);
  auto& stiffness = machine.base_mount->stiffness;
  stiffness[0].reset();
  stiffness[3].reset();
  stiffness[5].reset();
  const Plant plant(machine, ModelKind::rigid, {.hydraulics = false}, tilted_pose(machine));
  EXPECT_EQ(plant.layout().size, 13 + 6);
  EXPECT_EQ(plant.state_names()[13], "base.y");
  EXPECT_EQ(plant.state_names()[18], "base.ry_rate");
  EXPECT_EQ(plant.state_units()[18], "rad/s");
  const auto system = unreduced_mount(machine, tilted_pose(machine));
  const std::vector<int> free{0, 1, 2, 3, 4, 5, 7, 8, 10};
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(MatrixXd(system.K(free, free)),
                                                                  MatrixXd(system.M(free, free)));
  const auto found = undamped_frequencies(plant, tilted_pose(machine));
  ASSERT_EQ(found.size(), 9);
  for (int k = 0; k < 9; ++k) {
    const double expected = std::sqrt(solver.eigenvalues()[k]);
    EXPECT_NEAR(found[k], expected, 1e-7 * expected) << k;
  }
}

/// A base without mass of its own would vibrate fast; what keeps it slow does not touch the
/// platform's modes. Their error is told by the header.
TEST(MovingBase, WithoutMassKeepsThePlatformsModes) {
  for (const double times : {0.7, 3.0, 20.0, 300.0, 1e5, 1e9}) {
    const auto machine = machine_on(47, times, 0.0);
    const Plant plant(machine, ModelKind::rigid, {.hydraulics = false}, tilted_pose(machine));
    const auto found = undamped_frequencies(plant, tilted_pose(machine));
    const auto expected = expected_frequencies(machine);
    ASSERT_EQ(found.size(), 12);
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(found[k], expected[k], 3e-4 * expected[k]) << times;
    auto still = machine;
    still.base_mount.reset();
    const Plant on_rock(still, ModelKind::rigid, {.hydraulics = false}, tilted_pose(machine));
    const auto highest = undamped_frequencies(on_rock, tilted_pose(machine))[5];
    EXPECT_LT(found[11], 20.5 * highest) << times;
    if (times < 1e9) continue;
    const auto rock = undamped_frequencies(on_rock, tilted_pose(machine));
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(found[k], rock[k], 1e-7 * rock[k]);
  }
}

/// Chambers instead of springs, valves shut: the same machine, the same vibrations.
TEST(MovingBase, CarriesAMachineOnBlockedCylinders) {
  auto machine = machine_on(53, 2.5, 0.5);
  block_cylinders(machine);
  for (auto& leg : machine.legs)  // mid stroke, where Eq. 16 holds, at the neutral pose
    leg.gimbal_stiffness = 2.1 * *leg.oil_spring.stiffness;
  machine.poses.back() = machine.poses.front();
  const Plant plant(machine, ModelKind::rigid, {.friction = simulation::Friction::none});
  const auto found = undamped_frequencies(plant, machine.neutral());
  const auto expected = expected_frequencies(machine);
  ASSERT_EQ(found.size(), 12);
  for (int k = 0; k < 12; ++k) EXPECT_NEAR(found[k], expected[k], 1e-5 * expected[k]) << k;
}

class Carried : public testing::TestWithParam<AxesAndKind> {};

/// Legs bent by gravity, large motions: nothing is lost, and what dampers take is.
TEST_P(Carried, KeepsItsEnergy) {
  const auto [axes, kind] = GetParam();
  for (const bool damped : {false, true}) {
    auto machine = machine_on(59, 1.3, 0.3, true);
    machine.flexible_axes = axes;
    for (auto& leg : machine.legs) {
      leg.guide_sleeve.stiffness *= 6.0;
      leg.oil_spring.stiffness = 0.2 * *leg.oil_spring.stiffness;
      leg.piston_ring->stiffness = 4.0 * leg.guide_sleeve.stiffness;
    }
    if (damped) {
      machine.damping.modal_ratio = 0.03;
      machine.damping.rayleigh_mass = 0.3;
      machine.damping.rayleigh_stiffness = 1e-4;
    }
    const Plant plant(machine, kind, {.hydraulics = false});
    Random random(3);
    auto x = plant.equilibrium(machine.neutral()).x;
    const auto& layout = plant.layout();
    x.segment<6>(layout.velocity()) << random.vector(0.4), random.vector(0.4);
    x.segment<6>(layout.base + 6) << random.vector(0.1), random.vector(0.1);
    double largest = 0.0;
    const auto account = energy_account(plant, x, 1000, 2e-4, [&](const auto& now) {
      largest = std::max(largest, now.base.elastic_energy);
    });
    const double scale = account.first.energies.platform + account.first.base.kinetic_energy;
    EXPECT_GT(largest, 0.01 * scale);
    if (damped) {
      EXPECT_GT(account.lost, 0.05 * scale);
      EXPECT_NEAR(account.dissipated, account.lost, 1e-7 * account.lost);
    } else {
      EXPECT_LT(account.drift, 1e-9 * scale);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, Carried,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

/// The springs of the mount hold what is put on the platform.
TEST(MovingBase, GivesWayToAForceOnThePlatform) {
  auto machine = machine_on(61, 2.0, 0.5);
  machine.damping.modal_ratio = 0.7;  // comes to rest soon
  for (auto& leg : machine.legs) leg.oil_spring.damping = 0.02 * *leg.oil_spring.stiffness;
  const Plant plant(machine, ModelKind::rigid, {.hydraulics = false}, tilted_pose(machine));
  auto rest = plant.equilibrium(tilted_pose(machine));
  PlantInput input;
  input.wrench << 130.0, -70.0, 210.0, 31.0, 17.0, -23.0;
  simulation::Integrator run(plant, {.relative_tolerance = 1e-11, .absolute_tolerance = 1e-11});
  run.start(0.0, rest.x);
  run.advance(3.0, input);
  const auto out = plant.outputs(run.state().data(), input);
  Vector6 at_origin = input.wrench;
  at_origin.tail<3>() += out.p_BC.cross(Vector3(input.wrench.head<3>()));
  for (int k = 0; k < 6; ++k)
    EXPECT_NEAR(out.base.motion[k], at_origin[k] / plant.base().stiffness[k],
                1e-6 * at_origin.norm() / plant.base().stiffness[k]);
}

/// Accelerations against the ground are the second differences of where the mass centre is then.
TEST(MovingBase, AddsItsAccelerationToThePlatforms) {
  const auto machine = machine_on(67, 1.5, 0.4);
  const Plant plant(machine, ModelKind::guide, {.hydraulics = false});
  auto x = plant.equilibrium(machine.neutral()).x;
  x.segment<6>(plant.layout().base) << 3e-6, -2e-6, 4e-6, 3e-6, 5e-6, -4e-6;
  simulation::Integrator run(plant, {.relative_tolerance = 1e-13, .absolute_tolerance = 1e-13});
  run.start(0.0, x);
  constexpr double h = 2e-4;
  std::array<Vector3, 5> places;
  Vector3 acceleration = Vector3::Zero(), against_base = acceleration;
  for (int k = 0; k < 5; ++k) {
    run.advance(0.01 + h * k, {});
    const auto out = plant.outputs(run.state().data(), {});
    places[static_cast<std::size_t>(k)] =
        out.p_BC + Vector3(dynamics::carried(out.base.motion, out.p_BC).head<3>());
    if (k != 2) continue;
    acceleration = out.ground_acceleration.head<3>();
    against_base = out.acceleration.head<3>();
  }
  const Vector3 seen =
      (16.0 * (places[1] + places[3]) - places[0] - places[4] - 30.0 * places[2]) / (12.0 * h * h);
  EXPECT_LT((seen - acceleration).norm(), 1e-4 * acceleration.norm());
  EXPECT_GT((seen - against_base).norm(), 1e-2 * acceleration.norm());
}

/// The modes that leg lengths show: those of the linear model, which are motions against the
/// ground, brought to the base.
TEST(MovingBase, ShowsTheShapesOfTheLinearModelAgainstTheBase) {
  auto machine = machine_on(71, 2.0, 0.7);
  block_cylinders(machine);
  machine.poses.back() = machine.poses.front();
  const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::rigid);
  const auto modes = modal::normal_modes(model);
  const auto poles = simulation::system_poles(simulation::linear_system(
      machine, machine.neutral(), {.kind = ModelKind::rigid, .closed = false}));
  spatial::Matrix6 to_origin = spatial::Matrix6::Identity();  // of P, from C
  to_origin.topRightCorner<3, 3>() = -spatial::skew(machine.neutral().p_BP - model.p_BC);
  const auto mac = [](const Vector6& a, const Vector6& b) {
    return std::pow(a.dot(b), 2) / (a.squaredNorm() * b.squaredNorm());
  };
  double differs = 0.0;  // the shapes against the ground
  for (int k = 0; k < 12; ++k) {
    const auto pole = std::ranges::min_element(poles.poles, {}, [&](const auto& one) {
      return one.oscillates() ? std::abs(one.omega - modes.omega(k)) : 1e9;
    });
    EXPECT_NEAR(pole->omega, modes.omega(k), 1e-5 * modes.omega(k));
    Eigen::Index largest = 0;
    pole->motion.cwiseAbs().maxCoeff(&largest);
    const Vector6 seen = (pole->motion / pole->motion[largest]).real();
    const Vector6 shape = modes.shapes.col(k).head<6>();
    const double against_base = mac(seen, to_origin * (model.against_base * modes.shapes.col(k)));
    EXPECT_GT(against_base, 1.0 - 1e-6) << k;
    const Vector6 felt = (pole->ground_motion / pole->motion[largest]).real();
    EXPECT_GT(mac(felt, to_origin * shape), 1.0 - 1e-6) << k;
    differs = std::max(differs, 1.0 - mac(seen, to_origin * shape));
    double sum = 0.0;
    for (const double part : pole->parts) sum += part;
    EXPECT_NEAR(sum, 1.0, 1e-9);
    EXPECT_GT(pole->parts[static_cast<std::size_t>(simulation::Part::base)], 0.0);
  }
  EXPECT_GT(differs, 1e-3);
}

}  // namespace
}  // namespace hydrapod::test
