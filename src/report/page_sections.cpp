#include "hydrapod/report/measured_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "hydrapod/base/units.hpp"

namespace hydrapod::report {

namespace {

/// As exact as a picture shows it.
Json shortened(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  return std::strtod(fmt::format("{:.{}g}", value, digits).c_str(), nullptr);
}

Json short_list(const std::vector<double>& values, int digits = 5) {
  Json list = Json::array();
  for (const double value : values) list.push_back(shortened(value, digits));
  return list;
}

/// Of the motion in a direction per input.
std::string unit_of(const diagnosis::ResponseOverlay& overlay, int direction) {
  const bool turns = direction > 2;
  const std::string motion = turns ? "rad" : "m";
  // motions per command of several directions have none in common
  if (overlay.entry != observation::Entry::forces) return motion + " per input";
  if (!overlay.direct) return motion + " per N and N m";
  return turns ? "rad/(N m)" : "m/N";
}

Json curve_json(const diagnosis::ResponseOverlay& overlay, const diagnosis::ResponseCurve& curve) {
  Json predicted = Json::array();
  for (const auto& values : curve.predicted) predicted.push_back(short_list(values));
  return {{"direction", diagnosis::direction_name(curve.direction)},
          {"unit", unit_of(overlay, curve.direction)},
          {"measured", short_list(curve.measured)},
          {"predicted", std::move(predicted)}};
}

/// Lines far above the modes hold noise alone.
double highest_shown(const SideBySide& result) {
  constexpr double room = 1.5;
  double highest = 0.0;
  for (const auto& thing : result.things)
    for (const auto& mode : thing.modes) highest = std::max(highest, mode.omega / base::two_pi);
  return highest > 0.0 ? room * highest : std::numeric_limits<double>::infinity();
}

Json shown_response(const ComparedThing::Response& response, double highest) {
  constexpr std::size_t most = 1000;
  constexpr int digits = 6;
  std::size_t count = 0;
  while (count < response.frequency.size() && response.frequency[count] <= highest) ++count;
  const std::size_t every = std::max<std::size_t>(1, (count + most - 1) / most);
  Json json{{"name", response.name}, {"unit", response.unit}};
  for (const char* key : {"frequency_hz", "re", "im"}) json[key] = Json::array();
  for (std::size_t k = 0; k < count; k += every) {
    if (!(response.frequency[k] > 0.0)) continue;
    json["frequency_hz"].push_back(shortened(response.frequency[k], digits));
    json["re"].push_back(shortened(response.H[k].real(), digits));
    json["im"].push_back(shortened(response.H[k].imag(), digits));
  }
  return json;
}

}  // namespace

std::string verdict_text(const SideBySide& all, const ThingComparison& c) {
  std::size_t frequencies = 0, dampings = 0;
  bool tested = false;
  const ThingComparison::Pair* most = nullptr;
  const auto relative = [&](const auto& pair) {
    return pair.frequency.value /
           all.things.front().modes[static_cast<std::size_t>(pair.first)].omega;
  };
  using Verdict = TestedDifference::Verdict;
  for (const auto& pair : c.pairs) {
    frequencies += pair.frequency.verdict == Verdict::significant ? 1 : 0;
    dampings += pair.damping.verdict == Verdict::significant ? 1 : 0;
    for (const auto verdict : {pair.frequency.verdict, pair.damping.verdict})
      tested |= verdict == Verdict::significant || verdict == Verdict::not_significant;
    if (most == nullptr || std::abs(relative(pair)) > std::abs(relative(*most))) most = &pair;
  }
  const char b = static_cast<char>('A' + c.thing % 26);
  if (most == nullptr) return fmt::format("{} − A: no mode has a partner.", b);
  const double change = 100.0 * relative(*most);
  const std::string differ =
      tested ? fmt::format("{} frequencies and {} damping ratios differ significantly", frequencies,
                           dampings)
             : "no difference was tested, because no measurement uncertainty is known";
  return fmt::format(
      "{} − A: {} of {} modes of A have a partner; {}; largest change of a frequency {}{:.2f} % "
      "(mode {}).",
      b, c.pairs.size(), all.things.front().modes.size(), differ, change < 0.0 ? "−" : "+",
      std::abs(change), most->first + 1);
}

Json comparison_section(const SideBySide& result) {
  SideBySide bare = result;
  for (auto& thing : bare.things) thing.responses.clear();
  Json json = side_by_side_json(bare);
  const double highest = highest_shown(result);
  for (std::size_t k = 0; k < result.things.size(); ++k)
    for (const auto& response : result.things[k].responses)
      json["things"][k]["responses"].push_back(shown_response(response, highest));
  for (std::size_t k = 0; k < result.comparisons.size(); ++k)
    json["comparisons"][k]["verdict"] = verdict_text(result, result.comparisons[k]);
  return json;
}

Json response_overlays_json(const std::vector<diagnosis::ResponseOverlay>& overlays,
                            const std::vector<std::size_t>& hypotheses) {
  Json list = Json::array();
  for (const auto& overlay : overlays) {
    std::vector<double> hertz;
    for (const double omega : overlay.omega) hertz.push_back(omega / base::two_pi);
    Json curves = Json::array();
    for (const auto& curve : overlay.curves) curves.push_back(curve_json(overlay, curve));
    list.push_back({{"pose", overlay.pose},
                    {"entry", observation::name(overlay.entry)},
                    {"direct", overlay.direct},
                    {"scaled", overlay.scaled},
                    {"frequency_hz", short_list(hertz, 9)},  // resonances are narrow
                    {"hypotheses", hypotheses},
                    {"curves", std::move(curves)}});
  }
  return list;
}

}  // namespace hydrapod::report
