#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "conditioning.hpp"
#include "hydrapod/control/controller.hpp"

namespace hydrapod::control {

namespace {

constexpr double least_share = 0.04;  // of the supply's force on the piston

void require(bool sound, const char* name, double value, const char* expected) {
  if (!sound)
    throw std::invalid_argument(
        fmt::format("ControllerParameters::{} is {:.6g}, expected {}", name, value, expected));
}

void validate_axis(const DriveAxis& axis) {
  const auto positive = [](const char* name, double value) {
    require(std::isfinite(value) && value > 0.0, name, value, "more than 0");
  };
  require(std::isfinite(axis.load), "axes.load", axis.load, "a finite number");
  if (axis.full_speed != 0.0) return positive("axes.full_speed", axis.full_speed);
  positive("axes.piston_area", axis.piston_area);
  positive("axes.annulus_area", axis.annulus_area);
  positive("axes.flow_coefficient", axis.flow_coefficient);
  positive("axes.supply_pressure", axis.supply_pressure);
  require(axis.return_pressure >= 0.0 && axis.return_pressure < axis.supply_pressure,
          "axes.return_pressure", axis.return_pressure, "0 to less than the supply pressure");
  require(std::isfinite(axis.overlap), "axes.overlap", axis.overlap, "a finite number");
}

}  // namespace

AxisSpeeds full_drive_speeds(const DriveAxis& axis, double load) {
  if (axis.full_speed > 0.0) return {axis.full_speed, axis.full_speed};
  const double A_1 = axis.piston_area;
  const double A_2 = axis.annulus_area;
  const double p_s = axis.supply_pressure;
  const double p_t = axis.return_pressure;
  const double least = least_share * p_s * A_1;
  const double cubes = A_1 * A_1 * A_1 + A_2 * A_2 * A_2;
  const auto speed = [&](double force) {
    return axis.flow_coefficient * std::sqrt(std::max(force, least) / cubes);
  };
  return {speed(p_s * A_1 - p_t * A_2 - load), speed(p_s * A_2 - p_t * A_1 + load)};
}

double log_speed_per_load(const DriveAxis& axis, double load, bool extending) {
  if (axis.full_speed > 0.0) return 0.0;
  const double A_1 = axis.piston_area, A_2 = axis.annulus_area;
  const double p_s = axis.supply_pressure, p_t = axis.return_pressure;
  const double force = extending ? p_s * A_1 - p_t * A_2 - load : p_s * A_2 - p_t * A_1 + load;
  if (force <= least_share * p_s * A_1) return 0.0;
  return (extending ? -0.5 : 0.5) / force;
}

void validate(const ControllerParameters& parameters) {
  for (int i = 0; i < 6; ++i) {
    const double gain = parameters.gain[i];
    require(std::isfinite(gain) && gain >= 0.0, "gain", gain, "0 or more");
    require(std::isfinite(parameters.feedback_gain[i]), "feedback_gain",
            parameters.feedback_gain[i], "a finite number");
  }
  const auto not_negative = [](const char* name, double value) {
    require(std::isfinite(value) && value >= 0.0, name, value, "0 or more");
  };
  not_negative("integral_time", parameters.integral_time);
  not_negative("feedback_corner", parameters.feedback_corner);
  not_negative("delay", parameters.delay);
  not_negative("overlap_compensation", parameters.overlap_compensation);
  not_negative("output.resolution", parameters.output.resolution);
  require(std::isfinite(parameters.sample_time) && parameters.sample_time > 0.0, "sample_time",
          parameters.sample_time, "more than 0");
  require(parameters.output.limit > 0.0 && parameters.output.limit <= 1.0, "output.limit",
          parameters.output.limit, "more than 0, no more than 1");
  for (const auto& axis : parameters.axes) validate_axis(axis);
}

}  // namespace hydrapod::control
