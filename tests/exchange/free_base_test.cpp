/// Superelements whose base is free: held, on a mount and in flight.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "hydrapod/exchange/exchange.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "support/massless_legs.hpp"
#include "support/payload_modes.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using Eigen::Index;
using Eigen::MatrixXd;
using exchange::superelement;
using spatial::Vector3;

model::Machine ugly_machine(unsigned seed, Gravity gravity) {
  Random random(seed);
  auto machine = random_machine(random, {.gravity = gravity});
  machine.damping.modal_ratio = 0.0173;
  return machine;
}

double difference(const MatrixXd& a, const MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

/// Platform and what comes behind the base.
std::vector<Index> without_base(Index size) {
  std::vector<Index> kept;
  for (Index i = 0; i < size; ++i)
    if (i < 6 || i >= 12) kept.push_back(i);
  return kept;
}

TEST(FreeBase, HeldIsTheSuperelementOfAMachineWithoutAMount) {
  for (const auto kind : {ModelKind::rigid, ModelKind::guide, ModelKind::full})
    for (const auto gravity : {Gravity::none, Gravity::down}) {
      const auto machine = ugly_machine(41, gravity);
      const Vector3 Q(0.13, -0.07, 0.21);
      const auto still = superelement(machine, machine.poses[1].X_BP, {.kind = kind, .p_PQ = Q});
      const auto free = superelement(machine, machine.poses[1].X_BP,
                                     {.kind = kind, .p_PQ = Q, .free_base = true});
      ASSERT_EQ(free.M.rows(), still.M.rows() + 6);
      EXPECT_EQ(free.coordinates[6].name, "base.x");
      EXPECT_TRUE(free.is_base_free);
      const auto kept = without_base(free.M.rows());
      EXPECT_LT(difference(free.M(kept, kept), still.M), 1e-12);
      EXPECT_LT(difference(free.K(kept, kept), still.K), 1e-12);
      EXPECT_LT(difference(free.C(kept, kept), still.C), 1e-12);
    }
}

/// Moved as one body it has neither springs nor dampers, and weighs what its parts weigh.
TEST(FreeBase, AsOneBodyHasTheMassOfAllItsParts) {
  const auto machine = ugly_machine(43, Gravity::none);
  const Vector3 Q(0.31, 0.02, -0.11);
  const auto& X_BP = machine.poses[1].X_BP;
  const auto free =
      superelement(machine, X_BP, {.kind = ModelKind::guide, .p_PQ = Q, .free_base = true});
  MatrixXd rigid = MatrixXd::Zero(free.M.rows(), 6);
  rigid.topRows<6>().setIdentity();
  rigid.block<3, 3>(0, 3) = -spatial::skew(X_BP * Q);
  rigid.middleRows<6>(6).setIdentity();
  EXPECT_LT((free.K * rigid).cwiseAbs().maxCoeff(), 1e-12 * free.K.cwiseAbs().maxCoeff());
  EXPECT_LT((free.C * rigid).cwiseAbs().maxCoeff(), 1e-12 * free.C.cwiseAbs().maxCoeff());
  const MatrixXd M = rigid.transpose() * free.M * rigid;

  double mass = machine.platform.mass;
  Vector3 moment = mass * (X_BP * machine.platform.mass_center);
  for (const auto& leg : machine.legs) {
    const Vector3 end = X_BP * leg.platform_joint, along = end - leg.base_joint;
    const Vector3 n = along.normalized();
    const double tube = leg.cylinder_case.mass, rod = leg.rod.mass;
    mass += tube + rod;
    moment += tube * (leg.base_joint + leg.cylinder_case.mass_center * n) +
              rod * (end - (leg.rod.length - leg.rod.mass_center) * n);
  }
  EXPECT_NEAR(M(0, 0), mass, 1e-12 * mass);
  EXPECT_NEAR(M(2, 2), mass, 1e-12 * mass);
  const Vector3 found(M(1, 5), M(2, 3), M(0, 4));  // m (x, y, z) of m −skew(p)
  EXPECT_LT((found - moment).norm(), 1e-12 * moment.norm());
}

/// Mount and mass put beside it are those of the machine file.
TEST(FreeBase, OnAMountHasTheFrequenciesOfTheMachineOnIt) {
  for (const bool payload : {false, true}) {
    auto machine = ugly_machine(47, Gravity::down);
    Random random(5);
    if (payload) put_modes_on(machine, 2, random);
    auto& mount = machine.base_mount.emplace();
    mount.mass = 731.0;
    mount.inertia = {413.0, 377.0, 619.0};
    mount.stiffness = {3.1e7, 2.7e7, 8.3e7, 1.9e7, 2.3e7, 1.1e7};
    const auto& X_BP = machine.poses[1].X_BP;
    auto free = superelement(machine, X_BP, {.kind = ModelKind::guide, .free_base = true});
    for (Index i = 0; i < 6; ++i) {
      free.K(6 + i, 6 + i) += *mount.stiffness[static_cast<std::size_t>(i)];
      free.M(6 + i, 6 + i) += i < 3 ? mount.mass : mount.inertia[i - 3];
    }
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(free.K, free.M);
    const auto expected =
        modal::normal_modes(dynamics::linear_model(machine, X_BP, ModelKind::guide));
    ASSERT_EQ(solver.eigenvalues().size(), expected.omega2.size());
    for (Index k = 0; k < expected.omega2.size(); ++k)
      EXPECT_NEAR(solver.eigenvalues()[k], expected.omega2[k], 1e-11 * expected.omega2[k]) << k;
  }
}

/// Neither legs nor base have inertia: the matrices are those of springs alone.
TEST(FreeBase, OfMasslessLegsHasNoMassOfItsOwn) {
  auto machine = ugly_machine(53, Gravity::none);
  scale_legs_inertia(machine, 0.0);
  for (auto& leg : machine.legs) leg.gimbal_cross_inertia = 0.0;
  const auto free =
      superelement(machine, machine.neutral(), {.kind = ModelKind::rigid, .free_base = true});
  EXPECT_LT(free.M.bottomRightCorner(6, 6).cwiseAbs().maxCoeff(),
            1e-12 * free.M.cwiseAbs().maxCoeff());
  EXPECT_GT(free.K(6, 6), 0.0);
}

}  // namespace
}  // namespace hydrapod::test
