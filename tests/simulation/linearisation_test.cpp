/// The plant linearised against the linear model, which was derived and checked apart from it.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/simulation/plant.hpp"
#include "support/kinds.hpp"
#include "support/published_machine.hpp"
#include "support/random_machine.hpp"
#include "support/vibrations.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using simulation::Plant;

/// Largest |A − B| with rows and columns scaled to the diagonal of `scale`.
double scaled_error(const MatrixXd& A, const MatrixXd& B, const MatrixXd& scale) {
  const VectorXd d = scale.diagonal().cwiseAbs().cwiseSqrt().cwiseInverse();
  return (d.asDiagonal() * (A - B) * d.asDiagonal()).cwiseAbs().maxCoeff();
}

class AtRandomPoses : public testing::TestWithParam<AxesAndKind> {};

TEST_P(AtRandomPoses, ThePlantsLinearisationIsTheLinearModel) {
  const auto [axes, kind] = GetParam();
  Random random(5519);
  double worst_K = 0.0, worst_C = 0.0;
  for (int k = 0; k < 12; ++k) {
    auto machine = random_machine(random, {.axes = axes, .gravity = Gravity::anywhere});
    machine.damping.rayleigh_mass = random.uniform(0.0, 0.5);
    for (auto& leg : machine.legs) leg.stroke.reset();  // no stops near the pose
    for (auto& leg : machine.legs)
      if (leg.oil_spring.cylinder) leg.oil_spring = {.stiffness = 3.1e6 + 1e5 * k};
    for (int i = k % 2; i < 6; i += 2)  // every other leg on gimbals that give way
      machine.legs[i].gimbal_stiffness = (0.6 + 0.7 * i) * *machine.legs[i].oil_spring.stiffness;
    for (int i = k % 3; i < 6; i += 3)  // and every third with seals that stick
      machine.legs[i].stick_stiffness = (0.2 + 0.3 * i) * *machine.legs[i].oil_spring.stiffness;
    for (const auto& pose : machine.poses) {
      const Plant plant(machine, kind, {.hydraulics = false}, pose.X_BP);
      const auto rest = plant.equilibrium(pose.X_BP);
      const auto linear = plant.linearise(rest.x, rest.input);
      const auto model = dynamics::linear_model(machine, pose.X_BP, kind);
      dynamics::Motion motion;
      plant.mechanics().motion(rest.x.data(), rest.x.data() + plant.layout().velocity(), motion);
      const MatrixXd M = plant.mechanics().mass_matrix(motion);
      const int n = model.dof();
      EXPECT_LE(scaled_error(M, model.M, model.M), 1e-12) << pose.name;
      EXPECT_LE((linear.A.topRightCorner(n, n) - MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff(),
                1e-9);
      const double K_error = scaled_error(-M * linear.A.bottomLeftCorner(n, n), model.K, model.K);
      const double C_error = scaled_error(-M * linear.A.bottomRightCorner(n, n), model.C, model.C);
      EXPECT_LE(K_error, 1e-6) << pose.name;
      EXPECT_LE(C_error, 1e-6) << pose.name;
      worst_K = std::max(worst_K, K_error);
      worst_C = std::max(worst_C, C_error);
      // Wrench to acceleration: M⁻¹.
      const MatrixXd per_wrench = linear.B.bottomRightCorner(n, 6);
      const MatrixXd expected = M.inverse().leftCols<6>();
      EXPECT_LE((per_wrench - expected).norm(), 1e-7 * expected.norm());
    }
  }
  RecordProperty("worst_K", std::to_string(worst_K));
  RecordProperty("worst_C", std::to_string(worst_C));
}

INSTANTIATE_TEST_SUITE_P(, AtRandomPoses,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

/// Rayleigh's β adds to the dampers β times every spring, and where nothing is loaded K is of
/// springs alone.
TEST(RayleighDamping, IsProportionalToTheStiffness) {
  Random random(412);
  auto machine = random_machine(random, {.gravity = Gravity::none});
  machine.damping.modal_ratio = 0.0;
  for (auto& leg : machine.legs) {
    leg.stroke.reset();
    leg.oil_spring = {.stiffness = random.uniform(2e6, 9e6)};
  }
  const auto& X_BP = machine.poses[1].X_BP;
  constexpr double beta = 3.7e-4;
  for (const auto kind : {ModelKind::rigid, ModelKind::guide, ModelKind::full}) {
    const auto linear_with = [&](double rayleigh) {
      machine.damping.rayleigh_stiffness = rayleigh;
      const Plant plant(machine, kind, {.hydraulics = false}, X_BP);
      const auto rest = plant.equilibrium(X_BP);
      return plant.linearise(rest.x, rest.input).A;
    };
    const MatrixXd without = linear_with(0.0), with = linear_with(beta);
    const auto n = without.rows() / 2;
    const MatrixXd added = with.bottomRightCorner(n, n) - without.bottomRightCorner(n, n);
    const MatrixXd expected = beta * without.bottomLeftCorner(n, n);
    EXPECT_LE((added - expected).norm(), 1e-5 * expected.norm()) << static_cast<int>(kind);
  }
}

class OnAMount : public testing::TestWithParam<AxesAndKind> {};

/// The plant's coordinates are motion against the base and of the base: y = S z.
TEST_P(OnAMount, ThePlantsLinearisationIsTheLinearModelWithItsBase) {
  const auto [axes, kind] = GetParam();
  Random random(6121);
  for (int k = 0; k < 6; ++k) {
    auto machine = random_machine(random, {.axes = axes, .gravity = Gravity::anywhere});
    machine.damping.modal_ratio = 0.0;
    machine.damping.rayleigh_mass = random.uniform(0.0, 0.5);
    for (auto& leg : machine.legs) {
      leg.stroke.reset();
      leg.cylinder_case.axial_inertia =
          random.uniform(0.1, 0.9) * leg.cylinder_case.transverse_inertia;
      leg.rod.axial_inertia = random.uniform(0.1, 0.9) * leg.rod.transverse_inertia;
      if (axes == model::FlexibleAxes::gimbal)
        leg.gimbal_cross_inertia = random.uniform(0.1, 0.9) * leg.rod.transverse_inertia;
      if (leg.oil_spring.cylinder) leg.oil_spring = {.stiffness = 3.1e6 + 1e5 * k};
    }
    const double stiffness = 1.3 * *machine.legs[0].oil_spring.stiffness;
    model::BaseMount mount{.mass = 0.6 * machine.platform.mass,
                           .inertia = 0.6 * machine.platform.inertia.diagonal()};
    for (auto& spring : mount.stiffness) spring = random.uniform(0.5, 1.5) * stiffness;
    if (k % 2 == 1) mount.stiffness[static_cast<std::size_t>(k)].reset();
    machine.base_mount = mount;
    for (const auto& pose : machine.poses) {
      const Plant plant(machine, kind, {.hydraulics = false}, pose.X_BP);
      ASSERT_TRUE(plant.base().added_inertia.isZero(0.0));
      const auto rest = plant.equilibrium(pose.X_BP);
      const auto linear = plant.linearise(rest.x, rest.input);
      const auto model = dynamics::linear_model(machine, pose.X_BP, kind);
      const int n = model.dof(), still = model.first_of_base(), base = model.base_count();
      ASSERT_EQ(linear.A.rows(), 2 * n);
      std::vector<int> places(static_cast<std::size_t>(n)), rates = places;
      for (int i = 0; i < n; ++i) {
        places[static_cast<std::size_t>(i)] = i < still ? i : still + i;
        rates[static_cast<std::size_t>(i)] = i < still ? still + i : still + base + i;
      }
      MatrixXd S = MatrixXd::Identity(n, n);
      S.topRightCorner(6, base) = model.carried_by_base;
      const MatrixXd M = S.transpose() * model.M * S, K = S.transpose() * model.K * S,
                     C = S.transpose() * model.C * S;
      EXPECT_LE(scaled_error(-M * linear.A(rates, places), K, K), 1e-6) << pose.name;
      EXPECT_LE(scaled_error(-M * linear.A(rates, rates), C, C), 1e-6) << pose.name;
      const MatrixXd per_wrench = linear.B(rates, Eigen::seqN(linear.B.cols() - 6, 6));
      const MatrixXd expected = M.inverse() * S.transpose().leftCols<6>();
      EXPECT_LE((per_wrench - expected).norm(), 1e-7 * expected.norm());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, OnAMount,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

/// Valves shut, seals tight: each leg is the spring β (A²/V_1 + e²A²/V_2), which for the equivalent
/// cylinder at mid stroke is the published k_h (Eq. 16), in series with its gimbals.
void expect_modes_of_oil_springs(const model::Machine& machine) {
  for (const auto kind : {ModelKind::rigid, ModelKind::guide}) {
    const Plant plant(machine, kind, {.friction = simulation::Friction::none});
    const auto found = undamped_frequencies(plant, machine.neutral());
    const auto model = dynamics::linear_model(machine, machine.neutral(), kind);
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(MatrixXd(model.K),
                                                                   MatrixXd(model.M));
    ASSERT_EQ(found.size(), model.dof());
    for (int k = 0; k < model.dof(); ++k) {
      const double expected = std::sqrt(modes.eigenvalues()[k]);
      EXPECT_NEAR(found[k], expected, 1e-5 * expected) << k;
    }
  }
}

TEST(BlockedCylinders, VibrateAtTheFrequenciesOfTheOilSprings) {
  auto machine = published_machine();
  machine.gravity = {0.0, 0.0, -9.80665};
  machine.damping.modal_ratio = 0.0;
  for (auto& leg : machine.legs) leg.guide_sleeve.stiffness *= 40.0;  // far from buckling
  block_cylinders(machine);
  expect_modes_of_oil_springs(machine);
}

TEST(BlockedCylinders, VibrateMoreSlowlyOnGimbalsThatGiveWay) {
  auto machine = published_machine();
  machine.gravity = {0.0, 0.0, -9.80665};
  machine.damping.modal_ratio = 0.0;
  for (auto& leg : machine.legs) leg.guide_sleeve.stiffness *= 40.0;
  block_cylinders(machine);
  for (const double softest : {0.4, 3.1}) {
    for (int i = 0; i < 5; ++i)  // the sixth stays rigid
      machine.legs[i].gimbal_stiffness = (softest + 0.9 * i) * 3.85353e6;
    expect_modes_of_oil_springs(machine);
  }
}

TEST(MovingPlant, LinearisationFollowsSmallChanges) {
  Random random(90);
  auto machine = published_machine();
  machine.gravity = {0.0, 0.0, -9.80665};
  machine.hydraulics.supply.pump_flow = 2.3e-3;
  machine.legs[2].hydraulics.friction.bristles = model::LuGreBristles{3e7, 1e3};
  machine.legs[1].gimbal_stiffness = 2.9e6;
  machine.legs[4].gimbal_stiffness = 1.7e7;
  const Plant plant(machine, ModelKind::rigid);
  const auto& layout = plant.layout();
  auto rest = plant.equilibrium(machine.neutral());
  for (int k = layout.velocity(); k < layout.pressures; ++k)
    rest.x[k] = random.uniform(-0.05, 0.05);
  for (int i = 0; i < 6; ++i) rest.input.command[i] += random.uniform(-0.2, 0.2);
  const auto linear = plant.linearise(rest.x, rest.input);
  VectorXd change(layout.tangent());
  const VectorXd scales = tangent_scales(plant);
  for (int k = 0; k < change.size(); ++k) change[k] = 1e-6 * scales[k] * random.uniform(-1.0, 1.0);
  VectorXd high(layout.size), low(layout.size), rate_high(layout.size), rate_low(layout.size);
  plant.displace(rest.x.data(), change.data(), high.data());
  plant.displace(rest.x.data(), VectorXd(-change).data(), low.data());
  ASSERT_TRUE(plant.derivative(0.0, high.data(), rest.input, rate_high.data()));
  ASSERT_TRUE(plant.derivative(0.0, low.data(), rest.input, rate_low.data()));
  const VectorXd expected = linear.A * change;
  const VectorXd found = 0.5 * (rate_high - rate_low);
  for (int k = 7; k < layout.size; ++k)
    EXPECT_NEAR(found[k], expected[k - 1],
                1e-5 * linear.A.row(k - 1).cwiseAbs().dot(change.cwiseAbs()) + 1e-12)
        << plant.state_names()[k];
}

TEST(Names, StandForEveryNumber) {
  auto machine = published_machine();
  machine.hydraulics.supply.pump_flow = 1e-3;
  machine.legs[5].hydraulics.friction.bristles = model::LuGreBristles{3e7, 1e3};
  const Plant plant(machine, ModelKind::guide);
  const auto& layout = plant.layout();
  EXPECT_EQ(layout.size, 7 + 12 + 18 + 12 + 12 + 1 + 6);
  const auto names = plant.state_names();
  ASSERT_EQ(static_cast<int>(names.size()), layout.size);
  EXPECT_EQ(plant.state_units().size(), names.size());
  EXPECT_EQ(names[layout.cap(2)], "leg3.p_cap");
  EXPECT_EQ(names[layout.rod(5)], "leg6.p_rod");
  EXPECT_EQ(names[layout.spool(1)], "leg2.spool");
  EXPECT_EQ(names[layout.supply], "p_supply");
  EXPECT_EQ(names[layout.velocity() + 6], "leg1.phi1_rate");
  EXPECT_EQ(static_cast<int>(plant.tangent_names().size()), layout.tangent());
  EXPECT_EQ(plant.tangent_names()[4], "ry");
  const auto rest = plant.equilibrium(machine.neutral());
  EXPECT_EQ(plant.linearise(rest.x, rest.input).C.rows(),
            static_cast<int>(plant.linear_output_names().size()));
}

}  // namespace
}  // namespace hydrapod::test
