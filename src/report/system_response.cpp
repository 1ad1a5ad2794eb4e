#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "gnuplot.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/report/model_results.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::report {

namespace {

using base::two_pi;
using spatial::direction_names;

/// Where `values` pass `level` downwards for the first time, between two logarithmic frequencies.
std::optional<double> first_below(const std::vector<double>& omega,
                                  const std::vector<double>& values, double level) {
  for (std::size_t k = 1; k < values.size(); ++k) {
    if (!(values[k] < level && values[k - 1] >= level)) continue;
    const double share = (values[k - 1] - level) / (values[k - 1] - values[k]);
    return omega[k - 1] * std::pow(omega[k] / omega[k - 1], share);
  }
  return std::nullopt;
}

}  // namespace

CommandBandwidth command_bandwidth(const CommandResponse& response, int direction) {
  CommandBandwidth found;
  std::vector<double> magnitude, phase;
  double last = 0.0;
  for (std::size_t k = 0; k < response.omega.size(); ++k) {
    const auto value = response.H[k](direction, direction);
    magnitude.push_back(std::abs(value));
    last = continued(std::arg(value), last, two_pi);
    phase.push_back(last);
    if (magnitude.back() > found.peak) {
      found.peak = magnitude.back();
      found.peak_omega = response.omega[k];
    }
  }
  found.magnitude = first_below(response.omega, magnitude, std::numbers::sqrt2 / 2.0);
  found.phase = first_below(response.omega, phase, -std::numbers::pi / 2.0);
  return found;
}

Json command_response_json(const CommandResponse& response) {
  Json json = response_json(response.omega, response.H);
  json["bandwidths"] = Json::array();
  const auto hertz = [](const std::optional<double>& omega) {
    return omega ? Json(*omega / two_pi) : Json();
  };
  for (int i = 0; i < 6; ++i) {
    const auto b = command_bandwidth(response, i);
    json["bandwidths"].push_back({{"direction", spatial::direction_name(i)},
                                  {"minus_3_db_hz", hertz(b.magnitude)},
                                  {"minus_90_deg_hz", hertz(b.phase)},
                                  {"peak", b.peak},
                                  {"peak_hz", b.peak_omega / two_pi}});
  }
  return json;
}

CommandResponse command_response_from_json(const Json& json, const std::string& file) {
  CommandResponse response;
  response.omega = response_from_json(json, file, response.H);
  return response;
}

std::string command_response_csv(const CommandResponse& response) {
  std::string text = "frequency_hz,omega_rad_s";
  for (const auto* out : direction_names)
    for (const auto* in : direction_names) text += fmt::format(",{0}/{1}_re,{0}/{1}_im", out, in);
  text += '\n';
  for (std::size_t k = 0; k < response.omega.size(); ++k) {
    text += fmt::format("{:.17g},{:.17g}", response.omega[k] / two_pi, response.omega[k]);
    for (int out = 0; out < 6; ++out)
      for (int in = 0; in < 6; ++in)
        text += fmt::format(",{:.17g},{:.17g}", response.H[k](out, in).real(),
                            response.H[k](out, in).imag());
    text += '\n';
  }
  return text;
}

}  // namespace hydrapod::report
