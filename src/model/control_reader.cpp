#include "control_reader.hpp"

#include <fmt/format.h>

#include <array>

namespace hydrapod::model {

namespace {

/// One number for all six, or an array of six.
std::optional<Vector6> read_six(const Section& table, std::string_view key, std::string_view unit) {
  const auto value = table.find(key);
  if (!value) return std::nullopt;
  if (value.node->kind != Node::Kind::array)
    return Vector6::Constant(table.read_number(value, unit));
  const auto numbers = table.read_array(value, 6, unit);
  return Vector6(Eigen::Map<const Vector6>(numbers.data()));
}

DriveOutput read_output(const Section& controller) {
  const Section table = controller.optional_table("output");
  const DriveOutput standard;
  return {table.number("limit", "1", standard.limit),
          table.number("resolution", "1", standard.resolution),
          read_six(table, "scale", "1").value_or(standard.scale),
          read_six(table, "offset", "1").value_or(standard.offset)};
}

Sensor read_sensor(const Section& sensors, std::string_view key, std::string_view unit,
                   const Sensor& standard) {
  const Section table = sensors.optional_table(key);
  Sensor sensor{table.number("resolution", unit, standard.resolution),
                table.number("noise", unit, standard.noise), standard.low, standard.high};
  if (const auto range = table.find("range")) {
    const auto ends = table.read_array(range, 2, unit);
    sensor.low = ends[0];
    sensor.high = ends[1];
  }
  return sensor;
}

}  // namespace

ControlSettings read_controller(const Section& root) {
  const Section table = root.optional_table("controller");
  constexpr std::string_view spaces[]{"pose", "leg"};
  constexpr std::string_view feedbacks[]{"pressure", "acceleration", "none"};
  constexpr std::string_view compensations[]{"load", "asymmetry", "none"};
  const ControlSettings standard;
  ControlSettings settings;
  settings.space = static_cast<ControlSpace>(table.word("space", spaces));
  const auto loop = table.choice("gain", "bandwidth");
  if (loop == "gain") settings.gain = read_six(table, "gain", "1/s");
  if (loop == "bandwidth") settings.bandwidth = table.number("bandwidth", "rad/s");
  settings.integral_time = table.optional_number("integral_time", "s");
  settings.velocity_feedforward =
      table.number("velocity_feedforward", "1", standard.velocity_feedforward);
  settings.feedback = static_cast<DampingFeedback>(table.word("feedback", feedbacks));
  settings.feedback_damping = table.number("feedback_damping", "1", standard.feedback_damping);
  settings.feedback_gain = table.optional_number(
      "feedback_gain", settings.feedback == DampingFeedback::acceleration ? "s" : "m/(N s)");
  settings.feedback_corner = table.optional_number("feedback_corner", "rad/s");
  settings.sample_time = table.number("sample_time", "s", standard.sample_time);
  settings.delay = table.number("delay", "1", standard.delay);
  settings.compensation = static_cast<Compensation>(table.word("compensation", compensations));
  settings.overlap_compensation =
      table.number("overlap_compensation", "1", standard.overlap_compensation);
  settings.output = read_output(table);
  return settings;
}

Sensors read_sensors(const Section& root) {
  const Section table = root.optional_table("sensors");
  const Sensors standard;
  return {read_sensor(table, "length", "m", standard.length),
          read_sensor(table, "pressure", "Pa", standard.pressure),
          read_sensor(table, "acceleration", "m/s^2", standard.acceleration)};
}

}  // namespace hydrapod::model
