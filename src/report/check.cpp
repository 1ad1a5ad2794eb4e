#include "hydrapod/report/model_results.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "fields.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"

namespace hydrapod::report {

namespace {

/// "leg 3", "legs 1, 2 and 5", "all legs".
std::string legs_text(const std::vector<int>& legs) {
  if (legs.empty()) return {};
  if (legs.size() == model::leg_count) return "all legs";
  std::string text = fmt::format("leg{} {}", legs.size() > 1 ? "s" : "", legs[0] + 1);
  for (size_t k = 1; k < legs.size(); ++k)
    text += fmt::format("{} {}", k + 1 == legs.size() ? " and" : ",", legs[k] + 1);
  return text;
}

}  // namespace

std::string mass_text(double mass) {
  return std::abs(mass) < 1e4 ? fmt::format("{:.4g} kg", mass) : fmt::format("{:.0f} kg", mass);
}

std::string warning_text(const PoseWarning& warning) {
  static constexpr std::array texts{
      "the legs buckle under the present load: remove {mass}, or use stiffer guide sleeves",
      "the legs buckle with {mass} more on the platform ({ratio:.3g} times its mass)",
      "no static equilibrium was found at this pose",
      "{legs}: only {millimetres:.3g} mm of stroke left",
      "{legs}: the piston is only {millimetres:.3g} mm from the guide sleeve; the tilt stiffness "
      "is "
      "low there",
      "{legs}: the static load tilts the rod in its seals by {degrees:.2g}°",
      "the pose is close to a singular pose: condition {value:.3g}"};
  const double value = warning.value;
  const std::string mass = mass_text(value), legs = legs_text(warning.legs);
  return fmt::format(fmt::runtime(texts.at(static_cast<std::size_t>(warning.kind))),
                     fmt::arg("value", value), fmt::arg("ratio", warning.ratio),
                     fmt::arg("mass", mass), fmt::arg("legs", legs),
                     fmt::arg("millimetres", 1e3 * value),
                     fmt::arg("degrees", value * (180.0 / std::numbers::pi)));
}

template <class Fields>
void describe(Fields& f, LegCheck& leg) {
  f("length_m", leg.length);
  f("piston_m", leg.piston);
  f("guided_length_m", leg.guided_length);
  f("oil_stiffness_N_m", leg.oil_stiffness);
  f("axial_force_N", leg.axial_force);
  f("static_tilt_rad", leg.tilt);
  f("base_joint_tilt_rad", leg.base_tilt);
  f("platform_joint_tilt_rad", leg.platform_tilt);
  f.optional("retract_left_m", leg.retract_left);
  f.optional("extend_left_m", leg.extend_left);
}

template <class Fields>
void describe(Fields& f, PoseWarning& warning) {
  static constexpr std::array words{"buckled",       "near_buckling", "no_equilibrium",
                                    "little_stroke", "short_guide",   "tilted_rod",
                                    "near_singular"};
  f.word("kind", warning.kind, words);
  f("value", warning.value);
  f("ratio", warning.ratio);
  f("legs", warning.legs);
}

template <class Fields>
void describe(Fields& f, PoseCheck& check) {
  f("pose", check.pose);
  f("condition", check.quality.condition);
  f("characteristic_length_m", check.quality.characteristic_length);
  f("equilibrium", check.equilibrium);
  f("legs", check.legs);
  f.object("buckling", [&](auto& b) {
    enum class Sought { found, not_found, buckled, not_sought };
    static constexpr std::array words{"found", "not_found", "buckled", "not_sought"};
    auto status =
        check.buckling_sought ? static_cast<Sought>(check.buckling.status) : Sought::not_sought;
    b.word("status", status, words);
    check.buckling_sought = status != Sought::not_sought;
    if (!check.buckling_sought) return;
    check.buckling.status = static_cast<dynamics::BucklingStatus>(status);
    if (check.buckling.status == dynamics::BucklingStatus::not_found) return;
    b("payload_kg", check.buckling.payload);
    b("limit_point", check.buckling.limit_point);
    b.optional("lowest_omega_rad_s", check.lowest_at_buckling);
  });
  std::vector<std::string> words;
  for (const auto& warning : check.warnings) words.push_back(warning_text(warning));
  f.derived("warnings", words);
  f("findings", check.warnings);
}

Json check_json(const std::vector<PoseCheck>& poses, const model::Machine& machine) {
  Json json{{"simulation_assumptions", Json::array()}, {"poses", written(poses)}};
  for (const auto& one : hydraulics::hydraulic_assumptions(machine))
    json["simulation_assumptions"].push_back({{"key", one.key}, {"text", one.text}});
  return json;
}

std::vector<PoseCheck> checks_from_json(const Json& json, const std::string& file) {
  std::vector<PoseCheck> poses;
  Reader(json, file)("poses", poses);
  return poses;
}

}  // namespace hydrapod::report
