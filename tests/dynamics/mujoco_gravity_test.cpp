/// Equilibrium, stiffness, damping and frequencies of machines under gravity, against the same
/// mechanisms in MuJoCo, whose equilibrium and stiffness are found from its forces alone.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "hydrapod/dynamics/linear_model.hpp"
#include "support/eigenvalues.hpp"
#include "support/kinds.hpp"
#include "support/mujoco_equilibrium.hpp"
#include "support/random_machine.hpp"

namespace hydrapod::test {
namespace {

using model::FlexibleAxes;

/// Both sides balance forces to about 1e-11 of the weight.
constexpr double equilibrium_tolerance = 2e-10;
/// What is left of differences of fourth order and of that equilibrium, 20 times the worst of 1200.
constexpr double frequency_tolerance = 1e-8;
/// Past buckling the bend answers to an unbalanced force with little or negative stiffness.
constexpr double beyond_buckling = 100.0;

/// Worst differences between a machine here and in MuJoCo.
struct Differences {
  double oil_force{};  ///< relative to the largest of the six
  double bend{};       ///< case and rod directions [rad], piston offset relative to the leg
  double frequency{};  ///< relative
  double damping{};    ///< relative, square roots of the eigenvalues of M⁻¹C
  double lowest_omega_squared{};
};

/// Direction of the rod in B from the tilts that hydrapod gives.
Vector3 rod_direction(const dynamics::LegElement& leg, const dynamics::LegState& state) {
  const Eigen::AngleAxisd about_t(state.flexible[0], Vector3::UnitX());
  const Eigen::AngleAxisd about_a2(state.flexible[1], Vector3::UnitY());
  return leg.frame.R_BL * (about_t * about_a2 * Vector3::UnitZ());
}

Differences compare(const model::Machine& machine, const spatial::Pose& X_BP, ModelKind kind,
                    double step = 3e-4) {
  auto expected = mujoco_equilibrium(machine, X_BP, kind);
  EXPECT_LE(expected.residual, 1e-10);
  const auto model = dynamics::linear_model(machine, X_BP, kind);
  Differences differ;
  const double largest_force = expected.oil_force.lpNorm<Eigen::Infinity>();
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = model.legs[i];
    const auto& state = model.statics.legs[i];
    const Vector3 offset = leg.frame.R_BL * Vector3(state.flexible[2], state.flexible[3], 0.0);
    differ.oil_force = std::max(differ.oil_force,
                                std::abs(state.oil_force - expected.oil_force[i]) / largest_force);
    differ.bend = std::max({differ.bend,
                            (leg.frame.R_BL.col(2) - expected.hexapod.case_axes(i).col(2)).norm(),
                            (rod_direction(leg, state) - expected.hexapod.rod_direction(i)).norm(),
                            (offset - expected.hexapod.piston_offset(i)).norm() / leg.l});
  }
  const MatrixXd K = stiffness_at(expected, step);
  const VectorXd lambda = omega_squared(mass_at(expected), 0.5 * (K + K.transpose()));
  differ.frequency = worst_frequency_error(omega_squared(model.M, model.K), lambda);
  differ.damping = worst_frequency_error(omega_squared(model.M, model.C),
                                         omega_squared(mass_at(expected), damping_at(expected)));
  differ.lowest_omega_squared = lambda[0];
  return differ;
}

/// Light legs on seals so soft that the worst leg carries 2.5 times what would buckle it.
void overload(model::Machine& machine) {
  const double softer = largest_load_share(machine, machine.neutral()) / 2.5;
  for (auto& leg : machine.legs) {
    leg.guide_sleeve.stiffness *= softer;
    leg.piston_ring->stiffness *= softer;
    constexpr double lighter = 0.01;
    for (double* number : {&leg.cylinder_case.mass, &leg.cylinder_case.transverse_inertia,
                           &leg.cylinder_case.axial_inertia, &leg.rod.mass,
                           &leg.rod.transverse_inertia, &leg.rod.axial_inertia})
      *number *= lighter;
  }
}

class UnderGravity : public testing::TestWithParam<AxesAndKind> {
 protected:
  void expect_agreement(const model::Machine& machine, const spatial::Pose& X_BP, double slack) {
    const auto differ = compare(machine, X_BP, std::get<1>(GetParam()));
    EXPECT_LE(differ.oil_force, slack * equilibrium_tolerance);
    EXPECT_LE(differ.bend, slack * equilibrium_tolerance);
    EXPECT_LE(differ.frequency, slack * frequency_tolerance);
    EXPECT_LE(differ.damping, slack * frequency_tolerance);
    worst_.damping = std::max(worst_.damping, differ.damping);
    worst_.oil_force = std::max(worst_.oil_force, differ.oil_force);
    worst_.bend = std::max(worst_.bend, differ.bend);
    worst_.frequency = std::max(worst_.frequency, differ.frequency);
    unstable_ += differ.lowest_omega_squared < 0.0;
  }
  void TearDown() override {
    RecordProperty("worst",
                   fmt::format("oil force {:.1e}, bend {:.1e}, frequency {:.1e}, damping {:.1e}",
                               worst_.oil_force, worst_.bend, worst_.frequency, worst_.damping));
  }
  Differences worst_;
  int unstable_{};
};

TEST_P(UnderGravity, EquilibriumAndFrequenciesAreThoseOfMujoco) {
  const auto [axes, kind] = GetParam();
  Random random(19640519);
  for (int i = 0; i < 12; ++i) {
    const auto gravity = i % 3 == 0 ? Gravity::anywhere : Gravity::down;
    const auto machine = random_machine(random, {.axes = axes, .gravity = gravity});
    for (const auto& pose : machine.poses) {
      SCOPED_TRACE(fmt::format("machine {}, pose {}", i, pose.name));
      expect_agreement(machine, pose.X_BP, 1.0);
    }
  }
  EXPECT_EQ(unstable_, 0);
}

/// Rods that lie on their guide rings, where the force is k_c (|d| − g) along d, and rods that do
/// not reach them. Offsets are tenths of a millimetre: differences of the force take steps of a
/// thousandth of these, so that the rounding of the forces counts.
class OnGuideRings : public testing::TestWithParam<AxesAndKind> {};

TEST_P(OnGuideRings, EquilibriumAndFrequenciesAreThoseOfMujoco) {
  const auto [axes, kind] = GetParam();
  Random random(881);
  constexpr double of_short_steps = 1e-7;
  constexpr double corner = 0.11;  // of the gap; within it the ring of the library is smooth
  int pressed = 0, free = 0, machines = 0;
  for (int i = 0; i < 30 && machines < 8; ++i) {
    auto machine = random_machine(random, {.axes = axes, .gravity = Gravity::down});
    const auto sagging = dynamics::linear_model(machine, machine.neutral(), kind);
    for (int leg = 0; leg < model::leg_count; ++leg) {
      auto& sleeve = machine.legs[leg].guide_sleeve;
      sleeve.gap = (leg == 4 ? 1.7 : 0.31) * sagging.legs[leg].sleeve_offset.norm();
      sleeve.guide_stiffness = (4.1 + 0.3 * leg) * sleeve.stiffness;
    }
    const auto model = dynamics::linear_model(machine, machine.neutral(), kind);
    int clear = 0, on_ring = 0;
    for (int leg = 0; leg < model::leg_count; ++leg) {
      const double share =
          model.legs[leg].sleeve_offset.norm() / *machine.legs[leg].guide_sleeve.gap;
      clear += std::abs(share - 1.0) > corner;
      on_ring += share > 1.0;
    }
    if (clear < model::leg_count) continue;
    SCOPED_TRACE(fmt::format("machine {}", i));
    ++machines;
    pressed += on_ring;
    free += model::leg_count - on_ring;
    const auto differ = compare(machine, machine.neutral(), kind, 2e-7);
    EXPECT_LE(differ.oil_force, equilibrium_tolerance);
    EXPECT_LE(differ.bend, equilibrium_tolerance);
    EXPECT_LE(differ.frequency, of_short_steps);
  }
  EXPECT_GE(machines, 5);
  EXPECT_GE(pressed, 20);
  EXPECT_GE(free, 5);
}

class BeyondBuckling : public UnderGravity {};

TEST_P(BeyondBuckling, AModeIsUnstableAndAllAreThoseOfMujoco) {
  const auto [axes, kind] = GetParam();
  Random random(1757);
  int machines = 0;
  for (; machines < 6; ++machines) {
    auto machine = random_machine(random, {.axes = axes, .gravity = Gravity::down});
    overload(machine);
    SCOPED_TRACE(fmt::format("machine {}", machines));
    expect_agreement(machine, machine.neutral(), beyond_buckling);
  }
  EXPECT_EQ(unstable_, machines);
}

INSTANTIATE_TEST_SUITE_P(, UnderGravity,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::rigid, ModelKind::guide,
                                                          ModelKind::full)),
                         [](const auto& test) { return name(test); });
INSTANTIATE_TEST_SUITE_P(, OnGuideRings,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::guide, ModelKind::full)),
                         [](const auto& test) { return name(test); });
INSTANTIATE_TEST_SUITE_P(, BeyondBuckling,
                         testing::Combine(both_axes(),
                                          testing::Values(ModelKind::guide, ModelKind::full)),
                         [](const auto& test) { return name(test); });

}  // namespace
}  // namespace hydrapod::test
