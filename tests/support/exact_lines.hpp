#pragma once
/// A machine with lines, and its poles on uniform lines by their exact solution.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/numerics/dense.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "support/loop_machine.hpp"

namespace hydrapod::simulation::exact_lines {

using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using model::leg_count;
using model::Machine;

constexpr double cap_length(int leg) { return 2.9 + 0.31 * leg; }
constexpr double rod_length(int leg) { return 2.6 + 0.09 * leg; }

/// Heavy platform with lines of different lengths, no air, and laws that are smooth.
inline Machine with_lines(const model::Lines& lines) {
  auto machine = machine_of("heavy-platform");
  machine.hydraulics.lines = lines;
  for (int i = 0; i < leg_count; ++i) {
    auto& leg = machine.legs[static_cast<std::size_t>(i)];
    auto& cylinder = *leg.oil_spring.cylinder;
    cylinder.cap_line_length = cap_length(i);
    cylinder.rod_line_length = rod_length(i);
    cylinder.cap_line_compliance = 0.071e-12;
    cylinder.density = 873.0;
    cylinder.air.reset();
    leg.added_axial_inertia = 0.0;
    leg.hydraulics.leakage = {.internal = 0.0, .external = 0.0};
  }
  return machine;
}

inline Machine with_lines(int segments, double viscosity = 0.0) {
  return with_lines({.segments = static_cast<double>(segments), .viscosity = viscosity});
}

inline Pose tilted(const Machine& machine) {
  Pose pose = machine.neutral();
  pose.p_BP += Vector3(0.04, -0.07, 0.05);
  pose.R_BP = spatial::rotation_from_rpy({0.03, -0.05, 0.07}) * pose.R_BP;
  return pose;
}

// ---- Poles of the machine on exact lines ----------------------------------------------------

/// A uniform line between a chamber and a valve of the conductance g = −∂Q/∂p.
struct ExactLine {
  double inertance{}, resistance{}, capacity{}, valve{};

  ExactLine(const model::Cylinder& cylinder, bool cap, double viscosity, double g) : valve(g) {
    const double length = cap ? cylinder.cap_line_length : cylinder.rod_line_length;
    const double volume = cap ? cylinder.cap_line_volume : cylinder.rod_line_volume;
    const double section = volume / length;
    const double diameter = std::sqrt(4.0 * section / std::numbers::pi);
    inertance = cylinder.density * length / section;
    resistance = 128.0 * viscosity * length / (std::numbers::pi * std::pow(diameter, 4));
    capacity = volume / cylinder.bulk_modulus +
               (cap ? cylinder.cap_line_compliance : cylinder.rod_line_compliance);
  }
  /// Flow out of the chamber per its pressure.
  [[nodiscard]] Complex admittance(Complex s) const {
    const Complex Z = s * inertance + resistance, Y = s * capacity;
    const Complex gamma = std::sqrt(Z * Y), Z_c = Z / gamma;
    const Complex ch = std::cosh(gamma), sh = std::sinh(gamma);
    return (sh / Z_c + valve * ch) / (ch + valve * Z_c * sh);
  }
};

/// The rigid machine at rest: D(s) = M s² + K_0 + Σ k_leg(s) nᵀ n.
class ExactMachine {
 public:
  ExactMachine(const Machine& machine, const Pose& X_BP) {
    const auto dead = hydraulics::without_line_inertia(machine);
    const auto linear = dynamics::linear_model(dead, X_BP, ModelKind::rigid);
    M_ = linear.M;
    K_ = linear.K;
    const Plant plant(machine, ModelKind::rigid, {.friction = Friction::none}, X_BP);
    const auto rest = plant.equilibrium(X_BP);
    const auto out = plant.outputs(rest.x.data(), rest.input);
    for (std::size_t i = 0; i < leg_count; ++i) {
      const auto& leg = machine.legs[i];
      const auto& cylinder = *leg.oil_spring.cylinder;
      const auto& on = out.legs[i];
      n_[i] = linear.J[i].row(2);
      K_ -= hydraulics::oil_stiffness(leg, on.piston) * n_[i].transpose() * n_[i];
      const auto volume = hydraulics::chamber_volumes(cylinder, *leg.stroke, on.piston);
      const auto area = hydraulics::areas(cylinder);
      const auto& supply = machine.hydraulics.supply;
      const auto slopes = hydraulics::valve_flow_slopes(
          plant.axis(static_cast<int>(i)).valve, on.spool,
          {supply.pressure, supply.return_pressure, on.cap_valve_pressure, on.rod_valve_pressure});
      const double mu = machine.hydraulics.lines.viscosity, beta = cylinder.bulk_modulus;
      chambers_.push_back({i, area.piston, (volume.cap - cylinder.cap_line_volume) / beta,
                           ExactLine(cylinder, true, mu, -slopes.cap_p)});
      chambers_.push_back({i, area.annulus, (volume.rod - cylinder.rod_line_volume) / beta,
                           ExactLine(cylinder, false, mu, -slopes.rod_p)});
    }
  }

  /// The root of 1/(uᵀ D(s)⁻¹ v) near `s`, by secants.
  [[nodiscard]] Complex pole_near(Complex s) const {
    Complex before = s * (1.0 + 1e-5), f_before = reciprocal(before);
    for (int k = 0; k < 60; ++k) {
      const Complex f = reciprocal(s);
      if (f == f_before) break;
      const Complex next = s - f * (s - before) / (f - f_before);
      before = s;
      f_before = f;
      s = next;
      if (std::abs(s - before) < 1e-13 * std::abs(s)) break;
    }
    return s;
  }

 private:
  struct Chamber {
    std::size_t leg{};
    double area{}, capacity{};
    ExactLine line;
  };

  /// Platform and pressures [MPa] of the chambers, so that no root is near a pole.
  [[nodiscard]] Complex reciprocal(Complex s) const {
    constexpr double unit = 1e6;
    constexpr int n = 6 + 2 * leg_count;
    Eigen::MatrixXcd D = Eigen::MatrixXcd::Zero(n, n);
    D.topLeftCorner<6, 6>() = s * s * M_.cast<Complex>() + K_.cast<Complex>();
    for (int c = 0; c < 2 * leg_count; ++c) {
      const auto& chamber = chambers_[static_cast<std::size_t>(c)];
      const Eigen::Matrix<Complex, 1, 6> push = chamber.area * n_[chamber.leg].cast<Complex>();
      D.block<6, 1>(0, 6 + c) = -unit * push.transpose();
      D.block<1, 6>(6 + c, 0) = unit * s * push;
      D(6 + c, 6 + c) = unit * unit * (s * chamber.capacity + chamber.line.admittance(s));
    }
    Eigen::VectorXcd u(n), v(n);
    for (int i = 0; i < n; ++i) {
      u[i] = 1.0 + 0.3 * i;
      v[i] = 1.7 - 0.4 * i * i + 0.02 * i * i * i;
    }
    return 1.0 / (u.transpose() * D.partialPivLu().solve(v)).value();
  }

  spatial::Matrix6 M_{}, K_{};
  std::array<Eigen::Matrix<double, 1, 6>, leg_count> n_{};
  std::vector<Chamber> chambers_{};
};

/// Poles of the plant that oscillate, by frequency: six of the platform, one of each of the cap
/// side's lines, then of the rod side's, and higher ones.
inline std::vector<Complex> plant_poles(const Machine& machine, const Pose& X_BP,
                                        std::size_t count) {
  const Plant plant(machine, ModelKind::rigid, {.friction = Friction::none}, X_BP);
  const auto rest = plant.equilibrium(X_BP);
  MatrixXd A = plant.linearise(rest.x, rest.input).A;
  const int spools = plant.layout().spools - 1;
  A.middleCols(spools, 12).setZero();  // they are held
  A.middleRows(spools, 12).setZero();
  const VectorXd d = numerics::balancing(A);
  std::vector<Complex> poles;
  for (const Complex pole :
       numerics::eigenvalues(d.cwiseInverse().asDiagonal() * A * d.asDiagonal()))
    if (pole.imag() > 1.0) poles.push_back(pole);
  std::ranges::sort(poles, {}, [](Complex pole) { return pole.imag(); });
  poles.resize(count);
  return poles;
}

struct ValveCase {
  const char* name;
  double overlap, leakage, viscosity;
};
inline void PrintTo(const ValveCase& test, std::ostream* out) { *out << test.name; }
inline auto valve_cases() {
  return testing::Values(
      ValveCase{"shut", 0.07, 0.0, 0.0}, ValveCase{"shut_with_loss", 0.07, 0.0, 0.31},
      ValveCase{"leaking", 0.0, 31e-6, 0.04}, ValveCase{"underlap", -0.11, 1e-6, 0.13});
}

/// After 40 ms with the commands of all valves changed by `size` times some pattern.
inline VectorXd moved(const Plant& plant, double size, const IntegratorOptions& options) {
  const auto rest = plant.equilibrium(tilted(plant.machine()));
  Integrator run(plant, options);
  run.start(0.0, rest.x);
  PlantInput input = rest.input;
  for (int k = 1; k <= 20; ++k) {
    for (int i = 0; i < 6; ++i)
      input.command[i] = rest.input.command[i] + size * std::cos(1.3 * k + 2.0 * i);
    run.advance(2e-3 * k, input);
  }
  return run.state();
}

}  // namespace hydrapod::simulation::exact_lines
