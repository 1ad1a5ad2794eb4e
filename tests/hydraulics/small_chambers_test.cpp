/// Chambers that leak, hoses and lines, against closed forms of the textbooks and a finely divided
/// line.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <complex>

#include "hydrapod/hydraulics/servo_axis.hpp"

namespace hydrapod::hydraulics {
namespace {

using Complex = std::complex<double>;

/// Ugly numbers: 80/56 mm cylinder, 3.1 cm³/(s bar) and less.
SmallChambers unequal_chambers() {
  SmallChambers chambers;
  chambers.capacity << 1.137e-12, 0.913e-12;
  chambers.conductance << 3.1e-11 + 0.7e-11, -0.7e-11, -0.7e-11, 1.9e-11 + 0.7e-11;
  chambers.area << 5.027e-3, -2.564e-3;
  return chambers;
}

/// (A_p, −e A_p) (C + G/s)⁻¹ (A_p, −e A_p)ᵀ, gimbals in series.
Complex directly(const SmallChambers& chambers, double compliance, Complex s) {
  const Eigen::Matrix2cd D = Eigen::Matrix2d(chambers.capacity.asDiagonal()).cast<Complex>() +
                             chambers.conductance.cast<Complex>() / s;
  const Eigen::Vector2cd a = chambers.area.cast<Complex>();
  const Complex Z = (a.transpose() * D.inverse() * a).value();
  return Z / (1.0 + Z * compliance);
}

Complex of(const RelaxingSpring& spring, Complex s) {
  Complex sum = 0.0;
  for (std::size_t j = 0; j < 2; ++j) sum += spring.stiffness[j] * s / (s + spring.rate[j]);
  return sum;
}

TEST(RelaxingSpring, IsTheDynamicStiffnessOfBothChambers) {
  const auto chambers = unequal_chambers();
  for (const double compliance : {0.0, 1.0 / 37e6})
    for (const Complex s :
         {Complex(0.0, 0.3), Complex(0.0, 23.0), Complex(-7.0, 190.0), Complex(11.0, 2300.0)}) {
      const Complex Z = directly(chambers, compliance, s);
      EXPECT_LT(std::abs(of(relaxing_spring(chambers, compliance), s) - Z), 1e-13 * std::abs(Z));
    }
}

TEST(RelaxingSpring, OfClosedChambersIsTheOilSpring) {
  auto chambers = unequal_chambers();
  chambers.conductance.setZero();
  const auto spring = relaxing_spring(chambers, 0.0);
  const double k_h = 5.027e-3 * 5.027e-3 / 1.137e-12 + 2.564e-3 * 2.564e-3 / 0.913e-12;
  EXPECT_NEAR(spring.closed(), k_h, 1e-14 * k_h);
  EXPECT_EQ(spring.rate[0], 0.0);
  EXPECT_EQ(spring.rate[1], 0.0);
}

/// Merritt, Hydraulic Control Systems, section 6: a valve with the flow-pressure coefficient K_c, a
/// piston of area A between two chambers of V_t/2 each, and a mass M have
///     ω_h = √(4 β A²/(V_t M)),   ζ_h = K_ce/A √(β M/V_t),   K_ce = K_c + C_ip + C_ep/2.
/// Poles from M s² + Z(s) = 0, an eigenproblem of four states with both pressures.
TEST(DoubleRodCylinder, WithAMassHasTheDampingOfMerritt) {
  const double beta = 1.37e9, V_t = 2.9e-3, A = 4.3e-3, M = 2330.0;
  const double C_ip = 2.3e-12, C_ep = 0.9e-12;
  model::Supply supply;
  ServoAxis axis;
  axis.area = {A, A};
  axis.volume = {0.5 * V_t, 0.5 * V_t};
  axis.s_mid = 0.6;
  axis.oil = {.bulk_modulus = beta, .cavitation_pressure = 5e4};
  axis.internal_leakage = C_ip;
  axis.external_leakage = C_ep;
  axis.valve = {.gain = 4.1e-7, .overlap = 0.0, .rounding = 0.037, .laminar_pressure = 1e5};
  const auto rest = hydraulic_rest(axis, supply, 0.0);
  ASSERT_TRUE(rest.found);
  const auto chambers = small_chambers(axis, supply, rest, 0.6);

  // K_c of the load flow (Q_A − Q_B)/2 over p_A − p_B, by differences of the valve's own flows.
  const double step = 10.0;
  const auto load_flow = [&](double p_L) {
    const auto flows = valve_flows(
        axis.valve, rest.spool,
        {supply.pressure, supply.return_pressure, rest.p_cap + 0.5 * p_L, rest.p_rod - 0.5 * p_L});
    return 0.5 * (flows.cap - flows.rod);
  };
  const double K_c = -(load_flow(step) - load_flow(-step)) / (2.0 * step);
  const double K_ce = K_c + C_ip + 0.5 * C_ep;
  const double omega_h = std::sqrt(4.0 * beta * A * A / (V_t * M));
  const double zeta_h = K_ce / A * std::sqrt(beta * M / V_t);
  ASSERT_GT(zeta_h, 0.02);
  ASSERT_LT(zeta_h, 0.5);

  const auto spring = relaxing_spring(chambers, 0.0);
  Eigen::Matrix4d system = Eigen::Matrix4d::Zero();  // x, ẋ, two arms
  system(0, 1) = 1.0;
  system(1, 0) = -spring.closed() / M;
  for (int j = 0; j < 2; ++j) {
    const auto at = static_cast<std::size_t>(j);
    system(1, 2 + j) = spring.stiffness[at] / M;
    system(2 + j, 0) = spring.rate[at];
    system(2 + j, 2 + j) = -spring.rate[at];
  }
  int found = 0;
  for (const Complex pole : Eigen::EigenSolver<Eigen::Matrix4d>(system).eigenvalues()) {
    if (pole.imag() <= 0.0) continue;
    ++found;
    EXPECT_NEAR(std::abs(pole), omega_h, 1e-8 * omega_h);
    EXPECT_NEAR(-pole.real() / std::abs(pole), zeta_h, 2e-7 * zeta_h);  // differences for K_c
  }
  EXPECT_EQ(found, 1);
}

model::Leg leg_with_lines() {
  model::Leg leg;
  leg.stroke = model::Stroke{.retracted = 0.4, .length = 0.5};
  leg.oil_spring.cylinder = model::Cylinder{.bore = 0.080,
                                            .rod_diameter = 0.056,
                                            .cap_dead_volume = 20e-6,
                                            .rod_dead_volume = 30e-6,
                                            .cap_line_volume = 471e-6,
                                            .rod_line_volume = 353e-6,
                                            .cap_line_length = 2.9,
                                            .rod_line_length = 2.1,
                                            .density = 883.0,
                                            .bulk_modulus = 907e6};
  return leg;
}

TEST(Hoses, AreInSeriesWithTheOilOfTheirChamber) {
  auto leg = leg_with_lines();
  const double closed = oil_stiffness(leg, 0.63);
  leg.oil_spring.cylinder->cap_line_compliance = 1.3e-12;
  leg.oil_spring.cylinder->rod_line_compliance = 0.7e-12;
  const auto volume = chamber_volumes(*leg.oil_spring.cylinder, *leg.stroke, 0.63);
  const auto [piston, annulus] = areas(*leg.oil_spring.cylinder);
  // springs in series: A²/C each
  const auto series = [](double a, double b) { return a * b / (a + b); };
  const double by_hand =
      series(907e6 * piston * piston / volume.cap, piston * piston / 1.3e-12) +
      series(907e6 * annulus * annulus / volume.rod, annulus * annulus / 0.7e-12);
  EXPECT_NEAR(oil_stiffness(leg, 0.63), by_hand, 1e-13 * by_hand);
  EXPECT_LT(by_hand, 0.8 * closed);
}

/// The chamber of one side as `pieces` of its line, each with inertia and compliance, behind the
/// piston's own oil: the force on the piston per displacement is K − ω² m + O(ω⁴).
double inertia_of_divided_line(double area, double volume, double line_volume, double length,
                               double hose, double beta, double density, int pieces) {
  const double section = line_volume / length;
  const double C_piece = (line_volume / beta + hose) / pieces;
  const double L_piece = density * (length / pieces) / section;  // [Pa s²/m³]
  const auto stiffness = [&](double omega2) {
    // from the closed end: p = q/C with q the volume that has entered; half an inertia at both ends
    double compliance = 0.0;  // volume per pressure at the entry of what lies behind
    for (int k = 0; k < pieces; ++k) {
      const auto behind_inertia = [&](double c) { return c / (1.0 - omega2 * 0.5 * L_piece * c); };
      compliance = behind_inertia(behind_inertia(compliance) + C_piece);
    }
    return area * area / ((volume - line_volume) / beta + compliance);
  };
  const double closed = area * area / (volume / beta + hose), omega2 = 4.0;
  return (closed - stiffness(omega2)) / omega2;
}

TEST(LineInertia, IsThatOfADividedLineWithAClosedEnd) {
  auto leg = leg_with_lines();
  for (const double hose : {0.0, 0.9e-12}) {
    leg.oil_spring.cylinder->cap_line_compliance = hose;
    leg.oil_spring.cylinder->rod_line_compliance = 0.4 * hose;
    const auto [piston, annulus] = areas(*leg.oil_spring.cylinder);
    for (const double l_m : {0.41, 0.63, 0.88}) {
      const auto volume = chamber_volumes(*leg.oil_spring.cylinder, *leg.stroke, l_m);
      const double by_pieces =
          inertia_of_divided_line(piston, volume.cap, 471e-6, 2.9, hose, 907e6, 883.0, 2000) +
          inertia_of_divided_line(annulus, volume.rod, 353e-6, 2.1, 0.4 * hose, 907e6, 883.0, 2000);
      const double m = line_inertia(leg, l_m);
      EXPECT_NEAR(m, by_pieces, 1e-4 * by_pieces) << l_m;
      EXPECT_GT(m, 0.1);
    }
  }
}

/// The whole column would move with an open end: ρ L A_c²/A.
TEST(LineInertia, OfALineThatIsTheWholeChamberIsAThirdOfTheOpenColumns) {
  auto leg = leg_with_lines();
  auto& cylinder = *leg.oil_spring.cylinder;
  cylinder.rod_line_length = 0.0;
  cylinder.cap_dead_volume = 0.0;
  const double A = areas(cylinder).piston;
  const double open = 883.0 * 2.9 * A * A / (471e-6 / 2.9);
  EXPECT_NEAR(line_inertia(leg, 0.4), open / 3.0, 1e-12 * open);
}

TEST(LineInertia, IsZeroWithoutLengths) {
  auto leg = leg_with_lines();
  leg.oil_spring.cylinder->cap_line_length = leg.oil_spring.cylinder->rod_line_length = 0.0;
  EXPECT_EQ(line_inertia(leg, 0.5), 0.0);
  leg.oil_spring = {.stiffness = 3e6};
  EXPECT_EQ(line_inertia(leg, 0.5), 0.0);
}

}  // namespace
}  // namespace hydrapod::hydraulics
