// The strength of a leg as a column, against closed forms and a finite-element eigenproblem.
#include "hydrapod/dynamics/statics.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

namespace {

using hydrapod::dynamics::column_strength;
using hydrapod::model::Leg;
using std::numbers::pi;

constexpr double E = 1.97e11;

Leg slender_leg(double rod_length, double sleeve) {
  Leg leg;
  leg.rod.length = rod_length;
  leg.rod.diameter = 0.0317;
  leg.rod.youngs_modulus = E;
  leg.rod.yield_strength = 9e9;  // so that Euler's load holds
  leg.guide_sleeve.position = sleeve;
  return leg;
}

double solid(double diameter) { return pi / 64.0 * std::pow(diameter, 4); }
double tube(double diameter, double wall) { return solid(diameter) - solid(diameter - 2.0 * wall); }

/// The lowest load of the column by cubic beam elements with consistent geometric stiffness, `n`
/// in every span. Rod and case are joined at piston and sleeve by equal deflections.
double by_finite_elements(double l_m, double L_g, double l, double EI_c, double EI_r, int n) {
  const int of_case = 2 * n + 1, of_rod = 2 * n + 1;
  const int size = 2 * (of_case + of_rod);
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(size, size), G = K;
  const auto span = [&](int first_node, double length, double EI, double load) {
    const double h = length / n;
    Eigen::Matrix4d k, g;
    k << 12, 6 * h, -12, 6 * h, 6 * h, 4 * h * h, -6 * h, 2 * h * h, -12, -6 * h, 12, -6 * h, 6 * h,
        2 * h * h, -6 * h, 4 * h * h;
    g << 36, 3 * h, -36, 3 * h, 3 * h, 4 * h * h, -3 * h, -h * h, -36, -3 * h, 36, -3 * h, 3 * h,
        -h * h, -3 * h, 4 * h * h;
    for (int e = 0; e < n; ++e) {
      const int at = 2 * (first_node + e);
      K.block<4, 4>(at, at) += EI / (h * h * h) * k;
      G.block<4, 4>(at, at) += load / (30.0 * h) * g;
    }
  };
  span(0, l_m, EI_c, 1.0);
  span(n, L_g - l_m, EI_c, 0.0);
  span(of_case, L_g - l_m, EI_r, 1.0);
  span(of_case + n, l - L_g, EI_r, 1.0);
  // what moves: all but the ends' deflections, the rod's at piston and sleeve being the case's
  Eigen::MatrixXd T = Eigen::MatrixXd::Zero(size, size);
  int count = 0;
  const auto piston = 2 * of_case, sleeve = 2 * (of_case + n);
  for (int i = 0; i < size; ++i) {
    if (i == 0 || i == piston || i == sleeve || i == 2 * (of_case + 2 * n)) continue;
    T(i, count) = 1.0;
    if (i == 2 * n) T(piston, count) = 1.0;
    if (i == 4 * n) T(sleeve, count) = 1.0;
    ++count;
  }
  const Eigen::MatrixXd joined = T.leftCols(count);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      joined.transpose() * G * joined, joined.transpose() * K * joined, Eigen::EigenvaluesOnly);
  return 1.0 / solver.eigenvalues().maxCoeff();
}

TEST(Column, WithLittleOverlapIsEulersPinnedColumn) {
  auto leg = slender_leg(1.0731, 0.7002);
  leg.cylinder_case.diameter = leg.rod.diameter;  // as stiff as the rod
  leg.cylinder_case.wall = 0.5 * *leg.rod.diameter;
  const auto error = [&](double overlap) {
    const double length = 0.7002 - overlap + 1.0731;
    const auto found = column_strength(leg, length);
    return found.value().euler / (pi * pi * E * solid(0.0317) / (length * length)) - 1.0;
  };
  EXPECT_NEAR(error(8e-3), 0.0, 8e-3);
  EXPECT_NEAR(error(4e-3), 0.5 * error(8e-3), 4e-5);  // proportional: nothing else differs
}

TEST(Column, OfARigidCaseHasAClosedForm) {
  // No force across the axis holds the far joint, so that the rod beyond the sleeve is
  // A sin κ(l − x). At the sleeve it has the case's deflection θ L_g and the slope θ + ψ; the rest
  // of the rod, pinned at the piston, answers ψ with the moment E I k ψ / c.
  for (const double overlap : {0.0113, 0.1571, 0.4309}) {
    const double L_g = 0.8147, b = 1.1291, c = overlap;
    const auto residual = [&](double kappa) {
      const double u = kappa * c, k = u * u * std::sin(u) / (std::sin(u) - u * std::cos(u));
      return std::sin(kappa * b) * (1.0 - kappa * kappa * L_g * c / k) +
             kappa * L_g * std::cos(kappa * b);
    };
    double low = 1e-3, high = low;
    while (residual(high) > 0.0) high += 1e-3;
    for (int n = 0; n < 100; ++n) {
      const double middle = 0.5 * (low + high);
      (residual(middle) > 0.0 ? low : high) = middle;
    }
    const auto found = column_strength(slender_leg(b + c, L_g), L_g + b);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->euler, low * low * E * solid(0.0317), 1e-8 * found->euler) << overlap;
    EXPECT_FALSE(found->yields);
    EXPECT_EQ(found->strength, found->euler);
  }
}

TEST(Column, IsThatOfFiniteElements) {
  struct Case {
    double rod, sleeve, length, case_diameter, case_wall;
    std::optional<double> rod_wall;
  };
  for (const auto& c : {Case{1.31, 1.173, 1.817, 0.0883, 0.0071, {}},
                        Case{1.31, 1.173, 2.231, 0.0883, 0.0071, 0.0083},
                        Case{1.31, 1.173, 2.431, 0.0383, 0.0021, {}},
                        Case{0.91, 0.613, 1.019, 0.1283, 0.0114, 0.0031}}) {
    auto leg = slender_leg(c.rod, c.sleeve);
    leg.rod.wall = c.rod_wall;
    leg.cylinder_case.diameter = c.case_diameter;
    leg.cylinder_case.wall = c.case_wall;
    const double I_r = c.rod_wall ? tube(0.0317, *c.rod_wall) : solid(0.0317);
    const auto elements = by_finite_elements(c.length - c.rod, c.sleeve, c.length,
                                             E * tube(c.case_diameter, c.case_wall), E * I_r, 24);
    const auto found = column_strength(leg, c.length);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->euler, elements, 1e-6 * elements) << c.length;
    leg.cylinder_case.wall.reset();
    leg.cylinder_case.diameter.reset();
    const auto rigid = column_strength(leg, c.length);
    ASSERT_TRUE(rigid);
    EXPECT_GT(rigid->euler, found->euler);
  }
}

TEST(Column, ThatIsStockyYieldsAsJohnsonSays) {
  auto leg = slender_leg(0.5013, 0.4471);
  const double yield = leg.rod.yield_strength = 3.19e8;
  const double area = pi / 4.0 * 0.0317 * 0.0317;
  const auto found = column_strength(leg, 0.6127);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->yields);
  EXPECT_NEAR(found->strength, area * yield * (1.0 - yield * area / (4.0 * found->euler)),
              1e-9 * found->strength);
  EXPECT_LT(found->strength, found->euler);
  // both curves meet with the same slope where Euler's stress is half the yield strength
  leg.rod.yield_strength = 2.0 * found->euler / area;
  EXPECT_NEAR(column_strength(leg, 0.6127)->strength, found->euler, 1e-9 * found->euler);
}

TEST(Column, NeedsARodsDiameter) {
  auto leg = slender_leg(1.0731, 0.7002);
  leg.rod.diameter.reset();
  EXPECT_FALSE(column_strength(leg, 1.4));
  leg.rod.diameter = 0.0317;
  EXPECT_TRUE(column_strength(leg, 1.4));
  EXPECT_FALSE(column_strength(leg, 0.7002 + 1.0731 - 1e-4)) << "next to no guided length";
  EXPECT_FALSE(column_strength(leg, 1.9)) << "the piston beyond the sleeve";
  leg.rod.diameter.reset();
  leg.oil_spring.cylinder = hydrapod::model::Cylinder{.bore = 0.06, .rod_diameter = 0.0317};
  const auto of_cylinder = column_strength(leg, 1.4);
  leg.rod.diameter = 0.0317;
  EXPECT_EQ(of_cylinder->euler, column_strength(leg, 1.4)->euler);
}

}  // namespace
