/// Lines by their modes in the plant, against the transmission line's exact solution between valve
/// and chamber, and against themselves.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "hydrapod/base/error.hpp"
#include "support/exact_lines.hpp"

namespace hydrapod::simulation {
namespace {

model::Machine with_line_modes(int modes, double viscosity = 0.0) {
  return exact_lines::with_lines({.modes = static_cast<double>(modes), .viscosity = viscosity});
}

class ModalLinePoles : public testing::TestWithParam<exact_lines::ValveCase> {};

/// Six poles of the platform, twelve first waves, against the rigid machine on exact lines.
TEST_P(ModalLinePoles, AreCloserToThoseOfTheExactLineThanThoseOfSegments) {
  constexpr std::size_t count = 6 + 12;
  const auto with_valves = [](model::Machine machine) {
    for (auto& leg : machine.legs) {
      leg.hydraulics.valve.overlap = GetParam().overlap;
      leg.hydraulics.valve.leakage = GetParam().leakage;
    }
    return machine;
  };
  const double mu = GetParam().viscosity;
  const auto machine = with_valves(with_line_modes(8, mu));
  const Pose X_BP = exact_lines::tilted(machine);
  const exact_lines::ExactMachine exact(machine, X_BP);
  const auto eight = exact_lines::plant_poles(machine, X_BP, count);
  double worst_of_eight = 0.0;
  std::vector<std::complex<double>> poles;
  for (const auto& near : eight) {
    const auto pole = poles.emplace_back(exact.pole_near(near));
    worst_of_eight = std::max(worst_of_eight, std::abs(near - pole) / std::abs(pole));
  }
  for (std::size_t k = 1; k < count; ++k) EXPECT_GT(std::abs(poles[k] - poles[k - 1]), 1e-4);
  EXPECT_LT(worst_of_eight, 2e-4);
  const auto worst = [&](const model::Machine& with_waves) {
    const auto found = exact_lines::plant_poles(with_waves, X_BP, count);
    double most = 0.0;
    for (std::size_t k = 0; k < count; ++k)
      most = std::max(most, std::abs(found[k] - poles[k]) / std::abs(poles[k]));
    return most;
  };
  for (const int N : {3, 4, 8}) {
    const double modes = worst(with_valves(with_line_modes(N, mu)));
    const double segments = worst(with_valves(exact_lines::with_lines(N, mu)));
    fmt::print("N = {}: poles within {:.2e} of the exact ones by modes, {:.2e} by segments\n", N,
               modes, segments);
    EXPECT_LT(modes, segments / (3.0 * N));
  }
}

INSTANTIATE_TEST_SUITE_P(, ModalLinePoles, exact_lines::valve_cases());

TEST(ModalLines, StandInTheStateAsSegmentsDo) {
  auto machine = with_line_modes(2, 0.04);
  machine.legs[1].oil_spring.cylinder->cap_line_length = 0.0;
  const Plant plant(machine, ModelKind::guide);
  const auto& layout = plant.layout();
  machine.hydraulics.lines = {.segments = 2.0};
  EXPECT_EQ(Plant(machine, ModelKind::guide).layout(), layout);
  const auto names = plant.state_names(), units = plant.state_units();
  const auto at = static_cast<std::size_t>(layout.lines[3]);
  EXPECT_THAT(std::vector(names.begin() + layout.lines[3], names.begin() + layout.lines[3] + 4),
              testing::ElementsAre("leg2.rod_line.mode_p0", "leg2.rod_line.mode_p1",
                                   "leg2.rod_line.mode_q0", "leg2.rod_line.mode_q1"));
  EXPECT_EQ(units[at + 1], "Pa");
  EXPECT_EQ(units[at + 2], "m^3/s");
}

/// Valves that open and close far: the motion of many segments is approached by a few modes.
TEST(ModalLines, MoveAsManySegments) {
  const auto moved_with = [](model::Machine machine) {
    for (auto& leg : machine.legs) leg.hydraulics.valve.overlap = -0.4;
    const Plant plant(machine, ModelKind::rigid, {}, exact_lines::tilted(machine));
    const Eigen::VectorXd x = exact_lines::moved(
        plant, 0.2,
        {.method = Method::cvode_adams, .relative_tolerance = 1e-9, .absolute_tolerance = 1e-9});
    const int known = plant.layout().pressures + 12;
    const Eigen::VectorXd scales = plant.scales();
    Eigen::VectorXd shared = x.head(known).cwiseQuotient(scales.head(known));
    return shared;
  };
  const Eigen::VectorXd four = moved_with(exact_lines::with_lines(4, 0.04)),
                        eight = moved_with(exact_lines::with_lines(8, 0.04));
  const Eigen::VectorXd many = (4.0 * eight - four) / 3.0;  // what the second order leaves
  const auto off = [&](const Eigen::VectorXd& x) { return (x - many).lpNorm<Eigen::Infinity>(); };
  const double modes = off(moved_with(with_line_modes(4, 0.04)));
  fmt::print("four modes {:.2e}, four segments {:.2e}, eight {:.2e}\n", modes, off(four),
             off(eight));
  EXPECT_LT(modes, 0.2 * off(four));
}

TEST(ModalLines, NeedShortSteps) {
  const auto machine = with_line_modes(3, 0.04);
  try {
    const ClosedLoop loop(
        machine, machine.neutral(),
        {.integrator = {.method = Method::fixed, .fixed_step = 1e-3}, .until = 0.1});
    ADD_FAILURE() << "accepted";
  } catch (const base::ComputationError& error) {
    EXPECT_THAT(error.what(), testing::EndsWith("fewer `lines.modes`"));
  }
}

}  // namespace
}  // namespace hydrapod::simulation
