/// Lines in segments against the uniform transmission line, whose solution is in cosh and sinh.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>

#include "hydrapod/hydraulics/lines.hpp"
#include "support/loop_machine.hpp"
#include "support/random.hpp"

namespace hydrapod::hydraulics {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::Random;

constexpr double beta = 1.137e9, density = 871.3, length = 3.71, volume = 0.893e-3;
constexpr double section = volume / length;
constexpr double hose = 0.117e-12;     // [m³/Pa] of the whole line
constexpr double chamber = 2.713e-12;  // [m³/Pa] behind it
constexpr double rest_pressure = 9.3e6;
const Oil oil{.bulk_modulus = beta, .cavitation_pressure = 5e4};

/// Ugly numbers on leg 3.
SegmentedLine line_of(double segments, double viscosity) {
  model::Machine machine;
  machine.hydraulics.lines = {.segments = segments, .viscosity = viscosity};
  machine.legs[2].oil_spring.cylinder = model::Cylinder{.rod_line_volume = volume,
                                                        .rod_line_length = length,
                                                        .rod_line_compliance = hose,
                                                        .density = density};
  const auto lines = leg_lines(machine, 2);
  EXPECT_EQ(states(lines.cap), 0);
  EXPECT_EQ(states(leg_lines(machine, 1).rod), 0);
  return std::get<SegmentedLine>(lines.rod);
}

/// ẋ = A x + b Q of the line with the chamber, whose pressure is the last state; flows in shares of
/// 1e-9 m³/s per Pa, so that all numbers are of one size. Linear as long as β is constant.
constexpr double flow_unit = 1e-9;
struct Chain {
  MatrixXd A{};
  VectorXd b{};
};

Chain chain_of(const SegmentedLine& line) {
  const int n = line.states(), N = line.segments;
  const auto rates = [&](const VectorXd& x, double flow) {
    VectorXd at = x, rate(n + 1);
    at.segment(N, N) *= flow_unit;
    at.head(N).array() += rest_pressure;
    line_rates(line, oil, at.data(), flow * flow_unit, rest_pressure + x[n], rate.data());
    rate.segment(N, N) /= flow_unit;
    const double half = 0.5 * (line.volume / beta + line.compliance);
    rate[n] = at[n - 1] / (chamber + half);
    return rate;
  };
  const VectorXd zero = VectorXd::Zero(n + 1);
  Chain chain{MatrixXd(n + 1, n + 1), rates(zero, 1.0)};
  constexpr double size = 1024.0;  // of changes: adding it to the rest pressure costs no digits
  for (int k = 0; k <= n; ++k) chain.A.col(k) = rates(size * VectorXd::Unit(n + 1, k), 0.0) / size;
  return chain;
}

/// Pressures [Pa] at the valve and in the chamber per flow of the valve [m³/s].
struct Impedances {
  Complex valve{}, chamber{};
};

Impedances of_chain(const Chain& chain, double omega) {
  const auto n = chain.A.rows();
  const Eigen::MatrixXcd D =
      Complex(0.0, omega) * Eigen::MatrixXcd::Identity(n, n) - chain.A.cast<Complex>();
  const Eigen::VectorXcd x = D.partialPivLu().solve(chain.b.cast<Complex>()) / flow_unit;
  return {x[0], x[n - 1]};
}

/// Z_c = √((sI + R)/sC), Γ = √((sI + R) sC) of the whole line.
struct ExactLine {
  Complex Z_c{}, cosh{}, sinh{};
  ExactLine(Complex s, double viscosity) {
    const double C = volume / beta + hose, I = density * length / section;
    const double diameter = std::sqrt(4.0 * section / std::numbers::pi);
    const double R =  // Hagen and Poiseuille
        128.0 * viscosity * length / (std::numbers::pi * std::pow(diameter, 4));
    const Complex gamma = std::sqrt((s * I + R) * s * C);
    Z_c = (s * I + R) / gamma;
    cosh = std::cosh(gamma);
    sinh = std::sinh(gamma);
  }
};

Impedances exact(double omega, double viscosity) {
  const Complex s(0.0, omega);
  const ExactLine line(s, viscosity);
  const Complex p = 1.0 / (line.sinh / line.Z_c + s * chamber * line.cosh);
  return {(line.cosh + line.Z_c * line.sinh * s * chamber) * p, p};
}

TEST(SegmentedLine, RespondsAsTheUniformLine) {
  for (const double viscosity : {0.0, 0.137})
    for (const double omega : {1.3, 71.0, 310.0, 613.0, 1270.0}) {
      const auto uniform = exact(omega, viscosity);
      double error[3]{}, valve_error[3]{};
      int k = 0;
      for (const double N : {32.0, 64.0, 128.0}) {
        const auto found = of_chain(chain_of(line_of(N, viscosity)), omega);
        error[k] = std::abs(found.chamber - uniform.chamber) / std::abs(uniform.chamber);
        valve_error[k++] = std::abs(found.valve - uniform.valve) / std::abs(uniform.valve);
      }
      EXPECT_LT(error[2], 5e-3) << omega;
      if (omega < 100.0) continue;  // rounding
      for (const auto* of : {error, valve_error}) {
        EXPECT_NEAR(std::log2(of[0] / of[1]), 2.0, 0.05) << omega << ' ' << viscosity;
        EXPECT_NEAR(std::log2(of[1] / of[2]), 2.0, 0.02) << omega << ' ' << viscosity;
      }
    }
}

/// θ = ωL/c with tan θ = −θ C_chamber/C_line: a line closed by the valve, by bisection.
double dead_end_wave(int number) {
  const double C = volume / beta + hose;
  const auto f = [&](double x) { return std::sin(x) * C + x * chamber * std::cos(x); };
  double low = (number - 0.5) * std::numbers::pi, high = number * std::numbers::pi;
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    ((f(middle) > 0.0) == (f(low) > 0.0) ? low : high) = middle;
  }
  return low / std::sqrt(density * length / section * C);
}

std::vector<double> waves_of(const SegmentedLine& line) {
  std::vector<double> found;
  for (const Complex pole : Eigen::EigenSolver<MatrixXd>(chain_of(line).A).eigenvalues())
    if (pole.imag() > 1.0) found.push_back(pole.imag());
  std::ranges::sort(found);
  return found;
}

TEST(SegmentedLine, BehindAShutValveHasTheWavesOfADeadEnd) {
  for (const int number : {1, 2, 3}) {
    const double omega = dead_end_wave(number);
    const auto at = static_cast<std::size_t>(number - 1);
    double error[3]{};
    int k = 0;
    for (const double N : {16.0, 32.0, 64.0})
      error[k++] = 1.0 - waves_of(line_of(N, 0.0))[at] / omega;
    EXPECT_NEAR(std::log2(error[0] / error[1]), 2.0, 0.05) << number;
    EXPECT_NEAR(std::log2(error[1] / error[2]), 2.0, 0.02) << number;
  }
  // what docs/theory/hydraulics.md says of few segments
  EXPECT_NEAR(1.0 - waves_of(line_of(3.0, 0.0))[0] / dead_end_wave(1), 0.0168, 3e-4);
  EXPECT_NEAR(1.0 - waves_of(line_of(8.0, 0.0))[0] / dead_end_wave(1), 0.00239, 4e-5);
}

/// The quarter wave, where the chamber is so large that its pressure stands.
TEST(SegmentedLine, HasAQuarterWaveBeforeALargeChamber) {
  const double quarter =
      0.5 * std::numbers::pi / std::sqrt(density * length / section * (volume / beta + hose));
  EXPECT_GT(dead_end_wave(1), quarter);
  EXPECT_LT(dead_end_wave(1), 1.13 * quarter);
}

TEST(SegmentedLine, LosesWhatIsLet) {
  Random random(5);
  const auto line = line_of(5.0, 0.213);
  const int N = line.segments;
  for (int k = 0; k < 20; ++k) {
    VectorXd x(line.states()), rate(line.states());
    for (int j = 0; j < N; ++j) {
      x[j] = random.uniform(3e6, 2e7);
      x[N + j] = random.uniform(-1e-3, 1e-3);
    }
    const double flow = random.uniform(-1e-3, 1e-3), p = random.uniform(3e6, 2e7);
    line_rates(line, oil, x.data(), flow, p, rate.data());
    const double I = density * length / section / N, C = (volume / beta + hose) / N;
    double stored = 0.0, power = 0.0;
    for (int j = 0; j < N; ++j) {
      stored += (j == 0 ? 0.5 : 1.0) * C * x[j] * rate[j] + I * x[N + j] * rate[N + j];
      power += 1e-14 * std::abs(I * x[N + j] * rate[N + j]);
    }
    const double let = x[0] * flow - p * x[2 * N - 1];
    EXPECT_NEAR(stored + line_dissipation(line, x.data()), let, 100.0 * power + 1e-12 * 2e7 * 1e-3);
    EXPECT_NEAR(line_kinetic_energy(line, x.data()), 0.5 * I * x.tail(N).squaredNorm(),
                1e-13 * I * x.tail(N).squaredNorm());
    EXPECT_GT(line_dissipation(line, x.data()), 0.0);
  }
}

/// As slow as one likes, the oil of a dead end has the inertia ρ L A_c²/A σ²/3, and N segments have
/// 1 − 1/4N² times that.
TEST(SegmentedLine, IsTheDeadEndsInertiaWhereItIsSlow) {
  const double C = volume / beta + hose, I = density * length / section, omega = 3.0;
  for (const int N : {1, 2, 5}) {
    const auto chain = chain_of(line_of(N, 0.0));
    // volume into the chamber per pressure, both ends shut: C_total + ω² I C² (1/3 − 1/12N²)
    const auto n = chain.A.rows();
    Eigen::MatrixXcd D =
        Complex(0.0, omega) * Eigen::MatrixXcd::Identity(n, n) - chain.A.cast<Complex>();
    const Complex p = D.inverse()(n - 1, n - 1);  // per rate of the chamber's own pressure
    const double capacity = chamber + C / (2.0 * N), total = chamber + C;
    const double compliance = (capacity / (Complex(0.0, omega) * p)).real();
    const double expected = total + omega * omega * I * C * C * (1.0 / 3.0 - 1.0 / (12.0 * N * N));
    EXPECT_NEAR((compliance - total) / (expected - total), 1.0, 1e-3) << N;
  }
}

TEST(Assumptions, TellOfPipesAndTheirQuarterWaves) {
  auto machine = simulation::machine_of("heavy-platform");
  const auto before = hydraulic_assumptions(machine).size();
  for (auto& leg : machine.legs) {
    leg.oil_spring.cylinder->air.reset();
    leg.oil_spring.cylinder->cap_line_length = 3.3;
  }
  EXPECT_EQ(hydraulic_assumptions(machine).size(), before);
  machine.hydraulics.lines.segments = 4.0;
  auto said = hydraulic_assumptions(machine);
  ASSERT_EQ(said.size(), before + 1);
  // √(4·0.9e-3/3.3π) and √(1.4e9/870)/(4·3.3)
  EXPECT_EQ(said.back().key, "lines");
  EXPECT_EQ(said.back().text,
            "round pipes of 18.6 mm by their volumes and lengths; quarter waves (c/4L) at 96.1 Hz");
  machine.legs[4].oil_spring.cylinder->rod_line_length = 1.9;
  EXPECT_EQ(hydraulic_assumptions(machine).back().text,
            "round pipes of 18.6 to 24.6 mm by their volumes and lengths; quarter waves (c/4L) at "
            "96.1 to 167 Hz");
}

TEST(HydraulicRest, LosesPressureInLines) {
  auto machine = simulation::machine_of("heavy-platform");
  const auto& supply = machine.hydraulics.supply;
  const auto axis = servo_axis(machine, 3);
  const LinesOf<double> loss{7.1e10, 13.3e10};
  const auto without = hydraulic_rest(axis, supply, 23.1e3);
  const auto rest = hydraulic_rest(axis, supply, 23.1e3, loss);
  ASSERT_TRUE(rest.found);
  EXPECT_EQ(without.valve_pressure.cap, without.p_cap);
  EXPECT_EQ(without.valve_pressure.rod, without.p_rod);
  EXPECT_NEAR(axis.force(rest.p_cap, rest.p_rod), 23.1e3, 1e-6);
  const auto flows = valve_flows(
      axis.valve, rest.spool,
      {supply.pressure, supply.return_pressure, rest.valve_pressure.cap, rest.valve_pressure.rod});
  const double past = axis.internal_leakage * (rest.p_cap - rest.p_rod);
  EXPECT_NEAR(flows.cap, past, 1e-9 * past);
  EXPECT_NEAR(flows.rod, -past, 1e-9 * past);
  EXPECT_NEAR(rest.valve_pressure.cap - rest.p_cap, loss.cap * past, 1e-8 * loss.cap * past);
  EXPECT_NEAR(rest.valve_pressure.rod - rest.p_rod, -loss.rod * past, 1e-8 * loss.rod * past);
  EXPECT_GT(loss.cap * past, 1e4);  // else there is nothing to see
  EXPECT_NE(rest.spool, without.spool);
}

}  // namespace
}  // namespace hydrapod::hydraulics
