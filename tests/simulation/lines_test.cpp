/// Lines with waves in the plant, against the transmission line's exact solution between valve and
/// chamber, and against themselves: linear and simulated, all integrators, energies.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>

#include "hydrapod/base/error.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/numerics/dense.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "support/exact_lines.hpp"
#include "support/random.hpp"

namespace hydrapod::simulation {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using model::leg_count;
using model::Machine;

using exact_lines::ExactMachine, exact_lines::moved, exact_lines::plant_poles, exact_lines::tilted,
    exact_lines::ValveCase, exact_lines::with_lines;

class LinePoles : public testing::TestWithParam<ValveCase> {};

TEST_P(LinePoles, AreThoseOfTheExactLineByTheSecondOrder) {
  constexpr std::size_t count = 6 + 12;
  const auto machine_with = [](int segments) {
    auto machine = with_lines(segments, GetParam().viscosity);
    for (auto& leg : machine.legs) {
      leg.hydraulics.valve.overlap = GetParam().overlap;
      leg.hydraulics.valve.leakage = GetParam().leakage;
    }
    return machine;
  };
  const auto machine = machine_with(8);
  const Pose X_BP = tilted(machine);
  const ExactMachine exact(machine, X_BP);
  const auto four = plant_poles(machine_with(4), X_BP, count);
  const auto eight = plant_poles(machine, X_BP, count);
  double worst = 0.0, least = 1e300;
  std::vector<Complex> poles;
  for (std::size_t k = 0; k < count; ++k) {
    const Complex better = (4.0 * eight[k] - four[k]) / 3.0;
    const Complex pole = poles.emplace_back(exact.pole_near(better));
    const double size = std::abs(pole);
    for (std::size_t other = 0; other < k; ++other)  // none is found twice
      least = std::min(least, std::abs(pole - poles[other]) / size);
    const double e4 = std::abs(four[k] - pole) / size, e8 = std::abs(eight[k] - pole) / size;
    worst = std::max(worst, e8);
    EXPECT_NEAR(std::log2(e4 / e8), 2.0, 0.06) << pole;
    // what is left after the second order
    EXPECT_LT(std::abs(better - pole), 1e-4 * size) << pole;
  }
  EXPECT_GT(least, 1e-4);
  EXPECT_LT(worst, 6e-3);
  RecordProperty("worst_of_eight_segments", fmt::format("{:.2e}", worst));
}

INSTANTIATE_TEST_SUITE_P(, LinePoles, exact_lines::valve_cases());

/// Far below the first wave, a shut valve's line is the inertia of a dead end.
TEST(Lines, ThatAreSlowAreDeadEnds) {
  auto waves = with_lines(8);
  for (auto& leg : waves.legs) {
    leg.hydraulics.valve.overlap = 0.07;
    leg.hydraulics.valve.leakage = 0.0;
  }
  auto ends = waves;
  ends.hydraulics.lines.segments = 0.0;
  auto none = hydraulics::without_line_inertia(ends);
  const Pose X_BP = tilted(waves);
  const auto with_waves = plant_poles(waves, X_BP, 6), dead = plant_poles(ends, X_BP, 6),
             without = plant_poles(none, X_BP, 6);
  for (std::size_t k = 0; k < 6; ++k) {
    const double omega = dead[k].imag(), shift = without[k].imag() - omega;
    EXPECT_GT(shift, 1e-5 * omega);
    EXPECT_NEAR(with_waves[k].imag(), omega, 0.06 * shift);
  }
}

// ---- States ---------------------------------------------------------------------------------

TEST(Lines, StandInTheStateInTheOrderOfTheChambers) {
  auto machine = with_lines(2, 0.04);
  machine.legs[1].oil_spring.cylinder->cap_line_length = 0.0;
  machine.legs[4].oil_spring.cylinder->rod_line_length = 0.0;
  const Plant plant(machine, ModelKind::guide);
  const auto& layout = plant.layout();
  EXPECT_EQ(layout.line_states, 4);
  EXPECT_EQ(layout.lines[2], -1);
  EXPECT_EQ(layout.lines[9], -1);
  EXPECT_EQ(layout.lines[0], layout.spools + 12);
  EXPECT_EQ(layout.lines[11] + 4, layout.size);
  const auto names = plant.state_names(), units = plant.state_units();
  ASSERT_EQ(names.size(), static_cast<std::size_t>(layout.size));
  const auto at = static_cast<std::size_t>(layout.lines[3]);
  EXPECT_THAT(std::vector(names.begin() + layout.lines[3], names.begin() + layout.lines[3] + 4),
              testing::ElementsAre("leg2.rod_line.p0", "leg2.rod_line.p1", "leg2.rod_line.q1",
                                   "leg2.rod_line.q2"));
  EXPECT_EQ(units[at + 1], "Pa");
  EXPECT_EQ(units[at + 2], "m^3/s");
  machine.hydraulics.lines.segments = 0.0;
  EXPECT_EQ(Plant(machine, ModelKind::guide).layout().size, layout.size - 10 * 4);
  machine.hydraulics.lines.segments = 2.0;
  const Plant springs(machine, ModelKind::guide, {.hydraulics = false});
  EXPECT_EQ(springs.layout().line_states, 0);
}

/// Chains of segments and modes.
class LinesWithWaves : public testing::TestWithParam<model::Lines> {
 protected:
  [[nodiscard]] static Machine machine(double viscosity) {
    auto lines = GetParam();
    lines.viscosity = viscosity;
    return with_lines(lines);
  }
};

TEST_P(LinesWithWaves, HavePolesOfTheirOwn) {
  const auto machine = this->machine(0.04);
  const auto system = linear_system(machine, machine.neutral(), {.sampled = false});
  const auto poles = system_poles(system);
  int waves = 0;
  for (const auto& pole : poles.poles)
    waves += pole.oscillates() && pole.parts[static_cast<std::size_t>(Part::line)] > 0.5 ? 1 : 0;
  EXPECT_GE(waves, 12);
  EXPECT_STREQ(name(Part::line), "lines");
  EXPECT_TRUE(poles.stable);
}

TEST_P(LinesWithWaves, RestAtTheEquilibrium) {
  for (const bool pump : {false, true}) {
    auto machine = this->machine(1.7);  // thick oil: a loss that is seen
    for (auto& leg : machine.legs) {
      leg.hydraulics.leakage = {.internal = 5.1e-12, .external = 0.7e-12};
      leg.hydraulics.valve.leakage = 23e-6;
    }
    if (pump) machine.hydraulics.supply.pump_flow = 5e-3;
    const Plant plant(machine, ModelKind::guide);
    const auto rest = plant.equilibrium(tilted(machine));
    VectorXd rate(plant.layout().size);
    ASSERT_TRUE(plant.derivative(0.0, rest.x.data(), rest.input, rate.data()));
    EXPECT_LT(rate.cwiseQuotient(plant.scales()).lpNorm<Eigen::Infinity>(), 1e-6);
    const auto out = plant.outputs(rest.x.data(), rest.input);
    double loss = 0.0;
    for (const auto& leg : out.legs) {
      EXPECT_GT(leg.cap_valve_pressure - leg.cap_pressure, 100.0);
      EXPECT_NEAR(leg.cap_inflow, leg.cap_flow, 1e-9 * leg.cap_flow);
      loss += (leg.cap_valve_pressure - leg.cap_pressure) * leg.cap_flow +
              (leg.rod_valve_pressure - leg.rod_pressure) * leg.rod_flow;
    }
    EXPECT_NEAR(out.line_dissipation, loss, 1e-8 * loss);
  }
}

INSTANTIATE_TEST_SUITE_P(, LinesWithWaves,
                         testing::Values(model::Lines{.segments = 3.0}, model::Lines{.modes = 3.0}),
                         [](const auto& test) {
                           return test.param.modes > 0.0 ? "modes" : "segments";
                         });

// ---- Motion ---------------------------------------------------------------------------------
IntegratorOptions with(Method method, double tolerance) {
  return {.method = method, .relative_tolerance = tolerance, .absolute_tolerance = tolerance};
}

TEST(Lines, MoveAsTheirLinearisation) {
  const auto machine = with_lines(3, 0.04);
  const Plant plant(machine, ModelKind::rigid, {.friction = Friction::viscous}, tilted(machine));
  const auto rest = plant.equilibrium(tilted(machine));
  const auto linear = plant.linearise(rest.x, rest.input);
  const VectorXd full = plant.scales();
  VectorXd scales(full.size() - 1);
  scales << full.head<3>(), full.tail(full.size() - 4);
  const auto n = scales.size();
  MatrixXd both = MatrixXd::Zero(n + 6, n + 6);
  both.topLeftCorner(n, n) = scales.cwiseInverse().asDiagonal() * linear.A * scales.asDiagonal();
  both.topRightCorner(n, 6) = scales.cwiseInverse().asDiagonal() * linear.B.leftCols(6);
  const MatrixXd step = (2e-3 * both).exp();
  VectorXd change = VectorXd::Zero(n);
  for (int k = 1; k <= 20; ++k) {
    Eigen::Matrix<double, 6, 1> u;
    for (int i = 0; i < 6; ++i) u[i] = std::cos(1.3 * k + 2.0 * i);
    change = step.topLeftCorner(n, n) * change + step.topRightCorner(n, 6) * u;
  }
  const auto error = [&](double size) {
    VectorXd at(full.size());
    const VectorXd small = size * scales.cwiseProduct(change);
    plant.displace(rest.x.data(), small.data(), at.data());
    const VectorXd difference =
        (moved(plant, size, with(Method::cvode_adams, 1e-12)) - at).cwiseQuotient(full);
    return difference.lpNorm<Eigen::Infinity>() / (size * change.lpNorm<Eigen::Infinity>());
  };
  const double coarse = error(4e-4), fine = error(1e-4);
  EXPECT_LT(fine, 1e-3);
  EXPECT_NEAR(coarse / fine, 4.0, 0.3);  // what is left is of the second order
}

TEST(Lines, MoveAlikeWithAllIntegrators) {
  auto machine = with_lines(3, 0.04);
  for (auto& leg : machine.legs) leg.hydraulics.valve.overlap = -0.4;  // no edge passes its corner
  const Plant plant(machine, ModelKind::guide, {}, tilted(machine));
  const VectorXd scales = plant.scales();
  const VectorXd exact = moved(plant, 0.2, with(Method::cvode_adams, 1e-11));
  const auto error = [&](const IntegratorOptions& options) {
    return (moved(plant, 0.2, options) - exact).cwiseQuotient(scales).lpNorm<Eigen::Infinity>();
  };
  for (const auto method :
       {Method::exponential, Method::adaptive, Method::cvode_adams, Method::cvode_bdf})
    for (const double tolerance : {1e-5, 1e-7})
      EXPECT_LT(error(with(method, tolerance)), 1000.0 * tolerance) << name(method);
  const double coarse = error({.method = Method::fixed, .fixed_step = 5e-5});
  const double fine = error({.method = Method::fixed, .fixed_step = 2.5e-5});
  EXPECT_LT(fine, 1e-5);
  EXPECT_NEAR(std::log2(coarse / fine), 4.0, 0.5);
}

/// Valves shut, cylinders tight: what mechanism, oil and lines hold changes by what is lost.
TEST(Lines, KeepTheBalanceOfEnergy) {
  auto machine = with_lines(3, 0.17);
  for (auto& leg : machine.legs) {
    leg.hydraulics.valve.overlap = 0.07;
    leg.hydraulics.valve.leakage = 0.0;
  }
  const Pose X_BP = tilted(machine);
  const Plant plant(machine, ModelKind::guide, {}, X_BP);
  const auto rest = plant.equilibrium(X_BP);
  const auto& layout = plant.layout();
  VectorXd x = rest.x, rate(layout.size);
  for (int k = 0; k < 6; ++k) x[layout.velocity() + k] = 0.03 * std::cos(1.0 + 2.0 * k);
  const double beta = machine.legs[0].oil_spring.cylinder->bulk_modulus;
  // what the oil takes up, by the states' rates: Σ p C ṗ
  const auto oil = [&](const PlantOutput& out) {
    double power = 0.0;
    for (int c = 0; c < 2 * leg_count; ++c) {
      const auto i = static_cast<std::size_t>(c / 2);
      const auto& leg = machine.legs[i];
      const auto& cylinder = *leg.oil_spring.cylinder;
      const bool cap = c % 2 == 0;
      const auto volumes = hydraulics::chamber_volumes(cylinder, *leg.stroke, out.legs[i].piston);
      const double line = cap ? cylinder.cap_line_volume : cylinder.rod_line_volume;
      const double wall = cap ? cylinder.cap_line_compliance : cylinder.rod_line_compliance;
      const double C = (line / beta + wall) / 3.0;
      const double own = (cap ? volumes.cap : volumes.rod) / beta - line / beta + 0.5 * C;
      const int p = layout.pressures + c, first = layout.lines[static_cast<std::size_t>(c)];
      power += own * x[p] * rate[p] + 0.5 * C * x[first] * rate[first] +
               C * (x[first + 1] * rate[first + 1] + x[first + 2] * rate[first + 2]);
      const double outside = hydraulics::atmospheric_pressure * (cap ? 1.0 : -1.0) *
                             (cap ? plant.axis(c / 2).area.piston : plant.axis(c / 2).area.annulus);
      power += outside * out.legs[i].piston_rate;
    }
    return power;
  };
  Integrator run(plant, with(Method::cvode_adams, 1e-11));
  run.start(0.0, x);
  const int samples = 1200;
  const double interval = 1e-4;
  double taken = 0.0, lost = 0.0, in_lines = 0.0, first = 0.0, last = 0.0, moving = 0.0;
  for (int k = 0; k <= samples; ++k) {
    if (k > 0) run.advance(k * interval, {});
    x = run.state();
    ASSERT_TRUE(plant.derivative(0.0, x.data(), {}, rate.data()));
    const auto out = plant.outputs(x.data(), {});
    const double weight = (k == 0 || k == samples ? 1.0 : k % 2 == 1 ? 4.0 : 2.0) * interval / 3.0;
    taken += weight * oil(out);
    lost += weight * (out.dissipation + out.line_dissipation);
    in_lines += weight * out.line_dissipation;
    last = out.energies.total() + out.line_kinetic_energy;
    if (k == 0) first = last;
    moving = std::max(moving, out.energies.platform);
    EXPECT_GT(out.line_kinetic_energy, -1e-300);
  }
  EXPECT_GT(in_lines, 1e-4 * moving);
  EXPECT_NEAR(last - first + taken + lost, 0.0, 1e-6 * moving);
}

TEST(Lines, NeedShortStepsWhereTheseAreFixed) {
  const auto machine = with_lines(8, 0.04);
  const auto run = [&](double step) {
    const ClosedLoop loop(
        machine, machine.neutral(),
        {.integrator = {.method = Method::fixed, .fixed_step = step}, .until = 0.1});
  };
  EXPECT_NO_THROW(run(5e-5));
  try {
    run(1e-3);
    ADD_FAILURE() << "accepted";
  } catch (const base::ComputationError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("fixed steps of 0.001 s are too long for a state "
                                                 "that changes at "));
    EXPECT_THAT(error.what(), testing::HasSubstr("_line."));
  }
}

}  // namespace
}  // namespace hydrapod::simulation
