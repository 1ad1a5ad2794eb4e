/// A base that gives way, and gimbals that do: against closed forms and the unreduced system.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <complex>

#include "hydrapod/hydraulics/oil_spring.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "support/calibration_machine.hpp"
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

TEST(BaseMount, ThatIsRigidChangesNothing) {
  for (const auto kind : all_kinds) {
    auto machine = machine_of(3, true);
    const auto still = frequencies(machine, kind);
    machine.base_mount = mount_of(1e22, 1e22);
    EXPECT_LT((frequencies(machine, kind) - still).cwiseQuotient(still).cwiseAbs().maxCoeff(),
              1e-10);
    machine.base_mount = BaseMount{.mass = 713.0};
    EXPECT_LT((frequencies(machine, kind) - still).cwiseQuotient(still).cwiseAbs().maxCoeff(),
              1e-10);
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

/// Mount as stiff as the legs, base of half the platform's mass and its gyration. The reduction
/// gives upper bounds; how good they are is a matter of the base's mass.
TEST(BaseMount, IsCloseToTheUnreducedSystemAndNeverBelowIt) {
  for (const double base_mass : {0.0, 0.05, 0.5}) {
    auto machine = machine_of(11, false);
    const double k = 2.0 * *machine.legs[0].oil_spring.stiffness;
    auto mount = mount_of(4.0 * k, 4.0 * k);
    mount.mass = base_mass * machine.platform.mass;
    mount.inertia.setConstant(base_mass * machine.platform.inertia.trace() / 3.0);
    machine.base_mount = mount;
    const auto exact = unreduced(machine, machine.poses.back().X_BP);
    const auto reduced = frequencies(machine, ModelKind::rigid);
    for (int i = 0; i < 6; ++i) {
      EXPECT_GE(reduced[i], exact[i] * (1.0 - 1e-9)) << i;
      // the lowest modes; the legs' mass is 7 % of the platform's
      if (i < 3) {
        EXPECT_LT(reduced[i], exact[i] * (base_mass < 0.1 ? 1.003 : 1.02)) << i << ' ' << base_mass;
      }
    }
    auto still = machine;
    still.base_mount.reset();
    EXPECT_GT(frequencies(still, ModelKind::rigid)[0], 1.03 * exact[0]);
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
  for (auto& leg : machine.legs)  // the reduction is exact without them
    for (double* inertia : {&leg.cylinder_case.mass, &leg.cylinder_case.transverse_inertia,
                            &leg.rod.mass, &leg.rod.transverse_inertia, &leg.added_axial_inertia})
      *inertia *= 1e-9;
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

}  // namespace
}  // namespace hydrapod::dynamics
