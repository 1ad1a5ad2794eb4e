/// Equivalent springs and dampers against describing functions in closed form.

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace hydrapod::test {
namespace {

using dynamics::Vector2;
constexpr double pi = std::numbers::pi;

/// Of a dead zone g with stiffness k_c beyond it, for an amplitude A > g (Gelb & Vander Velde,
/// Multiple-Input Describing Functions, 1968, appendix B): k_c (1 − 2/π (asin q + q √(1 − q²))),
/// q = g/A.
double dead_zone(double k_c, double gap, double amplitude) {
  const double q = gap / amplitude;
  return k_c * (1.0 - 2.0 / pi * (std::asin(q) + q * std::sqrt(1.0 - q * q)));
}

TEST(GuideEquivalent, IsTheDescribingFunctionOfADeadZoneAlongTheMotion) {
  const model::GuideSleeve sleeve{.stiffness = 2.1e6, .gap = 1.9e-4, .guide_stiffness = 4.3e7};
  const Vector2 along = Vector2(0.6, -0.8);
  for (const double times : {3.0, 7.7, 40.0, 300.0}) {
    const double A = times * *sleeve.gap;
    const auto found = dynamics::guide_equivalent(sleeve, Vector2::Zero(), A * along);
    const Vector2 force = found.stiffness * along;
    const double sharp = dead_zone(sleeve.guide_stiffness, *sleeve.gap, A);
    // The corner is rounded over a tenth of the gap: an excess of the order of its square, twice in
    // a quarter of a period.
    EXPECT_NEAR(force.dot(along), sharp, 0.02 * sharp / times);
    EXPECT_NEAR(force.dot(Vector2(0.8, 0.6)), 0.0, 1e-9 * sharp);
    EXPECT_TRUE(found.touches);
    EXPECT_LT(found.mean.norm(), 1e-12);
  }
  EXPECT_FALSE(dynamics::guide_equivalent(sleeve, Vector2::Zero(), 1e-4 * along).touches);
}

/// Small motions about a rod that lies on its guide meet the tangent along and the secant across.
TEST(GuideEquivalent, OfSmallMotionsIsTheStiffnessAtRest) {
  const model::GuideSleeve sleeve{.stiffness = 2.1e6, .gap = 1.9e-4, .guide_stiffness = 4.3e7};
  const Vector2 rest(0.0, 3.3e-4);
  const auto found = dynamics::guide_equivalent(sleeve, rest, Vector2(1e-9, 1e-9));
  EXPECT_NEAR(found.stiffness(1, 1), 4.3e7, 1e-5 * 4.3e7);
  EXPECT_NEAR(found.stiffness(0, 0), 4.3e7 * (3.3e-4 - 1.9e-4) / 3.3e-4, 1e-5 * 4.3e7);
  EXPECT_NEAR((found.mean - rest).norm(), 0.0, 1e-9);
}

/// The mean force over a period is what the rod carries at rest.
TEST(GuideEquivalent, SwingsAboutWhereTheMeanForceCarriesTheLoad) {
  const model::GuideSleeve sleeve{.stiffness = 2.1e6, .gap = 1.9e-4, .guide_stiffness = 4.3e7};
  const Vector2 rest(1.1e-4, 2.3e-4), amplitude(4e-4, -1e-4);
  const auto force = [&](const Vector2& d) -> Vector2 {
    const double offset = d.norm(), over = offset - 1.9e-4;
    // outside of the rounded corner the ring's force is k_c (|d| − g)
    const double ring = over > 0.0 ? 4.3e7 * over / offset : 0.0;
    return (2.1e6 + ring) * d;
  };
  const auto found = dynamics::guide_equivalent(sleeve, rest, amplitude);
  Vector2 mean = Vector2::Zero();
  constexpr int points = 100000;
  for (int k = 0; k < points; ++k)
    mean += force(found.mean + std::cos(2.0 * pi * (k + 0.5) / points) * amplitude) / points;
  EXPECT_LT((mean - force(rest)).norm(), 0.01 * force(rest).norm());
  EXPECT_GT((found.mean - rest).norm(), 1e-5);
}

/// A mass on a seal and a guide ring, loaded so that it lies on the ring at rest: the sharp dead
/// zone with a bias in closed form (Gelb & Vander Velde, as above). Its frequency falls while the
/// mass leaves the ring, and rises again when it strikes the other side: the backbone turns back.
TEST(GuideEquivalent, OfABiasedDeadZoneHasABackboneThatTurnsBack) {
  const model::GuideSleeve sleeve{.stiffness = 2.1e6, .gap = 1.9e-4, .guide_stiffness = 4.3e7};
  const double k_s = sleeve.stiffness, g = *sleeve.gap, k_c = sleeve.guide_stiffness;
  // Of max(0, cos θ − q): its mean, and its part along cos θ.
  const auto mean_of = [](double q) {
    return q >= 1.0 ? 0.0 : q <= -1.0 ? -q : (std::sqrt(1.0 - q * q) - q * std::acos(q)) / pi;
  };
  const auto part_of = [](double q) {
    return q >= 1.0 ? 0.0 : q <= -1.0 ? 1.0 : (std::acos(q) - q * std::sqrt(1.0 - q * q)) / pi;
  };
  const double rest = 2.3e-4, load = k_s * rest + k_c * (rest - g);
  std::vector<double> stiffness;
  for (const double A : {1e-5, 1.3e-4, 2.1e-4, 3.3e-4, 9.1e-4, 7.7e-3}) {
    double low = 0.0, high = rest;  // of the mean offset
    for (int k = 0; k < 80; ++k) {
      const double m = 0.5 * (low + high);
      const double force = k_s * m + k_c * A * (mean_of((g - m) / A) - mean_of((g + m) / A));
      (force < load ? low : high) = m;
    }
    const double sharp = k_s + k_c * (part_of((g - low) / A) + part_of((g + low) / A));
    const auto found = dynamics::guide_equivalent(sleeve, Vector2(rest, 0.0), Vector2(A, 0.0));
    stiffness.push_back(k_s + found.stiffness(0, 0));
    // The corner is rounded over a tenth of the gap.
    EXPECT_NEAR(stiffness.back(), sharp, 0.01 * sharp) << A;
    EXPECT_NEAR(found.mean.x(), low, 0.01 * rest) << A;
  }
  EXPECT_NEAR(stiffness.front(), k_s + k_c, 1e-6 * k_c);
  const auto least = std::ranges::min_element(stiffness);
  EXPECT_LT(*least, 0.5 * stiffness.front());
  EXPECT_GT(stiffness.back(), 1.5 * *least);
  EXPECT_TRUE(std::ranges::is_sorted(stiffness.begin(), least + 1, std::greater{}));
  EXPECT_TRUE(std::ranges::is_sorted(least, stiffness.end()));
}

hydraulics::Friction bristles(double sigma, double coulomb) {
  hydraulics::Friction friction;
  friction.coulomb = friction.breakaway = coulomb;
  friction.bristle_stiffness = sigma;
  return friction;
}

/// Dahl's hysteresis in closed form: with F_c the sliding force and F_m = F_c tanh(σ A/F_c), a
/// stroke up is F = F_c − (F_c + F_m) exp(−σ (x + A)/F_c).
TEST(FrictionEquivalent, OfBristlesIsThatOfTheirHysteresis) {
  constexpr double sigma = 3.7e7, F_c = 411.0, omega = 31.0;
  for (const double A : {1e-9, 2e-6, 1.3e-5, 9e-5, 1e-3}) {
    const double F_m = F_c * std::tanh(sigma * A / F_c);
    double cosine = 0.0, sine = 0.0;
    constexpr int points = 400000;
    for (int k = 0; k < points; ++k) {  // half a period up: x = −A cos τ
      const double tau = pi * (k + 0.5) / points, x = -A * std::cos(tau);
      const double F = F_c - (F_c + F_m) * std::exp(-sigma * (x + A) / F_c);
      cosine += -F * std::cos(tau) * pi / points;
      sine += F * std::sin(tau) * pi / points;
    }
    const double stiffness = 2.0 * cosine / (pi * A), damping = 2.0 * sine / (pi * A * omega);
    const auto found = hydraulics::friction_equivalent(bristles(sigma, F_c), A, omega);
    EXPECT_NEAR(found.stiffness, stiffness, 2e-3 * stiffness + 1e-9 * sigma) << A;
    EXPECT_NEAR(found.damping, damping, 2e-3 * damping + 1e-9 * sigma / omega) << A;
  }
  // Bristles that only stick are their spring; long strokes are Coulomb's damper 4 F_c/(π A ω).
  EXPECT_NEAR(hydraulics::friction_equivalent(bristles(sigma, F_c), 1e-12, omega).stiffness, sigma,
              1e-6 * sigma);
  EXPECT_NEAR(hydraulics::friction_equivalent(bristles(sigma, F_c), 0.1, omega).damping,
              4.0 * F_c / (pi * 0.1 * omega), 0.01 * F_c / (0.1 * omega));
}

TEST(FrictionEquivalent, OfTheSmoothLawIsADamperAlone) {
  hydraulics::Friction friction;
  friction.coulomb = friction.breakaway = 411.0;
  friction.smoothing_velocity = 0.002;
  friction.viscous = 1e5;  // left out
  const auto slow = hydraulics::friction_equivalent(friction, 1e-6, 31.0);
  EXPECT_NEAR(slow.damping, 411.0 / 0.002, 1e-3 * 411.0 / 0.002);  // the slope of the tanh
  EXPECT_NEAR(slow.stiffness, 0.0, 1e-6 * slow.damping * 31.0);
  const auto fast = hydraulics::friction_equivalent(friction, 0.2, 31.0);
  EXPECT_NEAR(fast.damping, 4.0 * 411.0 / (pi * 0.2 * 31.0), 0.01 * fast.damping);
}

TEST(Softened, LeavesHalfOfTheSofteningAtItsAmplitude) {
  const model::Elastomer elastomer{.softening = 0.37, .softening_amplitude = 1.3e-4};
  EXPECT_NEAR(dynamics::softened(elastomer, 1.3e-4), 1.0 - 0.37 / 2.0, 1e-15);
  EXPECT_NEAR(dynamics::softened(elastomer, 0.0), 1.0, 1e-15);
  EXPECT_NEAR(dynamics::softened(elastomer, 1.0), 1.0 - 0.37, 1e-4);
}

}  // namespace
}  // namespace hydrapod::test
