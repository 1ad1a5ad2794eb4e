/// The machine without its controller: released from a displacement, and shaken by a wrench.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "support/published_machine.hpp"

namespace hydrapod::test {
namespace {

using dynamics::ModelKind;
using simulation::ClosedLoop;
using simulation::Excitation;
using simulation::LoopOptions;
using simulation::LoopSample;
using spatial::Vector6;

/// Ugly, undamped.
model::Machine machine_of() {
  auto machine = published_machine();
  machine.platform.mass = 731.7;
  machine.damping.modal_ratio = 0.0;
  for (auto& leg : machine.legs) leg.oil_spring.damping = 0.0;
  return machine;
}

LoopOptions springs(double until) {
  LoopOptions options{.kind = ModelKind::rigid, .until = until, .ideal_sensors = true};
  options.actuators = simulation::Actuators::springs;
  options.integrator.relative_tolerance = options.integrator.absolute_tolerance = 1e-10;
  return options;
}

/// Against the modes of the linear model: q(t) = Σ φ φᵀ M q_0 cos ωt.
TEST(WithoutController, OfASmallDisplacementIsASumOfModes) {
  const auto machine = machine_of();
  auto options = springs(0.7);
  options.initial << 1.3e-6, -0.7e-6, 0.9e-6, 1.1e-6, -0.8e-6, 1.7e-6;
  const auto linear = dynamics::linear_model(machine, machine.neutral(), ModelKind::rigid);
  const auto modes = modal::normal_modes(linear);
  // coordinates of the linear model are those of the mass centre
  const spatial::Vector3 arm = machine.neutral().R_BP * machine.platform.mass_center;
  const auto at_center = [&](const Vector6& d) {
    Vector6 q = d;
    q.head<3>() += spatial::Vector3(d.tail<3>()).cross(arm);
    return q;
  };
  const Vector6 q_0 = at_center(options.initial);
  const Vector6 share = modes.shapes.transpose() * (linear.M * q_0);
  ClosedLoop loop(machine, machine.neutral(), options);
  double worst = 0.0;
  const auto summary = loop.run([](double, Excitation&) {},
                                [&](const LoopSample& sample) {
                                  const Vector6 q = at_center(simulation::displacement_between(
                                      loop.operating(), sample.plant.X_BP));
                                  Vector6 expected = Vector6::Zero();
                                  for (int k = 0; k < 6; ++k)
                                    expected += modes.shapes.col(k) * share[k] *
                                                std::cos(std::sqrt(modes.omega2[k]) * sample.time);
                                  worst = std::max(worst, (q - expected).norm());
                                });
  EXPECT_EQ(summary.end, simulation::RunEnd::finished) << summary.message;
  EXPECT_GT(summary.samples, 600);
  EXPECT_LT(worst,
            1e-5 * q_0.norm());  // the square of a micrometre over the legs' lengths, and phase
}

/// x of the platform at the end of every sample of 1 ms, under a force of 47 Hz along x.
std::vector<double> shaken(double sample_time, bool about_samples) {
  auto machine = machine_of();
  machine.controller.sample_time = sample_time;
  auto options = springs(0.25);
  options.output_interval = 1e-3;
  const auto force = [](double t) { return 970.0 * std::sin(2.0 * std::numbers::pi * 47.0 * t); };
  std::vector<double> motion;
  ClosedLoop loop(machine, machine.neutral(), options);
  const auto summary = loop.run(
      [&](double t, Excitation& out) {
        out.wrench[0] = force(t);
        if (about_samples) out.next_wrench.emplace(Vector6::Unit(0) * force(t + sample_time));
      },
      [&](const LoopSample& sample) {
        motion.push_back(simulation::displacement_between(loop.operating(), sample.plant.X_BP)[0]);
      });
  EXPECT_EQ(summary.end, simulation::RunEnd::finished) << summary.message;
  return motion;
}

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0.0, largest = 0.0;
  for (std::size_t k = 0; k < b.size(); ++k) {
    worst = std::max(worst, std::abs(a.at(k) - b[k]));
    largest = std::max(largest, std::abs(b[k]));
  }
  return worst / largest;
}

/// Held about its samples a force of 47 Hz is right but for sin(πfT)/πfT = 0.9964; held from sample
/// to sample it comes half a sample late, 8.5°.
TEST(WithoutController, UnderAWrenchHeldAboutItsSamplesIsNotLate) {
  const auto exact = shaken(1e-5, true);
  EXPECT_LT(difference(shaken(1e-3, true), exact), 0.01);
  EXPECT_GT(difference(shaken(1e-3, false), exact), 0.04);  // most of the motion is free
}

TEST(WithoutController, NeedsSomethingThatLetsGo) {
  auto options = springs(1.0);
  options.actuators = simulation::Actuators::held;
  options.initial[2] = 1e-3;
  EXPECT_THROW(ClosedLoop(machine_of(), machine_of().neutral(), options), std::invalid_argument);
  options.initial.setZero();
  EXPECT_NO_THROW(ClosedLoop(machine_of(), machine_of().neutral(), options));
}

}  // namespace
}  // namespace hydrapod::test
