/// Branches that turn back in amplitude, against one that is known in closed form.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "exact/guide_ring.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
constexpr double pi = std::numbers::pi;
constexpr double gap = 1.7e-4, k_c = 4.1e7;

model::Machine branching_machine() {
  auto machine = symmetric_machine();
  machine.damping.modal_ratio = 0.0;
  for (auto& leg : machine.legs) {
    leg.guide_sleeve.gap = gap;
    leg.guide_sleeve.guide_stiffness = k_c;
  }
  return machine;
}

struct Solution {
  double omega{}, amplitude{}, platform{};
};

/// While the platform moves up and down all six rods have the same amplitude `a` at their guides.
/// The branch is then explicit: linear modes of a machine with k_s + k(a) in the place of k_s,
/// scaled to `a`.
std::vector<Solution> heave(double a) {
  auto machine = symmetric_machine();
  for (auto& leg : machine.legs) leg.guide_sleeve.stiffness += ring_stiffness(a, gap, k_c);
  const auto model = dynamics::linear_model(machine, machine.neutral(), ModelKind::guide);
  const auto modes = modal::normal_modes(model);
  std::vector<Solution> found;
  for (int k = 0; k < modes.size(); ++k) {
    const dynamics::ModelVector phi = modes.shapes.col(k);
    const double rise = std::abs(phi[2]);
    if (!(phi.head<2>().norm() + phi.segment<3>(3).norm() < 1e-4 * rise)) continue;
    dynamics::Vector2 offset;
    for (int axis : {0, 1})
      offset[axis] = dynamics::per_coordinate(model, 0, model.legs[0].d_x.row(axis)).dot(phi);
    found.push_back(
        {modes.omega(k), rise * a / offset.norm(), machine.platform.mass * rise * rise});
  }
  return found;
}

/// All solutions of a curve.
std::vector<modal::ModeAtAmplitude> solutions(const modal::AmplitudeCurve& curve) {
  auto points = curve.points;
  points.insert(points.end(), curve.further.begin(), curve.further.end());
  std::erase_if(points, [](const auto& point) { return !point.converged; });
  return points;
}

TEST(BranchesOverTheAmplitude, OfHeaveAreThoseInClosedForm) {
  const auto machine = branching_machine();
  std::vector<double> amplitudes;
  for (double A = 1.1e-4; A < 0.011; A *= 1.37) amplitudes.push_back(A);
  const auto curves =
      modal::modes_at_amplitudes(machine, machine.neutral(), ModelKind::guide, amplitudes);
  std::vector<modal::ModeAtAmplitude> points;
  int turning_points = 0;
  for (const auto& curve : curves) {
    if (curve.direction != 2) continue;
    const auto more = solutions(curve);
    points.insert(points.end(), more.begin(), more.end());
    // Where the branch turns back, the amplitude in closed form has an extremum.
    for (const auto& turn : curve.turning) {
      const auto amplitude_at = [&](double a) {
        const auto all = heave(a);
        return std::ranges::min_element(
                   all, {}, [&](const Solution& s) { return std::abs(s.omega - turn.omega); })
            ->amplitude;
      };
      const double here = amplitude_at(turn.sleeve);
      EXPECT_NEAR(turn.amplitude, here, 1e-7 * here);
      const double below = amplitude_at(turn.sleeve * (1.0 - 1e-3)) - here;
      const double above = amplitude_at(turn.sleeve * (1.0 + 1e-3)) - here;
      EXPECT_GT(below * above, 0.0);
      EXPECT_LT(std::abs(below - above), 0.2 * std::abs(below + above));
      ++turning_points;
    }
  }
  EXPECT_GE(turning_points, 1);
  for (const auto& point : points) {
    const auto all = heave(point.sleeve);
    const auto same = std::ranges::min_element(
        all, {}, [&](const Solution& s) { return std::abs(s.omega - point.omega); });
    ASSERT_NE(same, all.end());
    EXPECT_NEAR(point.omega, same->omega, 1e-8 * same->omega) << point.amplitude;
    EXPECT_NEAR(point.amplitude, same->amplitude, 1e-6 * same->amplitude);
  }
  // None is missing in which the platform takes part: crossings of the curve in closed form.
  int several = 0;
  std::vector<std::vector<Solution>> scan;
  for (double a = 1e-6; a < 0.05; a *= 1.01) scan.push_back(heave(a));
  for (const double A : amplitudes) {
    int crossings = 0;
    for (std::size_t k = 0; k + 1 < scan.size(); ++k)
      for (std::size_t family = 0; family < std::min(scan[k].size(), scan[k + 1].size());
           ++family) {
        const auto &low = scan[k][family], &high = scan[k + 1][family];
        if ((low.amplitude < A) == (high.amplitude < A)) continue;
        if (std::min(low.platform, high.platform) < 0.06) continue;
        ++crossings;
        EXPECT_TRUE(std::ranges::any_of(points,
                                        [&](const auto& point) {
                                          return point.amplitude == A &&
                                                 std::abs(point.omega - low.omega) <=
                                                     1.5 * std::abs(high.omega - low.omega) +
                                                         1e-6 * low.omega;
                                        }))
            << A << " at " << low.omega;
      }
    several += crossings > 1;
  }
  EXPECT_GE(several, 3);
}

/// A machine turned about the vertical has the same branches, also where x and y repeat.
TEST(BranchesOverTheAmplitude, DoNotDependOnTheAxesOfTheMachine) {
  const auto branches = [](double angle) {
    auto machine = symmetric_machine(9.81);
    machine.damping.modal_ratio = 0.0;
    const spatial::Matrix3 R =
        Eigen::AngleAxisd(angle, spatial::Vector3::UnitZ()).toRotationMatrix();
    for (auto& leg : machine.legs) {
      leg.guide_sleeve.gap = 1.1e-3;  // the weight brings rods 0.82 mm off their axes
      leg.guide_sleeve.guide_stiffness = 1.3e6;
      leg.base_joint = R * leg.base_joint;
      leg.platform_joint = R * leg.platform_joint;
    }
    std::vector<double> omega;
    const auto curves = modal::modes_at_amplitudes(machine, machine.neutral(), ModelKind::guide,
                                                   std::vector{1e-5, 5e-5, 1e-4, 1.8e-4});
    for (const auto& curve : curves)
      for (const auto& point : solutions(curve)) omega.push_back(point.omega);
    std::ranges::sort(omega);
    return omega;
  };
  const auto as_built = branches(0.0), turned = branches(0.2967);
  ASSERT_GT(as_built.size(), 20U);
  ASSERT_EQ(as_built.size(), turned.size());
  for (std::size_t k = 0; k < turned.size(); ++k)
    EXPECT_NEAR(turned[k], as_built[k], 1e-7 * as_built[k]);
}

/// The length of steps decides how fast a branch is followed, not where it leads.
TEST(BranchesOverTheAmplitude, DoNotDependOnTheSteps) {
  const auto machine = branching_machine();
  const std::vector amplitudes{1.3e-4, 1.7e-3, 7.7e-3};
  const auto curves_of = [&](const modal::AmplitudeOptions& options) {
    return modal::modes_at_amplitudes(machine, machine.neutral(), ModelKind::guide, amplitudes,
                                      options);
  };
  const auto usual = curves_of({}), short_steps = curves_of({.longest_step = 0.07});
  ASSERT_EQ(usual.size(), short_steps.size());
  for (std::size_t k = 0; k < usual.size(); ++k) {
    const auto one = solutions(usual[k]), other = solutions(short_steps[k]);
    ASSERT_EQ(one.size(), other.size()) << k;
    for (std::size_t j = 0; j < one.size(); ++j)
      EXPECT_NEAR(one[j].omega, other[j].omega, 1e-8 * one[j].omega);
    ASSERT_EQ(usual[k].turning.size(), short_steps[k].turning.size());
    for (std::size_t j = 0; j < usual[k].turning.size(); ++j)
      EXPECT_NEAR(usual[k].turning[j].amplitude, short_steps[k].turning[j].amplitude,
                  1e-7 * usual[k].turning[j].amplitude);
  }
}

/// However many amplitudes there are, the work is asked between any two of them.
TEST(BranchesOverTheAmplitude, CanBeStoppedAndSayHowFarTheyAre) {
  const auto machine = branching_machine();
  const auto X_BP = machine.neutral();
  const std::vector<double> amplitudes{1e-5, 1e-4, 1e-3};
  std::vector<double> shares;
  const auto told = modal::modes_at_amplitudes(machine, X_BP, ModelKind::guide, amplitudes, {},
                                               [&](double share) {
                                                 shares.push_back(share);
                                                 return false;
                                               });
  const auto silent = modal::modes_at_amplitudes(machine, X_BP, ModelKind::guide, amplitudes);
  ASSERT_EQ(told.size(), silent.size());
  for (std::size_t k = 0; k < told.size(); ++k) EXPECT_EQ(told[k].last.omega, silent[k].last.omega);
  EXPECT_TRUE(std::ranges::is_sorted(shares));
  EXPECT_GE(shares.front(), 0.0);
  EXPECT_LE(shares.back(), 1.0);
  EXPECT_GT(shares.size(), 50U);  // more than one for each branch

  std::vector<double> many;
  for (int k = 1; k <= 50; ++k) many.push_back(1e-7 * (1.0 + 1e-9 * k));  // within one step
  std::size_t asked = 0;
  EXPECT_THROW(modal::modes_at_amplitudes(machine, X_BP, ModelKind::guide, many, {},
                                          [&](double) { return ++asked == 40; }),
               base::ComputationError);
  EXPECT_EQ(asked, 40U);
}

}  // namespace
}  // namespace hydrapod::test
