#include "hydrapod/report/check.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "hydrapod/hydraulics/oil_spring.hpp"
#include "hydrapod/modal/normal_modes.hpp"

namespace hydrapod::report {

namespace {

constexpr double degrees = 180.0 / std::numbers::pi;

LegCheck check_leg(const model::Leg& leg, double length, const kinematics::JointAngles& angles) {
  LegCheck result{.length = length, .piston = length - leg.rod.length};
  result.guided_length = leg.guide_sleeve.position - result.piston;
  result.oil_stiffness = hydraulics::oil_stiffness(leg, result.piston);
  result.base_tilt = angles.base_tilt;
  result.platform_tilt = angles.platform_tilt;
  if (leg.stroke) {
    result.retract_left = result.piston - leg.stroke->retracted;
    result.extend_left = leg.stroke->retracted + leg.stroke->length - result.piston;
  }
  return result;
}

void add_statics(const model::Machine& machine, dynamics::ModelKind kind, PoseCheck& result) {
  const auto statics = dynamics::static_equilibrium(machine, result.pose.X_BP, kind);
  result.equilibrium = statics.status == dynamics::StaticsStatus::converged;
  for (int i = 0; i < model::leg_count; ++i) {
    result.legs[i].axial_force = 0.0 - statics.legs[i].oil_force;  // no -0 without a load
    result.legs[i].tilt = statics.legs[i].flexible.head<2>().norm();
  }
}

void add_buckling(const model::Machine& machine, dynamics::ModelKind kind, PoseCheck& result) {
  result.buckling_sought = kind != dynamics::ModelKind::rigid && !machine.gravity.isZero(0.0);
  if (!result.buckling_sought) return;
  result.buckling = dynamics::buckling_payload(machine, result.pose.X_BP, kind);
  if (result.buckling.status != dynamics::BucklingStatus::found) return;
  model::Machine loaded = machine;
  const double just_below = 1.0 - dynamics::BucklingOptions{}.tolerance;  // of the bracketed load
  loaded.platform.mass = just_below * (machine.platform.mass + result.buckling.payload);
  const auto model = dynamics::linear_model(loaded, result.pose.X_BP, kind, &result.buckling.last);
  result.lowest_at_buckling = modal::normal_modes(model).omega(0);
}

void warn_of_load(const model::Machine& machine, PoseCheck& result) {
  const auto& buckling = result.buckling;
  if (buckling.status == dynamics::BucklingStatus::buckled)
    result.warnings.push_back(
        fmt::format("the legs buckle under the load they have: {} must come off, or the "
                    "guide sleeves must be stiffer",
                    mass_text(-buckling.payload)));
  else if (buckling.status == dynamics::BucklingStatus::found &&
           buckling.payload < machine.platform.mass)
    result.warnings.push_back(
        fmt::format("the legs buckle with {} more on the platform ({:.3g} times the mass it has)",
                    mass_text(buckling.payload), 1.0 + buckling.payload / machine.platform.mass));
  else if (!result.equilibrium)
    result.warnings.emplace_back("no static equilibrium was found at this pose");
}

/// "leg 3", "legs 1, 2 and 5", "all legs".
std::string legs_text(const std::vector<int>& legs) {
  if (legs.size() == model::leg_count) return "all legs";
  std::string text = fmt::format("leg{} {}", legs.size() > 1 ? "s" : "", legs[0] + 1);
  for (size_t k = 1; k < legs.size(); ++k)
    text += fmt::format("{} {}", k + 1 == legs.size() ? " and" : ",", legs[k] + 1);
  return text;
}

/// One warning for all legs whose `value` is bad, with the worst of them.
template <class Value, class Bad>
void warn_together(PoseCheck& result, const char* format, Value value, Bad bad,
                   bool smallest_is_worst) {
  std::vector<int> legs;
  double worst = 0.0;
  for (int i = 0; i < model::leg_count; ++i) {
    if (!bad(i)) continue;
    const double now = value(i);
    if (legs.empty() || (smallest_is_worst ? now < worst : now > worst)) worst = now;
    legs.push_back(i);
  }
  if (!legs.empty())
    result.warnings.push_back(fmt::format(fmt::runtime(format), legs_text(legs), worst));
}

void warn_of_legs(const model::Machine& machine, PoseCheck& result) {
  constexpr double little_stroke = 0.05;  // of the stroke
  constexpr double short_guide = 0.05;    // l_mh, of the rod's length
  constexpr double large_tilt = 0.02;     // rad
  const auto left = [&](int i) {
    return machine.legs[i].stroke
               ? std::min(*result.legs[i].retract_left, *result.legs[i].extend_left)
               : 1e9;
  };
  const auto guided = [&](int i) { return result.legs[i].guided_length; };
  const auto tilt = [&](int i) { return result.legs[i].tilt; };
  warn_together(
      result, "{}: only {:.3g} mm of stroke left", [&](int i) { return 1e3 * left(i); },
      [&](int i) {
        return machine.legs[i].stroke && left(i) < little_stroke * machine.legs[i].stroke->length;
      },
      true);
  warn_together(
      result, "{}: the piston is only {:.3g} mm inside the guide sleeve; the knee is soft there",
      [&](int i) { return 1e3 * guided(i); },
      [&](int i) { return guided(i) < short_guide * machine.legs[i].rod.length; }, true);
  warn_together(
      result, "{}: the rod hangs {:.2g}° askew in its seals under the static load",
      [&](int i) { return tilt(i) * degrees; },
      [&](int i) { return result.equilibrium && tilt(i) > large_tilt; }, false);
}

}  // namespace

std::string mass_text(double mass) {
  return std::abs(mass) < 1e4 ? fmt::format("{:.4g} kg", mass) : fmt::format("{:.0f} kg", mass);
}

PoseCheck check(const model::Machine& machine, const PoseChoice& pose, dynamics::ModelKind kind) {
  PoseCheck result{.pose = pose, .quality = kinematics::pose_quality(machine, pose.X_BP)};
  const auto lengths = kinematics::leg_lengths(machine, pose.X_BP);
  const auto angles = kinematics::joint_angles(machine, pose.X_BP);
  for (int i = 0; i < model::leg_count; ++i)
    result.legs[i] = check_leg(machine.legs[i], lengths[i], angles[i]);
  add_statics(machine, kind, result);
  add_buckling(machine, kind, result);
  warn_of_load(machine, result);
  warn_of_legs(machine, result);
  constexpr double poor_condition = 100.0;
  if (result.quality.condition > poor_condition)
    result.warnings.push_back(
        fmt::format("the pose is near a singular one: condition {:.3g}", result.quality.condition));
  return result;
}

namespace {

Json leg_json(const LegCheck& leg) {
  Json json{{"length_m", leg.length},
            {"piston_m", leg.piston},
            {"guided_length_m", leg.guided_length},
            {"oil_stiffness_N_m", leg.oil_stiffness},
            {"axial_force_N", leg.axial_force},
            {"static_tilt_rad", leg.tilt},
            {"base_joint_tilt_rad", leg.base_tilt},
            {"platform_joint_tilt_rad", leg.platform_tilt}};
  if (leg.retract_left) json["retract_left_m"] = *leg.retract_left;
  if (leg.extend_left) json["extend_left_m"] = *leg.extend_left;
  return json;
}

Json buckling_json(const PoseCheck& check) {
  const auto& buckling = check.buckling;
  if (!check.buckling_sought) return {{"status", "not_sought"}};
  constexpr std::array<const char*, 3> words{"found", "not_found", "buckled"};
  Json json{{"status", words[static_cast<size_t>(buckling.status)]}};
  if (buckling.status == dynamics::BucklingStatus::not_found) return json;
  json["payload_kg"] = buckling.payload;
  json["limit_point"] = buckling.limit_point;
  if (check.lowest_at_buckling) json["lowest_omega_rad_s"] = *check.lowest_at_buckling;
  return json;
}

}  // namespace

Json check_json(const PoseCheck& check) {
  Json json{{"pose", pose_json(check.pose)},    {"condition", check.quality.condition},
            {"equilibrium", check.equilibrium}, {"legs", Json::array()},
            {"buckling", buckling_json(check)}, {"warnings", check.warnings}};
  for (const auto& leg : check.legs) json["legs"].push_back(leg_json(leg));
  return json;
}

}  // namespace hydrapod::report
