/// Hold, ramp down, rest; and what watches a real machine; and the accounts of the clock.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hydrapod/kinematics/legs.hpp"
#include "realtime/follower.hpp"
#include "realtime/guard.hpp"
#include "realtime/pace.hpp"
#include "support/loop_machine.hpp"
#include "support/random.hpp"

namespace hydrapod::realtime {
namespace {

constexpr double T = 1e-3;

Command at_pose(double z, double rate = 0.0) {
  Command command;
  command.displacement[2] = z;
  command.rate[2] = rate;
  command.drive[4] = 0.03;
  command.wrench[0] = 120.0;
  return command;
}

simulation::Excitation filled(const Follower& follower, double time) {
  simulation::Excitation excitation;
  follower.fill(time, excitation);
  return excitation;
}

TEST(Follower, HoldsThenRampsSmoothlyDownThenRests) {
  Vector6 rest = Vector6::Zero();
  rest[2] = -0.02;
  Follower follower({.hold = 0.0503, .ramp = 0.37}, rest);
  Counters counters;
  EXPECT_EQ(follower.state(), State::waiting);
  EXPECT_TRUE(filled(follower, 0.0).command.value.isZero());
  follower.follow(at_pose(7e-3, 0.4), 1.0);
  EXPECT_EQ(filled(follower, 1.0).command.rate[2], 0.4);
  EXPECT_EQ(filled(follower, 1.0).drive[4], 0.03);
  long k = 1000;
  for (; k < 1050; ++k) {
    follower.go_on(T * static_cast<double>(k + 1), Vector6::Zero(), counters);
    const auto held = filled(follower, T * static_cast<double>(k + 1));
    ASSERT_EQ(follower.state(), State::holding) << k;
    EXPECT_EQ(held.command.value[2], 7e-3);
    EXPECT_EQ(held.command.rate[2], 0.0);  // it stands
    EXPECT_EQ(held.drive[4], 0.03);
    EXPECT_EQ(held.wrench[0], 120.0);
  }
  EXPECT_EQ(counters.trips, 0U);
  double last = 7e-3, steepest = 0.0;
  for (++k; follower.state() != State::parked; ++k) {
    ASSERT_LT(k, 1500);
    const double time = T * static_cast<double>(k);
    follower.go_on(time, Vector6::Zero(), counters);
    const auto going = filled(follower, time);
    EXPECT_TRUE(going.drive.isZero());
    EXPECT_TRUE(going.wrench.isZero());
    // the rate is that of the displacement: central difference of a polynomial, error of order T²
    const double difference = (filled(follower, time + 1e-6).command.value[2] -
                               filled(follower, time - 1e-6).command.value[2]) /
                              2e-6;
    if (follower.state() == State::ramping && k > 1052)
      EXPECT_NEAR(going.command.rate[2], difference, 1e-7) << k;
    steepest = std::max(steepest, std::abs(going.command.value[2] - last) / T);
    last = going.command.value[2];
  }
  EXPECT_EQ(counters.trips, 1U);
  EXPECT_EQ(last, -0.02);
  // the steepest slope of 10 τ³ − 15 τ⁴ + 6 τ⁵ is 15/8
  EXPECT_NEAR(steepest, 0.027 / 0.37 * 15.0 / 8.0, 1e-4 * steepest);
  EXPECT_EQ(k, 1051 + 371);
  follower.go_on(9.0, Vector6::Zero(), counters);
  EXPECT_EQ(counters.missed, 51U);  // while a client was followed
  follower.follow(at_pose(1e-3), 9.0);
  EXPECT_EQ(follower.state(), State::following);
}

TEST(Follower, OfValvesRampsFromWhereThePlatformIs) {
  Follower follower({.hold = 0.01, .ramp = 0.5}, Vector6::Zero());
  Counters counters;
  Command command;
  command.mode = static_cast<std::uint64_t>(Mode::valves);
  command.drive[2] = -0.07;
  follower.follow(command, 0.0);
  ASSERT_TRUE(filled(follower, 0.0).outside.has_value());
  EXPECT_EQ((*filled(follower, 0.0).outside)[2], -0.07);
  Vector6 actual = Vector6::Zero();
  actual[1] = 3.3e-3;
  follower.go_on(0.011, actual, counters);
  EXPECT_FALSE(filled(follower, 0.011).outside.has_value());
  EXPECT_EQ(filled(follower, 0.011).command.value[1], 3.3e-3);
  EXPECT_EQ(filled(follower, 0.511).command.value[1], 0.0);
}

class Guards : public testing::Test {
 protected:
  model::Machine machine = simulation::machine_of("zhang-jiang-2021");
  Pose pose = machine.neutral();
  Vector6 rest = kinematics::leg_lengths(machine, pose);
  Guard guard{
      machine, pose, {.length = 0.02, .velocity = 0.1, .acceleration = 5.0, .error = 3e-3}, T, 2};

  /// The first message when the platform moves as `displacement`, and is measured so with `extra`
  /// on leg 4.
  std::string moved(
      const std::function<Vector6(double)>& displacement,
      const std::function<double(double)>& extra = [](double) { return 0.0; },
      double accelerometer = 0.0) {
    for (int k = 0; k < 1000; ++k) {
      const double t = T * k;
      Sensors sensors;
      sensors.length = kinematics::leg_lengths(
          machine, simulation::command_at(pose, {.value = displacement(t)}).X_BP);
      sensors.length[3] += extra(t);
      sensors.accelerometer[1] = accelerometer;
      if (auto message = guard.see(sensors, displacement(t)); !message.empty()) return message;
    }
    return "";
  }
};

Vector6 up(double z) { return Vector6::Unit(2) * z; }

TEST_F(Guards, LetWhatIsWithinTheLimitsPass) {
  EXPECT_EQ(moved([](double t) { return up(2e-3 * (1.0 - std::cos(40.0 * t))); }), "");
}
TEST_F(Guards, WatchTheLength) {
  EXPECT_THAT(moved([](double t) { return up(0.02 * (1.0 - std::cos(3.0 * t))); }),
              testing::HasSubstr("is displaced by"));
  EXPECT_THAT(guard.commanded(up(0.05)), testing::HasSubstr("the limit is 20 mm"));
  EXPECT_EQ(guard.commanded(up(0.01)), "");
}
TEST_F(Guards, WatchTheSpeed) {
  EXPECT_THAT(moved([](double t) { return up(6e-3 * (1.0 - std::cos(25.0 * t))); }),
              testing::HasSubstr("moves at"));
}
TEST_F(Guards, WatchTheAcceleration) {
  EXPECT_THAT(moved([](double t) { return up(5e-4 * (1.0 - std::cos(130.0 * t))); }),
              testing::HasSubstr("accelerates at"));
}
TEST_F(Guards, WatchTheAccelerometers) {
  EXPECT_THAT(moved([](double) { return up(0.0); }, [](double) { return 0.0; }, -5.1),
              testing::HasSubstr("accelerometer 2 shows -5.1"));
}
TEST_F(Guards, WatchTheFollowingError) {
  EXPECT_THAT(moved([](double) { return up(0.0); }, [](double t) { return 4e-3 * t; }),
              testing::HasSubstr("leg 4: has a following error of 3.0"));
}
TEST_F(Guards, ForgiveOneSampleAndDropOuts) {
  EXPECT_EQ(moved([](double) { return up(0.0); },
                  [](double t) { return std::abs(t - 0.3) < 0.5 * T ? std::nan("") : 0.0; }),
            "");
}
TEST_F(Guards, KnowThePose) {
  Sensors sensors;
  sensors.length = rest;
  EXPECT_EQ(guard.at_pose(sensors), "");
  sensors.length[5] += 0.0171;
  EXPECT_THAT(guard.at_pose(sensors), testing::HasSubstr("leg 6 is measured"));
  sensors.length[2] = std::nan("");
  EXPECT_THAT(guard.at_pose(sensors), testing::HasSubstr("no leg lengths"));
}

TEST(Histogram, HasTheSharesOfItsSamples) {
  Histogram histogram;
  test::Random random(20);
  std::vector<double> all;
  for (int k = 0; k < 20'000; ++k) {
    all.push_back(std::exp(random.uniform(std::log(2e-7), std::log(3e-3))));
    histogram.add(all.back());
  }
  std::ranges::sort(all);
  const Timing timing = histogram.timing();
  EXPECT_EQ(timing.samples, 20'000);
  EXPECT_EQ(timing.worst, all.back());
  const double bin = std::exp2(1.0 / 24.0);  // 3 % upwards at most
  for (const auto& [share, found] : {std::pair{0.5, timing.p50},
                                     {0.99, timing.p99},
                                     {0.999, timing.p99_9},
                                     {0.9999, timing.p99_99}}) {
    const double exact = all[static_cast<std::size_t>(std::ceil(share * 20'000)) - 1];
    EXPECT_GE(found, exact) << share;
    EXPECT_LE(found, exact * bin) << share;
  }
  long counted = 0;
  for (const auto& one : timing.bins) counted += one.samples;
  EXPECT_EQ(counted, 20'000);
}

TEST(Pace, CountsSamplesThatBeginTooLate) {
  Pace pace(2e-3);
  for (int k = 0; k < 5; ++k) {
    pace.wait_for_next();
    pace.work_begins();
    if (k == 2) {  // 7 ms of work: steps 3, 4 and 5 are due in the meantime
      const double begin = seconds_of(CLOCK_MONOTONIC);
      while (seconds_of(CLOCK_MONOTONIC) < begin + 7e-3) {
      }
    }
    pace.work_ends();
  }
  ServeResult result;
  pace.tell(result);
  EXPECT_GE(result.misses, 2U);
  EXPECT_GE(result.overruns, 2U);
  EXPECT_GE(result.lateness.worst, 4.9e-3);
  EXPECT_GE(result.step.worst, 7e-3);
  EXPECT_EQ(result.lateness.samples, 5);
}

}  // namespace
}  // namespace hydrapod::realtime
