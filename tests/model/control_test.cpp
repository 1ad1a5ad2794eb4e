/// The tables [controller] and [sensors] of the machine file.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

#include "hydrapod/model/machine_file.hpp"
#include "sound_machine.hpp"

namespace hydrapod::model {
namespace {

Machine with(const std::vector<std::string>& overrides) {
  return parse_machine(sound_machine_file, "m.toml", overrides).machine;
}

/// In one line, as inline tables are.
std::string joined(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

TEST(ControlFile, HasDefaultsWithoutAnyTable) {
  const auto machine = with({});
  EXPECT_EQ(machine.controller.space, ControlSpace::pose);
  EXPECT_FALSE(machine.controller.gain.has_value());
  EXPECT_FALSE(machine.controller.bandwidth.has_value());
  EXPECT_EQ(machine.controller.sample_time, 1e-3);
  EXPECT_EQ(machine.controller.delay, 1.0);
  EXPECT_EQ(machine.controller.compensation, Compensation::load);
  EXPECT_EQ(machine.sensors.length.resolution, 5e-6);
  EXPECT_FALSE(machine.sensors.length.low.has_value());
}

TEST(ControlFile, ALimitInAnotherUnitIsNotLostToRounding) {
  for (const char* shortest : {"10 us", "1e-05 s", "0.01 ms"})
    EXPECT_DOUBLE_EQ(
        with({fmt::format("controller.sample_time={}", shortest)}).controller.sample_time, 1e-5);
}

TEST(ControlFile, ReadsEveryKeyInItsUnit) {
  const auto machine = with(
      {joined(
           R"(controller={space = "leg", gain = [1, 2, 3, 4, 5, "6 Hz"], integral_time = "250 ms",
      velocity_feedforward = "90 %", feedback = "acceleration", feedback_damping = 0.31,
      feedback_gain = "2 ms", feedback_corner = "30 deg/s", sample_time = "500 us", delay = 1.5,
      compensation = "asymmetry", overlap_compensation = 0.7, output = {limit = 0.8,
      resolution = "0.1 %", scale = 1.1, offset = [0, 0.01, 0, 0, 0, -0.02]}})"),
       joined(R"(sensors={length = {resolution = "10 um", noise = "3 um", range = ["1.2 m", 2]},
      pressure = {noise = "0.2 bar"}, acceleration = {resolution = 0.5}})")});
  const auto& control = machine.controller;
  EXPECT_EQ(control.space, ControlSpace::leg);
  EXPECT_EQ(*control.gain, (Vector6() << 1, 2, 3, 4, 5, 6).finished());
  EXPECT_EQ(control.integral_time, 0.25);
  EXPECT_EQ(control.velocity_feedforward, 0.9);
  EXPECT_EQ(control.feedback, DampingFeedback::acceleration);
  EXPECT_EQ(control.feedback_damping, 0.31);
  EXPECT_EQ(control.feedback_gain, 2e-3);
  EXPECT_NEAR(*control.feedback_corner, 0.523598775598299, 1e-15);
  EXPECT_EQ(control.sample_time, 5e-4);
  EXPECT_EQ(control.delay, 1.5);
  EXPECT_EQ(control.compensation, Compensation::asymmetry);
  EXPECT_EQ(control.overlap_compensation, 0.7);
  EXPECT_EQ(control.output.limit, 0.8);
  EXPECT_EQ(control.output.resolution, 1e-3);
  EXPECT_EQ(control.output.scale, Vector6::Constant(1.1));
  EXPECT_EQ(control.output.offset, (Vector6() << 0, 0.01, 0, 0, 0, -0.02).finished());
  EXPECT_NEAR(machine.sensors.length.resolution, 1e-5, 1e-20);
  EXPECT_EQ(machine.sensors.length.low, 1.2);
  EXPECT_EQ(machine.sensors.length.high, 2.0);
  EXPECT_NEAR(machine.sensors.pressure.noise, 2e4, 1e-10);
  EXPECT_EQ(machine.sensors.acceleration.resolution, 0.5);
}

TEST(ControlFile, OneGainIsForAllSixAndTakesTheBandwidthAway) {
  const auto machine = with({"controller.bandwidth=12", "controller.gain=7"});
  EXPECT_EQ(*machine.controller.gain, Vector6::Constant(7.0));
  EXPECT_FALSE(machine.controller.bandwidth.has_value());
}

struct Wrong {
  std::string override_text{};
  std::string message{};  ///< after "--set …: error: "
};
void PrintTo(const Wrong& wrong, std::ostream* out) { *out << wrong.override_text; }

class WrongControl : public testing::TestWithParam<Wrong> {};

TEST_P(WrongControl, GetsItsMessage) {
  const auto& [text, message] = GetParam();
  EXPECT_EQ(complaint_about(sound_machine_file, {text}), "--set " + text + ": error: " + message);
}

INSTANTIATE_TEST_SUITE_P(
    Overrides, WrongControl,
    testing::Values(
        Wrong{"controller.space=legs",
              "controller.space: is the string \"legs\", expected \"pose\" or \"leg\""},
        Wrong{"controller.gains=3", "controller.gains: unknown key; did you mean `gain`?"},
        Wrong{"controller.gain=[1, 2, 3]",
              "controller.gain: is an array of 3, expected an array of 6 numbers in 1/s"},
        Wrong{"controller.gain=-1", "controller.gain: is -1 1/s, expected 0 or more"},
        Wrong{
            "controller.bandwidth=2 Hz",
            "controller.bandwidth: \"2 Hz\" has the unit \"Hz\" (a frequency), expected an angular "
            "speed such as \"rad/s\""},
        Wrong{"controller.bandwidth=0", "controller.bandwidth: is 0 rad/s, expected more than 0"},
        Wrong{"controller.integral_time=-1 s",
              "controller.integral_time: is -1 s, expected 0 or more"},
        Wrong{"controller.sample_time=2",
              "controller.sample_time: is 2 s, expected 1e-05 s to 1 s"},
        Wrong{"controller.delay=101",
              "controller.delay: is 101 samples, expected no more than 100"},
        Wrong{"controller.feedback_damping=3",
              "controller.feedback_damping: is 3, expected no more than 2"},
        Wrong{"controller.overlap_compensation=1.5",
              "controller.overlap_compensation: is 1.5, expected 1 or less"},
        Wrong{"controller.output.limit=0", "controller.output.limit: is 0, expected more than 0"},
        Wrong{"controller.output.offset=[0, 0, 0, 1, 0, 0]",
              "controller.output.offset: is 1, expected a share of full drive: more than -1, less "
              "than 1"},
        Wrong{"sensors.length.noise=-1 um",
              "sensors.length.noise: is -1e-06 m, expected 0 or more"},
        Wrong{"sensors.length.range=[2, 1]",
              "sensors.length.range: goes from 2 m to 1 m, expected the lower end first"},
        Wrong{"sensors.pressure.resolution=1 m",
              "sensors.pressure.resolution: \"1 m\" has the unit \"m\" (a length), expected a "
              "pressure such as \"Pa\""}));

}  // namespace
}  // namespace hydrapod::model
