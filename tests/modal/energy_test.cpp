/// Energy shares: they sum to one, and they are what frequencies do when a part is changed.

#include "hydrapod/modal/normal_modes.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/eigenvalues.hpp"
#include "support/kinds.hpp"
#include "support/random_machine.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using modal::EnergyShares;

constexpr double rounding = 1e-12;  // of sums of shares that are differences of larger numbers

dynamics::LinearModel linear_of(const model::Machine& machine, ModelKind kind) {
  return dynamics::linear_model(machine, machine.poses.back().X_BP, kind);
}

void expect_sums_of_one(const EnergyShares& shares) {
  EXPECT_NEAR(shares.platform.sum() + shares.legs.sum(), 1.0, rounding);
  EXPECT_NEAR(shares.oil.sum() + shares.guide_sleeve.sum() + shares.piston_ring.sum(), 1.0,
              rounding);
  EXPECT_GE(shares.legs.minCoeff(), 0.0);
  EXPECT_GE(shares.oil.minCoeff(), 0.0);
}

class Shares : public testing::TestWithParam<AxesAndKind> {};

TEST_P(Shares, SumToOne) {
  const auto [axes, kind] = GetParam();
  Random random(5);
  for (int i = 0; i < 40; ++i) {
    const auto gravity = i % 2 == 0 ? Gravity::none : Gravity::anywhere;
    const auto model = linear_of(random_machine(random, {.axes = axes, .gravity = gravity}), kind);
    const auto modes = modal::normal_modes(model);
    for (const auto& shares : modal::energy_shares(model, modes.shapes)) expect_sums_of_one(shares);
    dynamics::ModelVector real(model.dof()), imaginary(model.dof());
    for (int k = 0; k < model.dof(); ++k) {
      real[k] = random.uniform(-1.0, 1.0);
      imaginary[k] = random.uniform(-1.0, 1.0);
    }
    expect_sums_of_one(modal::energy_shares(model, real, imaginary));
  }
}

TEST_P(Shares, OfAComplexShapeIsTheMeanOfItsParts) {
  const auto [axes, kind] = GetParam();
  Random random(6);
  const auto model = linear_of(random_machine(random, {.axes = axes}), kind);
  const auto modes = modal::normal_modes(model);
  const auto apart = modal::energy_shares(model, modes.shapes);
  // equal kinetic energies (φᵀ M φ = 1), elastic ones as ω²
  const auto both = modal::energy_shares(model, modes.shapes.col(0), modes.shapes.col(3));
  const double a = modes.omega2[0], b = modes.omega2[3];
  constexpr double eigenvalue = 1e-10;  // ω² of a low mode, some epsilons of the largest
  EXPECT_LE((both.platform - 0.5 * (apart[0].platform + apart[3].platform)).norm(), rounding);
  EXPECT_LE((both.oil - (a * apart[0].oil + b * apart[3].oil) / (a + b)).norm(), eigenvalue);
}

/// ω² φᵀ M φ = φᵀ K φ, and of that the springs hold what preload leaves them: the shares give ω²
/// back.
TEST_P(Shares, GiveTheFrequencyBack) {
  const auto [axes, kind] = GetParam();
  Random random(7);
  for (int i = 0; i < 20; ++i) {
    const auto gravity = i % 2 == 0 ? Gravity::none : Gravity::down;
    const auto model = linear_of(random_machine(random, {.axes = axes, .gravity = gravity}), kind);
    const auto modes = modal::normal_modes(model);
    const auto shares = modal::energy_shares(model, modes.shapes);
    for (int k = 0; k < modes.size(); ++k) {
      const auto& leg = model.legs[0];  // its oil spring, in joules, tells what a share of one is
      const spatial::Vector3 joint = model.J[0] * modes.shapes.col(k).head<6>();
      dynamics::Vector7 x = dynamics::Vector7::Zero();
      x.head<3>() = joint;
      const int flexible = dynamics::flexible_per_leg(kind);
      x.segment(3, flexible) = modes.shapes.col(k).segment(6, flexible);
      const double oil = leg.k_h * std::pow(leg.s_x.dot(x), 2);
      if (shares[k].oil[0] < 1e-6) continue;
      const double elastic = oil / shares[k].oil[0];
      EXPECT_NEAR(elastic * (1.0 + shares[k].preload) / modes.omega2[k], 1.0, 1e-9);
      if (gravity == Gravity::none) {
        EXPECT_EQ(shares[k].preload, 0.0);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, Shares,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });

/// d ln ω² / d ln p by central differences, for `scale(machine, factor)`.
template <class Scale>
Eigen::VectorXd sensitivity(const model::Machine& machine, const Scale& scale) {
  constexpr double h = 1e-5;
  const auto log_omega2 = [&](double factor) {
    auto changed = machine;
    scale(changed, factor);
    const auto model = linear_of(changed, ModelKind::full);
    return omega_squared(model.M, model.K).array().log().matrix().eval();
  };
  return (log_omega2(1.0 + h) - log_omega2(1.0 - h)) / (2.0 * h);
}

/// Stiffen one spring by one per cent, and ω² rises by its share of one per cent. This is not how
/// the shares are computed.
TEST(Energy, SharesAreTheSensitivitiesOfTheFrequencies) {
  constexpr double differences = 1e-6;
  Random random(8);
  for (int i = 0; i < 5; ++i) {
    auto machine = random_machine(random);
    for (auto& leg : machine.legs)  // oil springs given directly, to be scaled
      if (leg.oil_spring.cylinder) leg.oil_spring = {.stiffness = 3e7 * random.uniform(0.5, 2.0)};
    const auto model = linear_of(machine, ModelKind::full);
    const auto modes = modal::normal_modes(model);
    const auto shares = modal::energy_shares(model, modes.shapes);
    const auto expect = [&](const Eigen::VectorXd& found, const auto& share_of) {
      for (int k = 0; k < modes.size(); ++k)
        EXPECT_NEAR(found[k], share_of(shares[k]), differences);
    };
    const int leg = i;
    expect(sensitivity(machine, [=](auto& m, double f) { *m.legs[leg].oil_spring.stiffness *= f; }),
           [=](const auto& s) { return s.oil[leg]; });
    expect(
        sensitivity(machine, [=](auto& m, double f) { m.legs[leg].guide_sleeve.stiffness *= f; }),
        [=](const auto& s) { return s.guide_sleeve[leg]; });
    expect(
        sensitivity(machine, [=](auto& m, double f) { m.legs[leg].piston_ring->stiffness *= f; }),
        [=](const auto& s) { return s.piston_ring[leg]; });
    expect(sensitivity(machine,
                       [](auto& m, double f) {
                         m.platform.mass *= f;
                         m.platform.inertia *= f;
                       }),
           [](const auto& s) { return -s.platform.sum(); });
    expect(sensitivity(machine,
                       [=](auto& m, double f) {
                         auto& leg_of = m.legs[leg];
                         leg_of.cylinder_case.mass *= f;
                         leg_of.cylinder_case.transverse_inertia *= f;
                         leg_of.rod.mass *= f;
                         leg_of.rod.transverse_inertia *= f;
                         leg_of.added_axial_inertia *= f;
                       }),
           [=](const auto& s) { return -s.legs[leg]; });
  }
}

/// With the mount's energy in it the elastic energy is φᵀ K φ = ω² φᵀ M φ: leg 1's oil spring, in
/// joules, tells what a share of one is.
TEST(Energy, OfTheMountBelongsToTheElasticOne) {
  Random random(9);
  auto machine = random_machine(random);
  machine.base_mount =
      model::BaseMount{.stiffness = {4.1e7, 3.7e7, 9.3e7, 5.9e7, 7.1e7, 2.3e7}, .mass = 713.0};
  const auto model = linear_of(machine, ModelKind::rigid);
  const auto modes = modal::normal_modes(model);
  const auto shares = modal::energy_shares(model, modes.shapes);
  double most = 0.0;
  for (int k = 0; k < modes.size(); ++k) {
    const auto& s = shares[static_cast<std::size_t>(k)];
    EXPECT_NEAR(s.oil.sum() + s.base_mount, 1.0, rounding);
    const spatial::Vector3 joint = model.J[0] * (model.against_base * modes.shapes.col(k));
    const double oil = model.legs[0].k_h * std::pow(model.legs[0].s_x.head<3>().dot(joint), 2);
    EXPECT_NEAR(oil / s.oil[0] / modes.omega2[k], 1.0, 1e-9) << k;
    most = std::max(most, s.base_mount);
  }
  EXPECT_GT(most, 0.05);
}

/// What the weight takes from the knees: the stiffness of the x mode falls to (31.4 / 46.8)².
TEST(Energy, PreloadIsWhatSoftensThePublishedMachine) {
  const auto model = linear_of(symmetric_machine(9.81), ModelKind::guide);
  const auto modes = modal::normal_modes(model);
  const auto shares = modal::energy_shares(model, modes.shapes);
  EXPECT_LT(shares[0].preload, -0.2);
  EXPECT_GT(shares[0].preload, -1.0);
}

}  // namespace
}  // namespace hydrapod::test
