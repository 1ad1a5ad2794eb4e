/// A base that gives way, and gimbals that do: against closed forms and the unreduced system.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <complex>

#include "hydrapod/hydraulics/servo_axis.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "support/calibration_machine.hpp"
#include "support/massless_legs.hpp"
#include "support/published_machine.hpp"
#include "support/unreduced_mount.hpp"

namespace hydrapod::dynamics {
namespace {

using model::BaseMount;

constexpr double huge = 1e13;
constexpr std::array all_kinds{ModelKind::rigid, ModelKind::guide, ModelKind::full};

model::Machine machine_of(int seed, bool gravity) {
  test::Random random(static_cast<std::uint64_t>(seed));
  auto machine = test::machine_file(test::random_machine_text(random, gravity)).machine;
  for (auto& leg : machine.legs) leg.piston_ring = model::PistonRing{3.7e6, 0.0};
  return machine;
}

Eigen::VectorXd frequencies(const model::Machine& machine, ModelKind kind) {
  const auto modes = modal::normal_modes(linear_model(machine, machine.poses.back().X_BP, kind));
  return modes.omega2.cwiseSqrt();
}

BaseMount mount_of(double translation, double rotation) {
  BaseMount mount;
  for (std::size_t k = 0; k < 6; ++k) mount.stiffness[k] = k < 3 ? translation : rotation;
  return mount;
}

TEST(BaseMount, WithoutSpringsChangesNothing) {
  for (const auto kind : all_kinds) {
    auto machine = machine_of(3, true);
    const auto still = frequencies(machine, kind);
    machine.base_mount = BaseMount{.mass = 713.0};
    EXPECT_LT((frequencies(machine, kind) - still).cwiseQuotient(still).cwiseAbs().maxCoeff(),
              1e-10);
  }
}

/// The base's own modes lie far above.
TEST(BaseMount, ThatIsNearlyRigidChangesNothing) {
  for (const auto kind : all_kinds)
    for (const double inertia : {0.0, 1.0}) {
      auto machine = machine_of(3, true);
      const auto still = frequencies(machine, kind);
      machine.base_mount = mount_of(1e17, 1e17);
      machine.base_mount->mass = 713.0 * inertia;
      machine.base_mount->inertia = inertia * Vector3(310.0, 290.0, 510.0);
      const auto moving = frequencies(machine, kind);
      ASSERT_EQ(moving.size(), still.size() + 6);
      EXPECT_LT((moving.head(still.size()) - still).cwiseQuotient(still).cwiseAbs().maxCoeff(),
                1e-9);
      EXPECT_GT(moving[still.size()], 1e6);
    }
}

/// With legs like steel everything moves as one body on three springs: ω² = k/Σm, where every mass
/// of platform, legs and base counts, wherever it is.
TEST(BaseMount, CarriesTheWholeMachineAsOneBodyWhenTheLegsAreRigid) {
  for (const auto kind : all_kinds) {
    auto machine = machine_of(5, false);
    double mass = machine.platform.mass + 411.0;
    for (auto& leg : machine.legs) {
      mass += leg.cylinder_case.mass + leg.rod.mass;
      leg.oil_spring.stiffness = huge;
      leg.guide_sleeve.stiffness = huge;
      leg.piston_ring->stiffness = huge;
      leg.added_axial_inertia = 0.0;
    }
    BaseMount mount{.mass = 411.0};
    mount.stiffness = {2.3e5, 3.1e5, 4.7e5, {}, {}, {}};
    machine.base_mount = mount;
    const auto omega = frequencies(machine, kind);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(omega[k], std::sqrt(*mount.stiffness[static_cast<std::size_t>(k)] / mass),
                  1e-5 * omega[k]);
  }
}

/// Rotating about the base's origin as one body: ω² = k/I_zz with Steiner's part of every body.
TEST(BaseMount, TurnsTheWholeMachineAsOneBody) {
  auto machine = machine_of(7, false);
  const auto& X_BP = machine.poses.back().X_BP;
  const auto geometry = kinematics::inverse_kinematics(machine, X_BP);
  BaseMount mount{.inertia = {0.0, 0.0, 93.0}};
  mount.stiffness[5] = 6.1e4;
  const spatial::Vector3 C = kinematics::mass_center(machine, X_BP);
  const spatial::Vector3 z = spatial::Vector3::UnitZ();
  double inertia = 93.0 + machine.platform.mass * C.head<2>().squaredNorm() +
                   z.dot(X_BP.R_BP * machine.platform.inertia * X_BP.R_BP.transpose() * z);
  for (std::size_t i = 0; i < 6; ++i) {
    auto& leg = machine.legs[i];
    const spatial::Vector3 n = geometry[i].n;
    const double across = 1.0 - n.z() * n.z();
    const double l_m = geometry[i].length - leg.rod.length;
    const spatial::Vector3 c = leg.base_joint + leg.cylinder_case.mass_center * n;
    const spatial::Vector3 r = leg.base_joint + (l_m + leg.rod.mass_center) * n;
    inertia += leg.cylinder_case.mass * c.head<2>().squaredNorm() +
               leg.cylinder_case.transverse_inertia * across +
               leg.rod.mass * r.head<2>().squaredNorm() + leg.rod.transverse_inertia * across;
    leg.oil_spring.stiffness = huge;
    leg.guide_sleeve.stiffness = huge;
    leg.piston_ring->stiffness = huge;
    leg.added_axial_inertia = 0.0;
  }
  machine.base_mount = mount;
  EXPECT_NEAR(frequencies(machine, ModelKind::full)[0], std::sqrt(6.1e4 / inertia),
              1e-5 * std::sqrt(6.1e4 / inertia));
}

Eigen::VectorXd unreduced(const model::Machine& machine, const spatial::Pose& X_BP) {
  const auto system = test::unreduced_mount(machine, X_BP);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(system.K, system.M);
  return solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
}

/// Where nothing on the base has inertia it is condensed: the limit of a little inertia.
TEST(BaseMount, IsCondensedWhereNothingOnItHasInertia) {
  auto machine = machine_of(11, false);
  const double k = 0.6 * *machine.legs[0].oil_spring.stiffness;
  machine.base_mount = mount_of(k, 0.7 * k);
  test::scale_legs_inertia(machine, 1e-9);
  const auto limit = frequencies(machine, ModelKind::rigid);
  ASSERT_EQ(limit.size(), 12);
  test::scale_legs_inertia(machine, 0.0);
  EXPECT_TRUE(base_directions(machine).empty());
  const auto condensed = frequencies(machine, ModelKind::rigid);
  ASSERT_EQ(condensed.size(), 6);
  auto still = machine;
  still.base_mount.reset();
  EXPECT_GT(frequencies(still, ModelKind::rigid)[0], 1.1 * condensed[0]);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(limit[i], condensed[i], 1e-8 * condensed[i]) << i;
}

/// Springs in series: what a load on the platform moves is what it moves on the legs alone, and
/// what the base gives.
TEST(BaseMount, AddsItsComplianceToThatOfTheLegs) {
  for (const bool condensed : {false, true}) {
    const auto kind = condensed ? ModelKind::rigid : ModelKind::guide;
    auto machine = machine_of(23, false);
    if (condensed) test::scale_legs_inertia(machine, 0.0);
    const auto& X_BP = machine.poses.back().X_BP;
    const auto still = linear_model(machine, X_BP, kind);
    const double k = 0.31 * *machine.legs[0].oil_spring.stiffness;
    auto mount = mount_of(k, 0.7 * k);
    mount.stiffness[1].reset();
    machine.base_mount = mount;
    const auto model = linear_model(machine, X_BP, kind);
    EXPECT_EQ(model.base_count(), condensed ? 0 : 5);
    Matrix6 T = Matrix6::Identity();
    T.topRightCorner<3, 3>() = -spatial::skew(model.p_BC);
    Vector6 give;
    give << 1.0 / k, 0.0, 1.0 / k, Vector3::Constant(1.0 / (0.7 * k));
    const Matrix6 of_legs = still.K.inverse().topLeftCorner<6, 6>();
    const Matrix6 expected = of_legs + T * give.asDiagonal() * T.transpose();
    const Matrix6 found = model.K.inverse().topLeftCorner<6, 6>();
    EXPECT_LT((found - expected).norm(), 1e-9 * expected.norm());
  }
}

double scaled_error(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  const Eigen::VectorXd d = B.diagonal().cwiseSqrt().cwiseInverse();
  return (d.asDiagonal() * (A - B) * d.asDiagonal()).cwiseAbs().maxCoeff();
}

/// Two bodies per leg between two moving ends know nothing of momenta and leg frames.
TEST(BaseWithCoordinates, HasTheMatricesOfTheTwelveCoordinates) {
  for (const double base_mass : {0.0, 1e-3, 0.5, 40.0})
    for (const double times : {0.05, 4.0}) {
      auto machine = machine_of(11, false);
      const double k = times * *machine.legs[0].oil_spring.stiffness;
      auto mount = mount_of(4.0 * k, 1.7 * k);
      mount.mass = base_mass * machine.platform.mass;
      mount.inertia = base_mass * Vector3(0.31, 0.47, 0.71);
      machine.base_mount = mount;
      const auto& X_BP = machine.poses.back().X_BP;
      const auto model = linear_model(machine, X_BP, ModelKind::rigid);
      const auto expected = test::unreduced_mount(machine, X_BP);
      ASSERT_EQ(model.dof(), 12);
      EXPECT_LT(scaled_error(model.M, expected.M), 1e-12);
      EXPECT_LT(scaled_error(model.K, expected.K), 1e-12);
      EXPECT_LT((model.against_base - expected.against_base).norm(), 1e-14);
      const auto found = frequencies(machine, ModelKind::rigid);
      const auto exact = unreduced(machine, X_BP);
      for (int i = 0; i < 12; ++i) EXPECT_NEAR(found[i], exact[i], 1e-9 * exact[i]) << i;
    }
}

TEST(BaseWithCoordinates, HasThemWhereItsMountHasSprings) {
  auto machine = machine_of(29, true);
  auto mount = mount_of(3.1e6, 2.3e6);
  mount.mass = 217.0;
  machine.base_mount = mount;
  const auto all = linear_model(machine, machine.neutral(), ModelKind::full);
  for (const std::size_t rigid : {1U, 3U, 5U}) mount.stiffness[rigid].reset();
  machine.base_mount = mount;
  EXPECT_EQ(degrees_of_freedom(machine, ModelKind::full), 33);
  const auto some = linear_model(machine, machine.neutral(), ModelKind::full);
  EXPECT_EQ(coordinate_names(some.kind, some.base_directions).at(32), "base.ry");
  std::vector<int> kept;
  for (int k = 0; k < 35; ++k)
    if (k != 31 && k != 33) kept.push_back(k);
  EXPECT_LT(scaled_error(some.M, all.M(kept, kept)), 1e-13);
  EXPECT_LT((some.K - all.K(kept, kept)).norm(), 1e-13 * all.K.norm());
  const auto modes = modal::normal_modes(some);
  const ModelMatrix one = modes.shapes.transpose() * some.M * modes.shapes;
  EXPECT_LT((one - ModelMatrix::Identity(33, 33)).norm(), 1e-11);
}

/// The still machine's matrices are those of the platform and the legs on the moving base.
TEST(BaseWithCoordinates, LeavesThoseOfTheStillMachineAsTheyAre) {
  for (const auto kind : all_kinds) {
    auto machine = machine_of(31, true);
    const auto still = linear_model(machine, machine.poses.back().X_BP, kind);
    machine.base_mount = mount_of(1.3e6, 0.9e6);
    machine.base_mount->mass = 90.0;
    const auto moving = linear_model(machine, machine.poses.back().X_BP, kind);
    const int n = still.dof();
    EXPECT_TRUE(moving.M.topLeftCorner(n, n) == still.M);
    EXPECT_TRUE(moving.K.topLeftCorner(n, n) == still.K);
    EXPECT_TRUE(moving.C.topLeftCorner(n, n) == still.C);
  }
}

/// Platform and base on two springs: m m_b ω⁴ − (m (k + k_m) + m_b k) ω² + k k_m = 0.
TEST(BaseWithCoordinates, AndPlatformAreTwoMassesAlongZ) {
  auto machine = test::published_machine();
  machine.gravity.setZero();
  test::scale_legs_inertia(machine, 1e-9);
  const double m = machine.platform.mass, m_b = 20000.0, k_m = 1e8;
  const double k = linear_model(machine, machine.neutral(), ModelKind::rigid).K(2, 2);
  BaseMount mount = mount_of(k_m, 1e8);
  mount.mass = m_b;
  mount.inertia.setConstant(1e4);
  machine.base_mount = mount;
  const double b = m * (k + k_m) + m_b * k, c = m * m_b * k * k_m;
  const auto omega = frequencies(machine, ModelKind::rigid);
  for (const double sign : {-1.0, 1.0}) {
    const double expected = std::sqrt((b + sign * std::sqrt(b * b - 4.0 * c)) / (2.0 * m * m_b));
    EXPECT_LT((omega.array() - expected).abs().minCoeff(), 1e-7 * expected);
  }
}

/// Rayleigh: the shares of a mode are the sensitivities of its ω² to mount and base, exactly.
TEST(BaseWithCoordinates, EnergySharesAreSensitivities) {
  for (const bool gravity : {false, true})
    for (const auto kind : all_kinds) {
      auto machine = machine_of(37, gravity);
      const double k = 0.9 * *machine.legs[0].oil_spring.stiffness, h = 1e-5;
      auto mount = mount_of(k, 0.6 * k);
      mount.mass = 0.4 * machine.platform.mass;
      mount.inertia = 0.3 * machine.platform.inertia.diagonal();
      const auto omega2 = [&](double stiffness, double inertia) {
        auto changed = machine;
        changed.base_mount = mount;
        for (auto& spring : changed.base_mount->stiffness) *spring *= stiffness;
        changed.base_mount->mass *= inertia;
        changed.base_mount->inertia *= inertia;
        return Eigen::VectorXd(
            modal::normal_modes(linear_model(changed, machine.neutral(), kind)).omega2);
      };
      machine.base_mount = mount;
      const auto model = linear_model(machine, machine.neutral(), kind);
      const auto modes = modal::normal_modes(model);
      const auto shares = modal::energy_shares(model, modes.shapes);
      const Eigen::VectorXd by_spring = (omega2(1.0 + h, 1.0) - omega2(1.0 - h, 1.0)) / (2.0 * h);
      const Eigen::VectorXd by_inertia = (omega2(1.0, 1.0 + h) - omega2(1.0, 1.0 - h)) / (2.0 * h);
      double most_of_base = 0.0, most_of_mount = 0.0;
      for (int i = 0; i < modes.size(); ++i) {
        const auto& e = shares[static_cast<std::size_t>(i)];
        EXPECT_NEAR(e.platform.sum() + e.legs.sum() + e.base.sum(), 1.0, 1e-12);
        EXPECT_NEAR(e.oil.sum() + e.guide_sleeve.sum() + e.piston_ring.sum() + e.base_mount, 1.0,
                    1e-12);
        // ω² = (elastic + preload) over kinetic energy
        EXPECT_NEAR(e.base_mount / (1.0 + e.preload), by_spring[i] / modes.omega2[i], 3e-6) << i;
        EXPECT_NEAR(e.base.sum(), -by_inertia[i] / modes.omega2[i], 3e-6) << i;
        most_of_base = std::max(most_of_base, e.base.sum());
        most_of_mount = std::max(most_of_mount, e.base_mount);
      }
      EXPECT_GT(most_of_base, 0.3);
      EXPECT_GT(most_of_mount, 0.3);
    }
}

TEST(BaseMount, HoldsItsShareOfTheElasticEnergy) {
  for (const bool gravity : {false, true}) {
    auto machine = machine_of(13, gravity);
    const double k = 4.0 * *machine.legs[0].oil_spring.stiffness;
    machine.base_mount = mount_of(k, k);
    const auto model = linear_model(machine, machine.neutral(), ModelKind::guide);
    const auto modes = modal::normal_modes(model);
    const auto shares = modal::energy_shares(model, modes.shapes);
    double largest = 0.0;
    for (int m = 0; m < modes.size(); ++m) {
      const auto& e = shares[static_cast<std::size_t>(m)];
      EXPECT_NEAR(e.oil.sum() + e.guide_sleeve.sum() + e.piston_ring.sum() + e.base_mount, 1.0,
                  1e-12);
      largest = std::max(largest, e.base_mount);
    }
    EXPECT_GT(largest, 0.02);
  }
}

/// Rayleigh: d ln ω² / d ln k is the share of the energy in k, when all else is linear.
TEST(BaseMount, EnergyShareIsTheSensitivityOfTheFrequency) {
  auto machine = machine_of(17, false);
  test::scale_legs_inertia(machine, 0.0);  // it is condensed
  const double k = 4.0 * *machine.legs[0].oil_spring.stiffness, h = 1e-5;
  machine.base_mount = mount_of(k, k);
  const auto model = linear_model(machine, machine.neutral(), ModelKind::rigid);
  const auto modes = modal::normal_modes(model);
  const auto shares = modal::energy_shares(model, modes.shapes);
  const auto omega2_with = [&](double factor) {
    auto changed = machine;
    changed.base_mount = mount_of(k * factor, k * factor);
    return modal::normal_modes(linear_model(changed, machine.neutral(), ModelKind::rigid)).omega2;
  };
  const auto above = omega2_with(1.0 + h), below = omega2_with(1.0 - h);
  for (int m = 0; m < 6; ++m)
    EXPECT_NEAR(shares[static_cast<std::size_t>(m)].base_mount,
                (above[m] - below[m]) / (2.0 * h * modes.omega2[m]), 1e-7);
}

TEST(GimbalStiffness, IsInSeriesWithTheOil) {
  auto machine = machine_of(19, true);
  auto softer = machine;
  const double k_h = *machine.legs[0].oil_spring.stiffness, k_j = 2.7 * k_h;
  for (auto& leg : machine.legs) leg.gimbal_stiffness = k_j;
  for (auto& leg : softer.legs) leg.oil_spring.stiffness = 1.0 / (1.0 / k_h + 1.0 / k_j);
  for (const auto kind : all_kinds)
    EXPECT_LT((frequencies(machine, kind) - frequencies(softer, kind)).cwiseAbs().maxCoeff(), 1e-9);
  // the damper sees its share of the motion only: its work per cycle at low frequency
  const auto spring = hydraulics::axial_spring(machine.legs[0], 0.4);
  const std::complex<double> i(0.0, 1.0);
  const double w = 1e-3, c = machine.legs[0].oil_spring.damping;
  const std::complex<double> series = 1.0 / (1.0 / (k_h + i * w * c) + 1.0 / k_j);
  EXPECT_NEAR(spring.damping, series.imag() / w, 1e-9 * spring.damping);
}

/// Seals act between rod and case, as the oil does: gimbals are in series with both, and with seals
/// that hold the rod they alone are left.
TEST(StickStiffness, IsBesideTheOilAndBehindTheGimbals) {
  auto machine = machine_of(19, true);
  auto stiffer = machine;
  const double k_h = *machine.legs[0].oil_spring.stiffness, k_j = 2.7 * k_h, k_b = 0.31 * k_h;
  for (auto& leg : machine.legs) {
    leg.gimbal_stiffness = k_j;
    leg.stick_stiffness = k_b;
  }
  for (auto& leg : stiffer.legs) leg.oil_spring.stiffness = 1.0 / (1.0 / (k_h + k_b) + 1.0 / k_j);
  for (const auto kind : all_kinds)
    EXPECT_LT((frequencies(machine, kind) - frequencies(stiffer, kind)).cwiseAbs().maxCoeff(),
              1e-9);
  auto& leg = machine.legs[0];
  leg.oil_spring.damping = 7.3e3;
  const double w = 1e-3;  // [rad/s]: the damper is weak beside the springs
  const std::complex<double> between(k_h + k_b, w * leg.oil_spring.damping),
      series = between * k_j / (between + k_j);
  const auto spring = hydraulics::axial_spring(leg, 0.4);
  EXPECT_NEAR(spring.stiffness, series.real(), 1e-9 * spring.stiffness);
  EXPECT_NEAR(spring.damping, series.imag() / w, 1e-9 * spring.damping);
  leg.stick_stiffness = 1e9 * k_h;
  EXPECT_NEAR(hydraulics::axial_spring(leg, 0.4).stiffness, k_j, 1e-8 * k_j);
}

}  // namespace
}  // namespace hydrapod::dynamics
