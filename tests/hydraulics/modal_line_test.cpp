/// Lines by their modes against the uniform transmission line, whose solution is in cosh and sinh,
/// and against as many segments.

#include <fmt/format.h>
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

/// A pipe with a hose, and the chamber behind it.
struct Pipe {
  using Complex = std::complex<double>;
  static constexpr double beta = 1.093e9, density = 868.7, length = 4.13, volume = 0.971e-3;
  static constexpr double hose = 0.109e-12;    // [m³/Pa] of the whole line
  static constexpr double chamber = 2.39e-12;  // [m³/Pa] behind it
  static constexpr double section = volume / length;
  static constexpr double inertance = density * length / section;
  static constexpr double capacity = volume / beta + hose;
  static constexpr double rest = 8.9e6;  // [Pa]
  double viscosity{};

  /// Of Hagen and Poiseuille.
  [[nodiscard]] double resistance() const {
    const double diameter = std::sqrt(4.0 * section / std::numbers::pi);
    return 128.0 * viscosity * length / (std::numbers::pi * std::pow(diameter, 4));
  }
  [[nodiscard]] model::Machine machine(const model::Lines& lines) const {
    model::Machine machine;
    machine.hydraulics.lines = lines;
    machine.hydraulics.lines.viscosity = viscosity;
    machine.legs[4].oil_spring.cylinder = model::Cylinder{.cap_line_volume = volume,
                                                          .cap_line_length = length,
                                                          .cap_line_compliance = hose,
                                                          .density = density};
    return machine;
  }
  [[nodiscard]] ModalLine of_modes(int N) const {
    const auto lines = leg_lines(machine({.modes = static_cast<double>(N)}), 4);
    EXPECT_EQ(states(lines.rod), 0);
    return std::get<ModalLine>(lines.cap);
  }
  [[nodiscard]] SegmentedLine of_segments(int N) const {
    return std::get<SegmentedLine>(leg_lines(machine({.segments = static_cast<double>(N)}), 4).cap);
  }

  /// Pressures [Pa] at the valve and in the chamber per flow of the valve [m³/s].
  struct Ends {
    Complex valve{}, chamber{};
  };
  /// Z_c = √((sI + R)/sC), Γ = √((sI + R) sC): p = Q/(sinh Γ/Z_c + s C_c cosh Γ).
  [[nodiscard]] Ends exact(double omega) const {
    const Complex s(0.0, omega), Z = s * inertance + resistance();
    const Complex gamma = std::sqrt(Z * s * capacity), Z_c = Z / gamma;
    const Complex p = 1.0 / (std::sinh(gamma) / Z_c + s * chamber * std::cosh(gamma));
    return {(std::cosh(gamma) + Z_c * std::sinh(gamma) * s * chamber) * p, p};
  }
};

const Oil pipe_oil{.bulk_modulus = Pipe::beta, .cavitation_pressure = 5e4};

/// ẋ = A x + b Q of a line with its chamber, whose pressure is the last state; flows in nl/(s Pa).
struct PipeSystem {
  static constexpr double flow_unit = 1e-9;
  Eigen::MatrixXd A{};
  Eigen::VectorXd b{};
  Eigen::VectorXd valve{};  ///< the pressure there per state

  /// `chamber_rate(state, flow, p)`: of the chamber's pressure.
  template <class Line, class ChamberRate, class AtValve>
  PipeSystem(const Line& line, const ChamberRate& chamber_rate, const AtValve& at_valve) {
    const int n = line.states(), N = n / 2;
    const auto rates = [&](const Eigen::VectorXd& x, double flow) {
      Eigen::VectorXd at = x, rate(n + 1);
      at.segment(N, N) *= flow_unit;
      line_rates(line, pipe_oil, at.data(), flow * flow_unit, at[n], rate.data());
      rate.segment(N, N) /= flow_unit;
      rate[n] = chamber_rate(at.data(), flow * flow_unit, at[n]);
      return rate;
    };
    // the lines are linear where β does not change
    const Eigen::VectorXd rest = Eigen::VectorXd::Constant(n + 1, Pipe::rest);
    const Eigen::VectorXd zero = rates(rest, 0.0);
    A.resize(n + 1, n + 1);
    valve.resize(n + 1);
    constexpr double size = 65536.0;
    for (int k = 0; k <= n; ++k) {
      const Eigen::VectorXd moved = rest + size * Eigen::VectorXd::Unit(n + 1, k);
      A.col(k) = (rates(moved, 0.0) - zero) / size;
      valve[k] = (at_valve(moved.data(), moved[n]) - at_valve(rest.data(), rest[n])) / size;
    }
    b = rates(rest, size) / size - zero / size;
  }

  [[nodiscard]] Pipe::Ends response(double omega) const {
    const auto n = A.rows();
    const Eigen::MatrixXcd D = std::complex<double>(0.0, omega) * Eigen::MatrixXcd::Identity(n, n) -
                               A.cast<std::complex<double>>();
    const Eigen::VectorXcd x = D.partialPivLu().solve(b.cast<std::complex<double>>()) / flow_unit;
    return {(valve.transpose() * x).value(), x[n - 1]};
  }
  [[nodiscard]] std::vector<double> waves() const {
    std::vector<double> found;
    for (const auto& pole : Eigen::EigenSolver<Eigen::MatrixXd>(A).eigenvalues())
      if (pole.imag() > 1.0) found.push_back(pole.imag());
    std::ranges::sort(found);
    return found;
  }
};

PipeSystem system_of(const ModalLine& line) {
  const double capacity = Pipe::chamber + line.with_chamber() * Pipe::capacity;
  return {line,
          [&, capacity](const double* x, double flow, double) {
            return chamber_inflow(line, x, flow) / capacity;
          },
          [&](const double* x, double p) { return valve_pressure(line, x, p); }};
}

PipeSystem system_of(const SegmentedLine& line) {
  const double capacity = Pipe::chamber + 0.5 * Pipe::capacity / line.segments;
  return {
      line,
      [&, capacity](const double* x, double, double) { return x[line.states() - 1] / capacity; },
      [](const double* x, double) { return x[0]; }};
}

/// Of the pressures at both ends, the worst of frequencies up to `highest` [rad/s].
double worst_error(const PipeSystem& system, const Pipe& pipe, double highest) {
  double worst = 0.0;
  for (int k = 1; k <= 40; ++k) {
    const double omega = highest * k / 40.0;
    const auto exact = pipe.exact(omega), found = system.response(omega);
    worst = std::max({worst, std::abs(found.valve - exact.valve) / std::abs(exact.valve),
                      std::abs(found.chamber - exact.chamber) / std::abs(exact.chamber)});
  }
  return worst;
}

/// ω of the line behind a shut valve without loss: tan θ = −θ C_c/C, θ = ωL/c, by bisection.
double shut_wave(int number) {
  const auto f = [](double x) {
    return std::sin(x) * Pipe::capacity + x * Pipe::chamber * std::cos(x);
  };
  double low = (number - 0.5) * std::numbers::pi, high = number * std::numbers::pi;
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    ((f(middle) > 0.0) == (f(low) > 0.0) ? low : high) = middle;
  }
  return low / std::sqrt(Pipe::inertance * Pipe::capacity);
}

TEST(ModalLine, RespondsAsTheUniformLineByTheThirdOrder) {
  for (const double viscosity : {0.0, 0.151})
    for (const double omega : {97.0, 307.0, 577.0, 1190.0}) {
      const Pipe pipe{viscosity};
      const auto exact = pipe.exact(omega);
      double error[3]{}, valve_error[3]{};
      int k = 0;
      for (const int N : {8, 16, 32}) {
        const auto line = pipe.of_modes(N);
        const auto found = system_of(line).response(omega);
        error[k] = std::abs(found.chamber - exact.chamber) / std::abs(exact.chamber);
        valve_error[k++] = std::abs(found.valve - exact.valve) / std::abs(exact.valve);
      }
      EXPECT_LT(error[2], 2e-4) << omega;
      EXPECT_LT(valve_error[2], 2e-4) << omega;
      for (const auto* of : {error, valve_error}) {
        if (of[2] < 1e-8) continue;  // rounding
        EXPECT_GT(std::log2(of[0] / of[1]), 2.6) << omega << ' ' << viscosity;
        EXPECT_GT(std::log2(of[1] / of[2]), 2.7) << omega << ' ' << viscosity;
      }
    }
}

/// What docs/theory/hydraulics.md says of as many modes and segments.
TEST(ModalLine, IsFarCloserToTheUniformLineThanAsManySegments) {
  const Pipe pipe{0.04}, lossless{0.0};
  const double first = shut_wave(1), second = shut_wave(2);
  fmt::print("{:>3} {:>22} {:>22} {:>22}\n", "N", "first wave, %", "second wave, %",
             "pressures to 0.8 ω1, %");
  for (const int N : {1, 2, 3, 4, 5, 6, 8}) {
    const auto segments = lossless.of_segments(N);
    const auto modes = lossless.of_modes(N);
    const auto of_segments = system_of(segments).waves(), of_modes = system_of(modes).waves();
    const auto lossy_segments = pipe.of_segments(N);
    const auto lossy_modes = pipe.of_modes(N);
    const auto wave = [&](const std::vector<double>& found, std::size_t k, double omega) {
      return k < found.size() ? found[k] / omega - 1.0 : std::nan("");
    };
    const double s1 = wave(of_segments, 0, first), m1 = wave(of_modes, 0, first);
    const double s2 = wave(of_segments, 1, second), m2 = wave(of_modes, 1, second);
    const double s = worst_error(system_of(lossy_segments), pipe, 0.8 * first);
    const double m = worst_error(system_of(lossy_modes), pipe, 0.8 * first);
    fmt::print("{:>3} {:>10.3f} {:>11.4f} {:>10.2f} {:>11.3f} {:>10.2f} {:>11.3f}\n", N, 100.0 * s1,
               100.0 * m1, 100.0 * s2, 100.0 * m2, 100.0 * s, 100.0 * m);
    EXPECT_LT(std::abs(m1), std::abs(s1) / (N == 1 ? 1.0 : 2.5 * N)) << N;
    EXPECT_LT(m, s / (N == 1 ? 3.0 : 4.0 * N)) << N;
    if (N > 2) {
      EXPECT_LT(std::abs(m2), std::abs(s2) / 5.0) << N;
    }
  }
}

TEST(ModalLine, BehindAShutValveHasTheWavesOfADeadEnd) {
  const Pipe pipe{0.0};
  for (const int number : {1, 2, 3}) {
    const double omega = shut_wave(number);
    const auto at = static_cast<std::size_t>(number - 1);
    double error[2]{};
    int k = 0;
    for (const int N : {8, 16}) {
      const auto line = pipe.of_modes(N);
      error[k++] = std::abs(system_of(line).waves()[at] / omega - 1.0);
    }
    EXPECT_LT(error[0], 2e-3) << number;
    EXPECT_NEAR(std::log2(error[0] / error[1]), 3.0, 0.35) << number;
  }
}

/// A steady flow loses R Q, and slow oil is all there, whatever N is.
TEST(ModalLine, IsExactWhereItIsSteadyOrSlow) {
  const Pipe pipe{0.213};
  for (const int N : {1, 2, 3, 8}) {
    const auto line = pipe.of_modes(N);
    const double flow = 0.37e-3, p = 7.3e6, at_valve = p + pipe.resistance() * flow;
    EXPECT_NEAR(line.loss(), pipe.resistance(), 1e-12 * line.loss());
    Eigen::VectorXd x(line.states()), rate(line.states());
    steady_line(line, at_valve, p, flow, x.data());
    line_rates(line, pipe_oil, x.data(), flow, p, rate.data());
    EXPECT_LT(rate.head(N).cwiseAbs().maxCoeff() * Pipe::capacity, 1e-12 * flow);
    EXPECT_LT(rate.tail(N).cwiseAbs().maxCoeff() * Pipe::inertance, 1e-8 * at_valve);
    EXPECT_NEAR(valve_pressure(line, x.data(), p), at_valve, 1e-9 * at_valve);
    EXPECT_NEAR(chamber_inflow(line, x.data(), flow), flow, 1e-12 * flow);
    EXPECT_NEAR(line_dissipation(line, x.data()), (at_valve - p) * flow,
                1e-9 * (at_valve - p) * flow);

    const double omega = 0.03, total = Pipe::chamber + Pipe::capacity;
    const auto slow = system_of(line).response(omega);
    EXPECT_NEAR((1.0 / (std::complex<double>(0.0, omega) * slow.chamber)).real(), total,
                1e-7 * total);
  }
}

/// Energy of the fields, of the capacities at the ends and between them: what goes in at both ends
/// is kept or lost, whatever the chamber's pressure does.
TEST(ModalLine, LosesWhatIsLetIn) {
  test::Random random(17);
  const Pipe pipe{0.171};
  for (const int N : {1, 2, 5, 8}) {
    const auto line = pipe.of_modes(N);
    const double C = Pipe::capacity, I = Pipe::inertance;
    for (int k = 0; k < 10; ++k) {
      Eigen::VectorXd x(line.states()), rate(line.states());
      for (int j = 0; j < N; ++j) {
        x[j] = random.uniform(-4e6, 2e7);
        x[N + j] = random.uniform(-1e-3, 1e-3);
      }
      const double flow = random.uniform(-1e-3, 1e-3), p = random.uniform(3e6, 2e7),
                   p_rate = random.uniform(-1e9, 1e9);
      line_rates(line, pipe_oil, x.data(), flow, p, rate.data());
      const double at_valve = valve_pressure(line, x.data(), p);
      const double valve_rate = rate[0] - line.tilt() * p_rate;
      const double out = chamber_inflow(line, x.data(), flow) - C * line.with_chamber() * p_rate;
      double stored = C * (line.own * (at_valve * valve_rate + p * p_rate) +
                           line.across * (at_valve * p_rate + p * valve_rate));
      double size = std::abs(stored);
      for (int n = 0; n < N; ++n) {
        const double moving = (n == 0 ? 1.0 : 0.5) * I * x[N + n] * rate[N + n];
        const double pressed = n == 0 ? 0.0 : 0.5 * C * x[n] * rate[n];
        stored += moving + pressed;
        size += std::abs(moving) + std::abs(pressed);
      }
      const double let_in = at_valve * flow - p * out;
      EXPECT_NEAR(stored + line_dissipation(line, x.data()), let_in,
                  1e-12 * (size + std::abs(let_in)));
      EXPECT_GT(line_kinetic_energy(line, x.data()), 0.0);
    }
  }
}

TEST(ModalLine, IsToldInTheAssumptionsAsSegmentsAre) {
  auto machine = simulation::machine_of("heavy-platform");
  for (auto& leg : machine.legs) leg.oil_spring.cylinder->cap_line_length = 3.3;
  machine.hydraulics.lines.segments = 4.0;
  const auto segments = hydraulic_assumptions(machine).back();
  machine.hydraulics.lines = {.modes = 3.0};
  const auto modes = hydraulic_assumptions(machine).back();
  EXPECT_EQ(modes.key, "lines");
  EXPECT_EQ(modes.text, segments.text);
}

}  // namespace
}  // namespace hydrapod::hydraulics
