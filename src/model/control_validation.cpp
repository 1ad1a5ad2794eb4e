#include <fmt/format.h>

#include <cmath>

#include "validate_values.hpp"
#include "value_checks.hpp"

namespace hydrapod::model {

namespace {

constexpr double most_delay = 100.0;           ///< [samples]
constexpr double longest_sample_time = 1.0;    ///< [s]
constexpr double shortest_sample_time = 1e-5;  ///< [s]

void check_six(const std::string& key, const Vector6& values, std::string_view unit,
               bool negative_too, ValueChecks& checks) {
  for (int i = 0; i < 6; ++i) {
    if (!(negative_too ? checks.finite(key, values[i], unit)
                       : checks.not_negative(key, values[i], unit)))
      return;
  }
}

void check_share(const std::string& key, double value, bool zero_too, ValueChecks& checks) {
  const bool sound =
      zero_too ? checks.not_negative(key, value, "1") : checks.positive(key, value, "1");
  if (sound && value > 1.0) checks.add(key, fmt::format("is {:.6g}, expected 1 or less", value));
}

void check_output(const DriveOutput& output, ValueChecks& checks) {
  const std::string key = "controller.output";
  check_share(key + ".limit", output.limit, false, checks);
  check_share(key + ".resolution", output.resolution, true, checks);
  check_six(key + ".scale", output.scale, "1", true, checks);
  check_six(key + ".offset", output.offset, "1", true, checks);
  if (output.offset.allFinite() && output.offset.cwiseAbs().maxCoeff() >= 1.0)
    checks.add(key + ".offset", fmt::format("is {:.6g}, expected a share of full drive: more than "
                                            "-1, less than 1",
                                            output.offset.cwiseAbs().maxCoeff()));
}

void check_timing(const ControlSettings& control, ValueChecks& checks) {
  const double time = control.sample_time;
  if (checks.positive("controller.sample_time", time, "s") &&
      (time > longest_sample_time || time < shortest_sample_time))
    checks.add("controller.sample_time", fmt::format("is {:.6g} s, expected {:g} s to {:g} s", time,
                                                     shortest_sample_time, longest_sample_time));
  if (checks.not_negative("controller.delay", control.delay, "1") && control.delay > most_delay)
    checks.add("controller.delay", fmt::format("is {:.6g} samples, expected no more than {:g}",
                                               control.delay, most_delay));
}

void check_sensor(const std::string& key, const Sensor& sensor, std::string_view unit,
                  ValueChecks& checks) {
  checks.not_negative(key + ".resolution", sensor.resolution, unit);
  checks.not_negative(key + ".noise", sensor.noise, unit);
  if (sensor.low && !checks.finite(key + ".range", *sensor.low, unit)) return;
  if (sensor.high && !checks.finite(key + ".range", *sensor.high, unit)) return;
  if (sensor.low && sensor.high && *sensor.low >= *sensor.high)
    checks.add(key + ".range",
               fmt::format("goes from {:.6g} {} to {:.6g} {}, expected the lower end first",
                           *sensor.low, unit, *sensor.high, unit));
}

}  // namespace

void check_control(const ControlSettings& control, const Sensors& sensors, ValueChecks& checks) {
  if (control.gain) check_six("controller.gain", *control.gain, "1/s", false, checks);
  if (control.bandwidth) checks.positive("controller.bandwidth", *control.bandwidth, "rad/s");
  if (control.integral_time)
    checks.not_negative("controller.integral_time", *control.integral_time, "s");
  checks.finite("controller.velocity_feedforward", control.velocity_feedforward, "1");
  if (checks.not_negative("controller.feedback_damping", control.feedback_damping, "1") &&
      control.feedback_damping > 2.0)
    checks.add("controller.feedback_damping",
               fmt::format("is {:.6g}, expected no more than 2", control.feedback_damping));
  if (control.feedback_gain)
    checks.finite("controller.feedback_gain", *control.feedback_gain, "SI");
  if (control.feedback_corner)
    checks.not_negative("controller.feedback_corner", *control.feedback_corner, "rad/s");
  check_timing(control, checks);
  check_share("controller.overlap_compensation", control.overlap_compensation, true, checks);
  check_output(control.output, checks);
  check_sensor("sensors.length", sensors.length, "m", checks);
  check_sensor("sensors.pressure", sensors.pressure, "Pa", checks);
  check_sensor("sensors.acceleration", sensors.acceleration, "m/s^2", checks);
}

}  // namespace hydrapod::model
