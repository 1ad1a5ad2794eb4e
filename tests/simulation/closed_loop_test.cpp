/// The machine under its controller in time.

#include "hydrapod/simulation/closed_loop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <deque>
#include <stdexcept>

#include "hydrapod/simulation/linear_system.hpp"
#include "support/loop_machine.hpp"

namespace hydrapod::simulation {
namespace {

using testing::HasSubstr;

/// A commanded step in one direction at 0.1 s.
std::vector<signals::Signal> step_in(int direction, double size) {
  return {{.size = size * Vector6::Unit(direction), .form = signals::Step{}}};
}

struct Outcome {
  RunSummary summary{};
  std::vector<double> time{};
  std::vector<Vector6> error{};  ///< commanded less true displacement
  std::vector<double> rows{};    ///< of the record
};

Outcome run(const model::Machine& machine, const std::vector<signals::Signal>& commands,
            const LoopOptions& options, const ExcitationSource& more = {}) {
  ClosedLoop loop(machine, machine.neutral(), options);
  signals::Generator generator(commands, 1.0 / loop.parameters().sample_time);
  const auto from_signal = command_source(generator);
  Outcome outcome;
  std::vector<double> row(record_channels(loop).size());
  outcome.summary = loop.run(
      [&](double time, Excitation& excitation) {
        from_signal(time, excitation);
        if (more) more(time, excitation);
      },
      [&](const LoopSample& sample) {
        outcome.time.push_back(sample.time);
        outcome.error.push_back(sample.excitation.command.value -
                                displacement_between(loop.operating(), sample.plant.X_BP));
        record_row(loop, sample, row.data());
        outcome.rows.insert(outcome.rows.end(), row.begin(), row.end());
      });
  return outcome;
}

/// Mean error of the last second.
Vector6 steady_error(const Outcome& outcome) {
  Vector6 sum = Vector6::Zero();
  int count = 0;
  for (size_t k = 0; k < outcome.time.size(); ++k) {
    if (outcome.time[k] < outcome.time.back() - 1.0) continue;
    sum += outcome.error[k];
    ++count;
  }
  return sum / count;
}

/// The twist of the commanded pose against differences of the pose, rotated and about an operating
/// pose that is itself rotated.
TEST(CommandAt, HasTheTwistOfItsPose) {
  const Pose operating{spatial::rotation_from_rpy({0.3, -0.2, 0.5}), {0.1, 0.2, 0.9}};
  const signals::Sample now{(Vector6() << 0.1, 0.2, -0.1, 0.4, -0.7, 0.6).finished(),
                            (Vector6() << 0.3, -0.1, 0.2, 0.9, 1.1, -0.8).finished()};
  constexpr double h = 1e-6;
  const auto at = [&](double t) {
    return command_at(operating, {now.value + t * now.rate, now.rate});
  };
  const auto before = at(-h), after = at(h);
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(after.X_BP.R_BP * before.X_BP.R_BP.transpose()));
  Vector6 twist;
  twist << (after.X_BP.p_BP - before.X_BP.p_BP) / (2.0 * h), turn.angle() * turn.axis() / (2.0 * h);
  EXPECT_LT((twist - at(0.0).velocity).norm(), 1e-9);
  EXPECT_LT((command_at(operating, {}).X_BP.R_BP - operating.R_BP).norm(), 1e-15);
}

/// A step up or down: the last error beyond the band is negative in one of them.
class Summary : public testing::TestWithParam<double> {};

TEST_P(Summary, IsOfWhatTheSamplesHold) {
  const auto machine = machine_of("zhang-jiang-2021");
  ClosedLoop loop(machine, machine.neutral(), {.until = 1.7, .ideal_sensors = true});
  signals::Generator generator(step_in(2, GetParam()), 1.0 / loop.parameters().sample_time);
  const Vector6 band = Vector6::Constant(3e-4);
  Vector6 squares = Vector6::Zero(), peak = Vector6::Zero(), settled = Vector6::Zero();
  Vector6 last = Vector6::Constant(std::nan("")), speed = Vector6::Zero();
  Vector6 low = Vector6::Constant(1e9), high = Vector6::Constant(-1e9);
  long samples = 0;
  const auto summary = loop.run(
      command_source(generator),
      [&](const LoopSample& sample) {
        const Vector6 error = sample.excitation.command.value -
                              displacement_between(loop.operating(), sample.plant.X_BP);
        squares += error.cwiseProduct(error);
        peak = peak.cwiseMax(error.cwiseAbs());
        for (int i = 0; i < 6; ++i)
          if (error[i] < -band[i] || error[i] > band[i]) settled[i] = sample.time;
        const Vector6& lengths = sample.measured.length;
        if (samples++ > 0)
          speed = speed.cwiseMax((lengths - last).cwiseAbs() / loop.parameters().sample_time);
        last = lengths;
        low = low.cwiseMin(lengths);
        high = high.cwiseMax(lengths);
      },
      {}, band);
  ASSERT_EQ(summary.samples, samples);
  EXPECT_GT(settled[2], 0.1);
  for (int i = 0; i < 6; ++i) {
    const auto leg = static_cast<std::size_t>(i);
    const double rms = std::sqrt(squares[i] / static_cast<double>(samples));
    EXPECT_NEAR(summary.rms_error[i], rms, 1e-12 * rms + 1e-18) << i;
    EXPECT_NEAR(summary.peak_error[i], peak[i], 1e-12 * peak[i] + 1e-18) << i;
    EXPECT_EQ(summary.settled[i], settled[i]) << i;
    EXPECT_NEAR(summary.peak_speed[leg], speed[i], 1e-9 * speed[i]) << i;
    EXPECT_NEAR(summary.piston_low[leg], low[i] - machine.legs[leg].rod.length, 1e-12) << i;
    EXPECT_NEAR(summary.piston_high[leg], high[i] - machine.legs[leg].rod.length, 1e-12) << i;
  }
}

TEST(CommandAt, IsUndoneByTheDisplacement) {
  const Pose operating{spatial::rotation_from_rpy({0.3, -0.2, 0.5}), {0.1, 0.2, 0.9}};
  const Vector6 d = (Vector6() << 0.1, 0.2, -0.1, 0.4, -0.7, 0.6).finished();
  EXPECT_LT((displacement_between(operating, command_at(operating, {d, {}}).X_BP) - d).norm(),
            1e-14);
}

/// What a record holds of a platform that turns quickly about a centre of mass far from its origin;
/// its acceleration against differences of where it is.
TEST(RecordRow, HoldsTheMotionOfTheOriginAndThePressuresOfEachLeg) {
  const auto machine = machine_of("zhang-jiang-2021");
  const ClosedLoop loop(machine, machine.neutral(), {});
  const Vector6 twist = (Vector6() << 0.3, -0.2, 0.4, 2.1, -1.7, 0.9).finished();
  const Vector6 acceleration = (Vector6() << 1.1, 0.6, -2.3, 3.7, -1.9, 4.2).finished();
  const spatial::Vector3 arm(0.41, -0.23, 0.67);  // from the mass centre to the origin
  const auto origin = [&](double t) -> spatial::Vector3 {
    const spatial::Vector3 turn =
        t * twist.tail<3>() + 0.5 * t * t * acceleration.tail<3>();  // to second order
    return t * twist.head<3>() + 0.5 * t * t * acceleration.head<3>() +
           Eigen::AngleAxisd(turn.norm(), turn.norm() > 0.0 ? spatial::Vector3(turn.normalized())
                                                            : spatial::Vector3::UnitX()) *
               arm;
  };
  PlantOutput plant{.X_BP = machine.neutral(), .twist = twist, .acceleration = acceleration};
  plant.p_BC = plant.X_BP.p_BP - arm;
  for (int i = 0; i < model::leg_count; ++i) {
    plant.legs[static_cast<std::size_t>(i)].cap_pressure = 4.1e6 + 1e5 * i;
    plant.legs[static_cast<std::size_t>(i)].rod_pressure = 7.3e6 - 2e5 * i;
  }
  const Excitation excitation;
  const control::Measurement measured;
  const control::ControllerState controller;
  const Vector6 none = Vector6::Zero();
  const LoopSample sample{0.0, excitation, measured, controller, none, none, plant};
  const auto channels = record_channels(loop);
  std::vector<double> row(channels.size());
  record_row(loop, sample, row.data());
  const auto at = [&](const std::string& name) {
    const auto found = std::ranges::find(channels, name, &data::Channel::name);
    return row.at(static_cast<std::size_t>(found - channels.begin()));
  };
  constexpr double h = 1e-4;
  const spatial::Vector3 expected = (origin(h) - 2.0 * origin(0.0) + origin(-h)) / (h * h);
  EXPECT_NEAR(at("platform.ax"), expected.x(), 1e-6);
  EXPECT_NEAR(at("platform.ay"), expected.y(), 1e-6);
  EXPECT_NEAR(at("platform.az"), expected.z(), 1e-6);
  EXPECT_EQ(at("platform.arx"), 3.7);
  EXPECT_EQ(at("leg3.p_cap"), 4.3e6);
  EXPECT_EQ(at("leg4.p_rod"), 6.7e6);

  TraceRecorder recorder(loop, 1.0);
  recorder(sample);
  EXPECT_EQ(recorder.trace().cap_pressure.front()[4], 4.5e6);
  EXPECT_EQ(recorder.trace().rod_pressure.front()[1], 7.1e6);
}

INSTANTIATE_TEST_SUITE_P(ClosedLoop, Summary, testing::Values(4e-3, -4e-3));

TEST(ClosedLoop, AStepInZSettlesWithoutErrorBeyondTheSensors) {
  for (const std::string name : {"zhang-jiang-2021", "heavy-platform"}) {
    const auto machine = machine_of(name);
    const auto outcome = run(machine, step_in(2, 5e-3), {.until = 9.0});
    ASSERT_EQ(outcome.summary.end, RunEnd::finished) << outcome.summary.message;
    EXPECT_LT(std::abs(steady_error(outcome)[2]), machine.sensors.length.resolution) << name;
    EXPECT_LT(outcome.summary.peak_motion[2], 1.2 * 5e-3);
  }
}

TEST(ClosedLoop, SettlesInLegSpaceAndWithAccelerationFeedbackToo) {
  for (const auto& overrides :
       std::vector<std::vector<std::string>>{{"controller.space=leg"},
                                             {"controller.feedback=acceleration"},
                                             {"controller.feedback=none"}}) {
    const auto machine = machine_of("zhang-jiang-2021", overrides);
    EXPECT_TRUE(system_poles(linear_system(machine, machine.neutral())).sampled_stable);
    const auto outcome = run(machine, step_in(3, 5e-3), {.until = 16.0});
    EXPECT_LT(std::abs(steady_error(outcome)[3]), 2e-5) << overrides.front();
  }
}

/// Beyond the limit of the pole analysis the machine shakes, and before it does not.
/// Accelerometers along the legs show how the lengths bend, also while the legs swing round at
/// speed.
TEST(ClosedLoop, AccelerationsAlongTheLegsAreThoseOfTheirLengths) {
  const auto machine = machine_of("zhang-jiang-2021", {"controller.feedback=acceleration"});
  ClosedLoop loop(machine, machine.neutral(), {.until = 1.2, .ideal_sensors = true});
  const double T = loop.parameters().sample_time;
  signals::Generator generator(
      {{.size = (Vector6() << 0.021, -0.017, 0.013, 0.041, 0.029, -0.083).finished(),
        .form = signals::Sine{.frequency = 2.3}}},
      1.0 / T);
  std::vector<Vector6> length, acceleration;
  loop.run(command_source(generator), [&](const LoopSample& sample) {
    length.push_back(kinematics::leg_lengths(machine, sample.plant.X_BP));
    acceleration.push_back(sample.measured.acceleration);
  });
  // how much of l̇²/l is in what they are off by
  double together = 0.0, squares = 0.0, fastest = 0.0;
  const std::size_t last = length.size() - 1;
  ASSERT_GT(last, 100U);
  for (std::size_t k = 1; k < last; ++k) {
    const Vector6 bent = (length[k + 1] - 2.0 * length[k] + length[k - 1]) / (T * T);
    const Vector6 speed = (length[k + 1] - length[k - 1]) / (2.0 * T);
    const Vector6 swing = speed.cwiseAbs2().cwiseQuotient(length[k]);
    together += (acceleration[k] - bent).dot(swing);
    squares += swing.squaredNorm();
    fastest = std::max(fastest, speed.cwiseAbs().maxCoeff());
  }
  EXPECT_GT(fastest, 0.1);
  EXPECT_NEAR(together / squares, 0.0, 0.2);
}

TEST(ClosedLoop, AGainThatThePolesCallUnstableIsSeenToBe) {
  for (const auto& [gain, stable] : {std::pair{"28", true}, {"60", false}}) {
    const auto machine = machine_of("zhang-jiang-2021", {std::string("controller.gain=") + gain});
    const auto poles = system_poles(linear_system(machine, machine.neutral()));
    EXPECT_EQ(poles.sampled_stable, stable);
    const auto outcome = run(machine, step_in(0, 5e-3), {.until = 6.0});
    if (stable) {
      EXPECT_LT(std::abs(steady_error(outcome)[0]), 1e-4);
      EXPECT_LT(outcome.summary.peak_error[0], 1.01 * 5e-3);
    } else {  // it swings much further than the step that started it
      EXPECT_GT(outcome.summary.peak_error[0], 4.0 * 5e-3);
    }
  }
}

/// From a tiny disturbance an unstable loop grows at the rate of its pole.
TEST(ClosedLoop, AnUnstablePoleGrowsAtItsRate) {
  auto overrides = smooth;
  overrides.push_back("controller.gain=40");
  const auto machine = machine_of("zhang-jiang-2021", overrides);
  const auto poles = system_poles(linear_system(machine, machine.neutral()));
  ASSERT_FALSE(poles.sampled_stable);
  const auto outcome =
      run(machine, step_in(0, 1e-8),
          {.plant = {.friction = Friction::viscous},
           .integrator = {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-12},
           .until = 3.1,
           .ideal_sensors = true});
  const auto power = [&](double from, double to) {
    double sum = 0.0;
    for (size_t k = 0; k < outcome.time.size(); ++k)
      if (outcome.time[k] >= from && outcome.time[k] < to)
        sum += outcome.error[k][0] * outcome.error[k][0];
    return sum;
  };
  const double period = 2.0 * M_PI / poles.sampled.front().imag();
  const double window = 4.0 * period;
  const double rate = 0.5 * std::log(power(2.0, 2.0 + window) / power(1.0, 1.0 + window));
  EXPECT_NEAR(rate, poles.sampled.front().real(), 0.05 * poles.sampled.front().real());
}

TEST(ClosedLoop, TheSameSeedGivesTheSameRunToTheBit) {
  const auto machine = machine_of("heavy-platform");
  const std::vector<signals::Signal> commands{
      {.size = Vector6::Constant(5e-4), .form = signals::Noise{.to = 15.0}}};
  const LoopOptions options{.until = 0.5, .seed = 3};
  const auto one = run(machine, commands, options);
  const auto again = run(machine, commands, options);
  ASSERT_EQ(one.rows.size(), again.rows.size());
  EXPECT_TRUE(one.rows == again.rows);
  auto other_options = options;
  other_options.seed = 4;
  EXPECT_FALSE(one.rows == run(machine, commands, other_options).rows);
}

TEST(ClosedLoop, RunsAgainFromTheStart) {
  const auto machine = machine_of("heavy-platform");
  ClosedLoop loop(machine, machine.neutral(), {.until = 0.2});
  std::vector<double> first, second;
  for (auto* list : {&first, &second}) {
    signals::Generator generator(step_in(1, 1e-3), 1.0 / loop.parameters().sample_time);
    loop.run(command_source(generator),
             [&](const LoopSample& sample) { list->push_back(sample.plant.X_BP.p_BP.y()); });
  }
  EXPECT_EQ(first, second);
}

/// Drives reach the valves a given time after their sample, fractions of samples included.
TEST(ClosedLoop, DelaysDrivesByAnyFractionOfSamples) {
  for (const double delay : {0.0, 0.5, 1.0, 2.25}) {
    const auto machine =
        machine_of("heavy-platform", {"controller.delay=" + std::to_string(delay),
                                      "controller.gain=0", "controller.feedback=none"});
    ClosedLoop loop(machine, machine.neutral(),
                    {.until = 0.02, .output_interval = 0.25e-3, .ideal_sensors = true});
    int sample_number = 0;
    std::deque<double> drives{loop.rest().input.command[0]};
    const double null = machine.controller.output.offset[0];
    loop.run(
        [&](double time, Excitation& excitation) {
          EXPECT_NEAR(time, 1e-3 * sample_number, 1e-12);
          excitation.drive[0] = 1e-3 * ++sample_number;
        },
        [&](const LoopSample& sample) {
          const int due = static_cast<int>(std::floor(sample.time / 1e-3 - delay + 1e-6));
          const double expected = due < 0 ? drives.front() : null + 1e-3 * (due + 1);
          EXPECT_NEAR(sample.applied[0], expected, 1e-12) << delay << ' ' << sample.time;
        });
    EXPECT_EQ(sample_number, 21);
  }
}

TEST(ClosedLoop, AWrenchPushesThePlatformAndTheControllerPushesBack) {
  const auto machine = machine_of("heavy-platform");
  const auto outcome = run(machine, {}, {.until = 12.0},
                           [](double, Excitation& excitation) { excitation.wrench[2] = -7.3e3; });
  EXPECT_LT(std::abs(steady_error(outcome)[2]), machine.sensors.length.resolution);
  EXPECT_GT(outcome.summary.peak_error[2], 1e-4);
}

TEST(ClosedLoop, EndsWhereAJointReachesItsLimit) {
  auto machine = machine_of("zhang-jiang-2021");
  for (auto& leg : machine.legs) leg.joint_limits.base = 0.02;
  const auto outcome = run(machine, step_in(0, 0.05), {.until = 5.0});
  EXPECT_EQ(outcome.summary.end, RunEnd::failed);
  EXPECT_THAT(outcome.summary.message, HasSubstr("beyond its limit of 1.15°"));
  EXPECT_GT(outcome.summary.time, 0.1);
  EXPECT_LT(outcome.summary.time, 1.0);
  EXPECT_GT(outcome.time.size(), 100U);
}

/// A sensor whose range ends gives lengths that no pose has.
TEST(ClosedLoop, EndsWhereTheControllerFindsNoPose) {
  auto machine = machine_of("zhang-jiang-2021");
  ClosedLoop loop(machine, machine.neutral(), {.until = 1.0});
  machine.sensors.length.high = 0.3;  // no hexapod of this size has legs that short
  ClosedLoop blind(machine, machine.neutral(), {.until = 1.0});
  const auto summary = blind.run([](double, Excitation&) {}, {});
  EXPECT_EQ(summary.end, RunEnd::failed);
  EXPECT_THAT(summary.message, HasSubstr("finds no pose for the measured leg lengths"));
}

TEST(ClosedLoop, StopsWhenItIsTold) {
  const auto machine = machine_of("heavy-platform");
  ClosedLoop loop(machine, machine.neutral(), {.until = 10.0});
  int samples = 0;
  const auto summary = loop.run([](double, Excitation&) {}, [&](const LoopSample&) { ++samples; },
                                [](double time) { return time < 0.0499; });
  EXPECT_EQ(summary.end, RunEnd::stopped);
  EXPECT_NEAR(summary.time, 0.05, 1e-9);
  EXPECT_EQ(samples, 51);
}

TEST(ClosedLoop, CountsWhatReachesTheDrivesLimit) {
  const auto machine = machine_of("zhang-jiang-2021", {"controller.output.limit=0.02"});
  const auto outcome = run(machine, step_in(2, 20e-3), {.until = 6.0});
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_GT(outcome.summary.limited[i], 100);
    EXPECT_NEAR(outcome.summary.peak_drive[i], 0.02, machine.controller.output.resolution);
  }
  EXPECT_LT(std::abs(outcome.error.back()[2]), 1e-4);
}

TEST(ClosedLoop, OptionsThatMakeNoSenseAreNamed) {
  const auto machine = machine_of("heavy-platform");
  EXPECT_THROW(ClosedLoop(machine, machine.neutral(), {.until = 0.0}), std::invalid_argument);
  EXPECT_THROW(ClosedLoop(machine, machine.neutral(), {.output_interval = -1.0}),
               std::invalid_argument);
  EXPECT_THROW(ClosedLoop(machine, machine.neutral(), {.plant = {.hydraulics = false}}),
               std::invalid_argument);
}

TEST(Sensors, HaveTheirNoiseResolutionAndRange) {
  model::Sensors sensors;
  sensors.length = {.resolution = 1e-4, .noise = 3e-4, .low = 0.99, .high = 1.0005};
  sensors.pressure = {.resolution = 0.0, .noise = 0.0};
  SensorBank bank(sensors, 5);
  control::Measurement truth;
  truth.length.setConstant(1.0);
  truth.cap_pressure.setConstant(1.234567e6);
  constexpr int count = 20000;
  double sum = 0.0, square = 0.0;
  for (int k = 0; k < count; ++k) {
    const auto measured = bank.read(truth);
    EXPECT_EQ(measured.cap_pressure, truth.cap_pressure);
    const double off = measured.length[2] - 1.0;
    EXPECT_NEAR(off / 1e-4, std::round(off / 1e-4), 1e-6);
    EXPECT_LE(measured.length[2], 1.0005 + 1e-12);
    sum += measured.length[0] - 1.0;
    truth.length[1] = 0.5;
    EXPECT_NEAR(measured.length[1], k == 0 ? measured.length[1] : 0.99, 1e-12);
  }
  // Clipped at +5/3 sigma: the mean of min(n, 5/3) is −φ(5/3) + 5/3 (1 − Φ(5/3)) = −0.0199 sigma.
  EXPECT_NEAR(sum / count / 3e-4, -0.0199, 4.0 / std::sqrt(count));

  sensors.length = {.resolution = 1e-4, .noise = 3e-4};
  SensorBank plain(sensors, 6);
  for (int k = 0; k < count; ++k) square += std::pow(plain.read(truth).length[0] - 1.0, 2);
  // Variance of noise and of rounding, q²/12; 4 sigma of the estimate.
  const double expected = 9e-8 + 1e-8 / 12.0;
  EXPECT_NEAR(square / count / expected, 1.0, 4.0 * std::sqrt(2.0 / count));
}

TEST(Tuning, FollowsFromTheMachineAndGivesWayToTheFile) {
  const auto machine = machine_of("zhang-jiang-2021");
  const auto tuning = tune_controller(machine, machine.neutral());
  const double omega = 46.839;  // the published machine's lowest rigid mode
  EXPECT_NEAR(tuning.lowest_oil_mode, omega, 1e-3);
  const auto& p = tuning.parameters;
  EXPECT_NEAR(p.gain[4], 0.3 * omega, 1e-3);
  EXPECT_NEAR(p.integral_time, 8.0 / p.gain[0], 1e-12);
  EXPECT_NEAR(p.feedback_gain[1], 2.0 * 0.4 * omega / 3.85353e6, 1e-9);
  const auto other = tune_controller(
      machine_of("zhang-jiang-2021",
                 {"controller.gain=[1, 2, 3, 4, 5, 0]", "controller.feedback_gain=3e-6"}),
      machine.neutral());
  EXPECT_EQ(other.parameters.gain[2], 3.0);
  EXPECT_EQ(other.parameters.integral_time, 8.0);  // of the smallest gain above 0
  EXPECT_EQ(other.parameters.feedback_gain[5], 3e-6);
}

/// Seals that stick hold small motions alone: controllers are tuned for those that slide.
TEST(Tuning, DoesNotDependOnSealsThatStick) {
  auto machine = machine_of("zhang-jiang-2021");
  const auto tuning = tune_controller(machine, machine.neutral());
  const ClosedLoop sliding(machine, machine.neutral(), {});
  for (auto& leg : machine.legs) leg.stick_stiffness = 5.3e7;
  const auto sticking = tune_controller(machine, machine.neutral());
  EXPECT_EQ(sticking.lowest_oil_mode, tuning.lowest_oil_mode);
  EXPECT_EQ(sticking.parameters.gain, tuning.parameters.gain);
  EXPECT_EQ(sticking.parameters.feedback_gain, tuning.parameters.feedback_gain);
  EXPECT_EQ(instability(ClosedLoop(machine, machine.neutral(), {})), instability(sliding));
}

}  // namespace
}  // namespace hydrapod::simulation
