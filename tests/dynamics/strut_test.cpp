/// Plain struts: stiffness under gravity by hand, the same modes as cylinders without mass, the
/// same accelerations as MuJoCo's tendons.

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <Eigen/Dense>
#include <memory>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/exchange/exchange.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/simulation/plant.hpp"
#include "support/other_legs.hpp"
#include "support/run_program.hpp"

namespace hydrapod {
namespace {

using dynamics::ModelKind;
using spatial::Matrix3;
using spatial::Matrix6;
using spatial::Vector3;
using spatial::Vector6;

model::Machine strut_machine() { return test::machine_of(test::strut_file); }

Matrix3 cross_matrix(const Vector3& r) {
  Matrix3 S;
  S << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  return S;
}

/// Second derivative of Σ U(l) − m g·C by the platform's motion about its mass centre: six springs
/// with the tensions f that carry the weight,
///     Σ k w wᵀ + f/l Aᵀ (1 − n nᵀ) A + f (½ (n rᵀ + r nᵀ) − n·r) of the rotations,
/// w = (n, r × n), A = (1, −r×).
Matrix6 stiffness_by_hand(const model::Machine& machine, const spatial::Pose& X_BP, double k) {
  const Vector3 C = X_BP * machine.platform.mass_center;
  Matrix6 W;
  std::array<Vector3, 6> n, r;
  Vector6 l;
  for (int i = 0; i < 6; ++i) {
    const auto& leg = machine.legs[static_cast<std::size_t>(i)];
    const Vector3 a = X_BP * leg.platform_joint, L = a - leg.base_joint;
    const auto at = static_cast<std::size_t>(i);
    l[i] = L.norm();
    n[at] = L / l[i];
    r[at] = a - C;
    W.col(i) << n[at], r[at].cross(n[at]);
  }
  Vector6 weight = Vector6::Zero();
  weight.head<3>() = machine.platform.mass * machine.gravity;
  const Vector6 f = W.fullPivLu().solve(weight);
  Matrix6 K = Matrix6::Zero();
  for (int i = 0; i < 6; ++i) {
    const auto at = static_cast<std::size_t>(i);
    Eigen::Matrix<double, 3, 6> A;
    A << Matrix3::Identity(), -cross_matrix(r[at]);
    const Matrix3 across = Matrix3::Identity() - n[at] * n[at].transpose();
    K += k * W.col(i) * W.col(i).transpose() + f[i] / l[i] * A.transpose() * across * A;
    K.bottomRightCorner<3, 3>() +=
        f[i] * (0.5 * (n[at] * r[at].transpose() + r[at] * n[at].transpose()) -
                n[at].dot(r[at]) * Matrix3::Identity());
  }
  return K;
}

TEST(Struts, HaveTheStiffnessOfSixSpringsUnderTheWeight) {
  auto machine = strut_machine();
  constexpr double k = 17.3e6, k_j = 61.7e6, rounding = 1e-12;
  for (const bool gimbals : {false, true})
    for (const double g : {0.0, 9.81}) {
      for (auto& leg : machine.legs)
        leg.gimbal_stiffness = gimbals ? std::optional(k_j) : std::nullopt;
      machine.gravity = {0.7 * (g > 0.0), 0.0, -g};
      const Matrix6 K =
          stiffness_by_hand(machine, machine.neutral(), gimbals ? k * k_j / (k + k_j) : k);
      const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::rigid);
      EXPECT_LT((Matrix6(model.K) - K).norm(), rounding * K.norm()) << gimbals << g;
      EXPECT_EQ(model.dof(), 6);
      Matrix6 M = Matrix6::Zero();
      const Matrix3 R = machine.neutral().R_BP;
      M.diagonal().head<3>().setConstant(1387.3);
      M.bottomRightCorner<3, 3>() = R * machine.platform.inertia * R.transpose();
      EXPECT_LT((Matrix6(model.M) - M).norm(), rounding * M.norm());
    }
}

/// Also on a base with a mount and with a payload that swings.
TEST(Struts, HaveTheModesOfCylindersWithoutMass) {
  auto struts = strut_machine();
  struts.base_mount = model::BaseMount{.mass = 713.0, .inertia = {55.1, 47.3, 39.7}};
  struts.base_mount->stiffness[2] = 211e6;
  struts.base_mount->stiffness[3] = 97e6;
  struts.payload_modes = {{.name = "cabin",
                           .frequency = 6.3,
                           .mass = 210.7,
                           .position = {0.1, 0.2, 0.9},
                           .direction = {1, 0.3, 0}}};
  auto cylinders = struts;
  for (auto& leg : cylinders.legs) {
    leg.oil_spring = {.stiffness = leg.strut->stiffness, .damping = leg.strut->damping};
    leg.strut.reset();
    leg.rod.length = 0.83;
    leg.guide_sleeve = {.position = 0.9, .stiffness = 4e6};
  }
  const auto& X_BP = struts.poses[1].X_BP;
  const auto a = dynamics::linear_model(struts, X_BP, ModelKind::rigid);
  const auto b = dynamics::linear_model(cylinders, X_BP, ModelKind::rigid);
  const auto modes = modal::normal_modes(a), others = modal::normal_modes(b);
  ASSERT_EQ(modes.size(), 9);
  for (int k = 0; k < modes.size(); ++k)
    EXPECT_NEAR(modes.omega(k), others.omega(k), 1e-9 * others.omega(k));
  EXPECT_LT((a.C - b.C).norm(), 1e-9 * b.C.norm());
}

TEST(Struts, HaveTheRigidModelAlone) {
  const auto machine = strut_machine();
  for (const auto kind : {ModelKind::guide, ModelKind::full}) {
    EXPECT_THROW(dynamics::linear_model(machine, machine.neutral(), kind), std::invalid_argument);
    EXPECT_THROW(dynamics::NonlinearModel(machine, kind), std::invalid_argument);
  }
}

/// Where the platform is displaced by centimetres and released, its acceleration is that of six
/// tendons in MuJoCo.
TEST(Struts, AccelerateThePlatformAsTendonsInMujoco) {
  const auto machine = strut_machine();
  const auto file = exchange::multibody_file(machine, machine.neutral(), ModelKind::rigid,
                                             exchange::MultibodyFormat::mjcf);
  const test::TemporaryFolder folder;
  test::write_text(folder / "struts.xml", file.text);
  std::array<char, 1000> error{};
  const std::unique_ptr<mjModel, decltype(&mj_deleteModel)> model(
      mj_loadXML((folder / "struts.xml").string().c_str(), nullptr, error.data(), error.size()),
      &mj_deleteModel);
  ASSERT_TRUE(model) << error.data();
  ASSERT_EQ(model->nv, 6);
  const std::unique_ptr<mjData, decltype(&mj_deleteData)> data(mj_makeData(model.get()),
                                                               &mj_deleteData);
  const simulation::Plant plant(machine, ModelKind::rigid, {.hydraulics = false});
  Eigen::VectorXd change = Eigen::VectorXd::Zero(plant.layout().tangent());
  for (const bool moved : {false, true}) {
    if (moved) change.head<6>() << 0.031, -0.017, 0.023, 0.04, -0.03, 0.05;
    const Eigen::VectorXd rest = plant.equilibrium(machine.neutral()).x;
    Eigen::VectorXd x = rest;
    plant.displace(rest.data(), change.data(), x.data());
    const auto out = plant.outputs(x.data(), {});
    const Eigen::Quaterniond q(out.X_BP.R_BP);
    Eigen::Map<Vector3>(data->qpos) = out.X_BP.p_BP;
    data->qpos[3] = q.w();
    Eigen::Map<Vector3>(data->qpos + 4) = q.vec();
    mj_forward(model.get(), data.get());
    const Eigen::Map<Vector6> qacc(data->qacc);
    const Vector3 alpha = out.X_BP.R_BP * qacc.tail<3>();
    const Vector3 of_C = qacc.head<3>() + alpha.cross(out.p_BC - out.X_BP.p_BP);
    const double size = moved ? out.acceleration.norm() : 9.81;
    EXPECT_LT((of_C - out.acceleration.head<3>()).norm(), 1e-9 * size) << moved;
    EXPECT_LT((alpha - out.acceleration.tail<3>()).norm(), 1e-9 * size) << moved;
  }
}

}  // namespace
}  // namespace hydrapod
