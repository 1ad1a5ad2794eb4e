/// Machines whose rods and cases bend: the nonlinear mechanics against the linear models.

#include <gtest/gtest.h>

#include <cmath>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/dynamics/nonlinear.hpp"
#include "hydrapod/dynamics/statics.hpp"
#include "support/bending_machine.hpp"
#include "support/eigenvalues.hpp"
#include "support/guide_gaps.hpp"

namespace hydrapod::test {
namespace {

using dynamics::leg_on_base;
using dynamics::ModelKind;
using spatial::Vector3;

/// Bending machine whose rods lie on their guides where `contact`.
model::Machine loaded_machine(Random& random, model::FlexibleAxes axes, bool contact) {
  auto machine = bending_machine(random, {.axes = axes, .gravity = Gravity::anywhere});
  if (contact) lay_on_guides(machine);
  return machine;
}

/// A machine at rest in the nonlinear mechanics, on linear oil springs.
struct AtRest {
  dynamics::NonlinearModel mechanics;
  dynamics::StaticEquilibrium rest;
  Eigen::VectorXd y;
  std::array<double, model::leg_count> k_h{}, s{};

  AtRest(const model::Machine& machine, ModelKind kind)
      : mechanics(machine, kind, machine.neutral()),
        rest(mechanics.equilibrium(machine.neutral())),
        y(mechanics.positions()) {
    mechanics.configuration(machine.neutral(), rest.legs, y.data());
    const auto model = dynamics::linear_model(machine, machine.neutral(), kind);
    for (std::size_t i = 0; i < model::leg_count; ++i) {
      k_h[i] = model.legs[i].k_h;
      s[i] = motion(y, Eigen::VectorXd::Zero(mechanics.velocities())).legs[i].s;
    }
  }

  [[nodiscard]] dynamics::Motion motion(const Eigen::VectorXd& at, const Eigen::VectorXd& v) const {
    dynamics::Motion result;
    mechanics.motion(at.data(), v.data(), result);
    return result;
  }
  [[nodiscard]] dynamics::Loads loads(const dynamics::Motion& now) const {
    dynamics::Loads loads;
    for (std::size_t i = 0; i < model::leg_count; ++i)
      loads.axial[static_cast<int>(i)] = -rest.legs[i].oil_force - k_h[i] * (now.legs[i].s - s[i]);
    return loads;
  }
  /// Generalised forces without motion.
  [[nodiscard]] Eigen::VectorXd forces(const Eigen::VectorXd& at) const {
    const auto now = motion(at, Eigen::VectorXd::Zero(mechanics.velocities()));
    Eigen::VectorXd rate(mechanics.velocities());
    mechanics.accelerations(now, loads(now), rate.data());
    return mechanics.mass_matrix(now) * rate;
  }
  /// Rate of the energy at rest with these velocities, without loads.
  [[nodiscard]] double power(const Eigen::VectorXd& v) const {
    Eigen::VectorXd y_rate(y.size()), v_rate(v.size());
    mechanics.rates(y.data(), v.data(), y_rate.data());
    mechanics.accelerations(motion(y, v), {}, v_rate.data());
    const auto energy_at = [&](double t) {
      return mechanics.energies(motion(y + t * y_rate, v + t * v_rate)).total();
    };
    constexpr double h = 1e-6;
    return (energy_at(h) - energy_at(-h)) / (2.0 * h);
  }
  [[nodiscard]] Eigen::VectorXd moved(int k, double h) const {
    Eigen::VectorXd v = Eigen::VectorXd::Zero(mechanics.velocities()), rate(mechanics.positions());
    v[k] = h;
    mechanics.rates(y.data(), v.data(), rate.data());
    return y + rate;
  }
};

TEST(BendingMachine, VibratesInTheNonlinearMechanicsAsInTheLinearModel) {
  Random random(5022);
  for (const bool contact : {false, true})
    for (const auto kind : {ModelKind::guide, ModelKind::full})
      for (const auto axes : {model::FlexibleAxes::gimbal, model::FlexibleAxes::transverse}) {
        const auto machine = loaded_machine(random, axes, contact);
        const AtRest at(machine, kind);
        ASSERT_EQ(at.rest.status, dynamics::StaticsStatus::converged);
        EXPECT_LE(at.forces(at.y).norm(), 1e-8 * machine.platform.mass * machine.gravity.norm());
        // with contact the corner is curved over micrometres of the offset
        const double h = contact ? 2e-8 : 1e-6, tolerance = contact ? 1e-5 : 1e-7;
        const int size = at.mechanics.velocities();
        Eigen::MatrixXd K(size, size);
        for (int k = 0; k < size; ++k)
          K.col(k) = (at.forces(at.moved(k, -h)) - at.forces(at.moved(k, h))) / (2.0 * h);
        K = 0.5 * (K + K.transpose()).eval();
        const auto M = at.mechanics.mass_matrix(at.motion(at.y, Eigen::VectorXd::Zero(size)));
        const auto model = dynamics::linear_model(machine, machine.neutral(), kind);
        const double error =
            worst_frequency_error(omega_squared(M, K), omega_squared(model.M, model.K));
        EXPECT_LE(error, tolerance) << contact << " " << name(kind);
      }
}

TEST(BendingMachine, KeepsItsEnergyInLargeMotions) {
  Random random(314);
  for (const bool contact : {false, true})
    for (const auto kind : {ModelKind::guide, ModelKind::full})
      for (const auto axes : {model::FlexibleAxes::gimbal, model::FlexibleAxes::transverse}) {
        auto machine = loaded_machine(random, axes, contact);
        for (auto& leg : machine.legs) {
          leg.guide_sleeve.damping = 0.0;
          leg.piston_ring->damping = 0.0;
        }
        const AtRest at(machine, kind);
        Eigen::VectorXd v(at.mechanics.velocities());
        for (int k = 0; k < v.size(); ++k) v[k] = random.uniform(-0.3, 0.3);
        const auto now = at.motion(at.y, v);
        const auto energies = at.mechanics.energies(now);
        EXPECT_GT(energies.bending, 0.0);
        const double kinetic = 0.5 * v.dot(at.mechanics.mass_matrix(now) * v);
        EXPECT_NEAR(energies.platform + energies.legs, kinetic, 1e-12 * kinetic);
        EXPECT_NEAR(at.power(v), 0.0, 1e-6 * 1e2 * energies.platform)
            << contact << " " << name(kind);
      }
}

/// What dampers take out is what the energy loses.
TEST(BendingMachine, LosesWhatItsDampersTakeOut) {
  Random random(316);
  for (const auto axes : {model::FlexibleAxes::gimbal, model::FlexibleAxes::transverse}) {
    const auto machine = loaded_machine(random, axes, true);
    const AtRest at(machine, ModelKind::full);
    Eigen::VectorXd v(at.mechanics.velocities());
    for (int k = 0; k < v.size(); ++k) v[k] = random.uniform(-0.3, 0.3);
    const auto now = at.motion(at.y, v);
    const double lost = at.mechanics.dissipation(now);
    EXPECT_GT(lost, 0.0);
    EXPECT_NEAR(at.power(v), -lost,
                1e-6 * std::max(lost, 1e2 * at.mechanics.energies(now).platform));
  }
}

/// The momentum of the legs on a base that moves, from two derivations.
TEST(BendingMachine, HasTheMomentumOfItsBows) {
  Random random(52);
  const auto machine = bending_machine(random, {});
  const auto kind = ModelKind::full;
  const AtRest at(machine, kind);
  const auto model = dynamics::linear_model(machine, machine.neutral(), kind);
  auto rigid = machine;
  for (auto& leg : rigid.legs) leg.bending = model::LegBending::rigid;
  double of_bows = 0.0;
  for (int leg = 0; leg < model::leg_count; ++leg) {
    const Vector3 a = machine.neutral() * machine.legs[leg].platform_joint;
    const auto on_base = leg_on_base(machine.legs[leg], a, machine.flexible_axes, {});
    const auto without = leg_on_base(rigid.legs[leg], a, machine.flexible_axes, {});
    of_bows += (on_base.momentum - without.momentum).rightCols<4>().norm();
    for (int k = 0; k < 4; ++k) {
      Eigen::VectorXd v = Eigen::VectorXd::Zero(at.mechanics.velocities());
      v[model.first_of_leg(leg) + k] = 1.0;
      const auto momentum = at.mechanics.momentum(at.motion(at.y, v));
      const dynamics::Vector6 expected = on_base.momentum.col(3 + k);
      EXPECT_LE((momentum - expected).norm(), 1e-11 * expected.norm()) << leg << " " << k;
    }
  }
  EXPECT_GT(of_bows, 1e-3);
}

/// The equilibrium found at another pose with the compression of the reference is one of the
/// mechanics that keeps that compression.
TEST(BendingMachine, RestsAtOtherPosesToo) {
  Random random(53);
  const auto machine = loaded_machine(random, model::FlexibleAxes::transverse, false);
  const dynamics::NonlinearModel mechanics(machine, ModelKind::guide, machine.neutral());
  const auto& X = machine.poses[1].X_BP;
  const auto rest = mechanics.equilibrium(X);
  ASSERT_EQ(rest.status, dynamics::StaticsStatus::converged);
  Eigen::VectorXd y(mechanics.positions()), v = Eigen::VectorXd::Zero(mechanics.velocities()),
                                            rate(v.size());
  mechanics.configuration(X, rest.legs, y.data());
  dynamics::Loads loads;
  for (int k = 0; k < model::leg_count; ++k) loads.axial[k] = -rest.legs[k].oil_force;
  dynamics::Motion motion;
  mechanics.motion(y.data(), v.data(), motion);
  mechanics.accelerations(motion, loads, rate.data());
  EXPECT_LE((mechanics.mass_matrix(motion) * rate).norm(),
            1e-8 * machine.platform.mass * machine.gravity.norm());
}

}  // namespace
}  // namespace hydrapod::test
