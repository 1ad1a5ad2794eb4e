#include "hydrapod/report/check.hpp"

#include <fmt/format.h>

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
    result.legs[i].axial_force = -statics.legs[i].oil_force;
    result.legs[i].tilt = statics.legs[i].flexible.head<2>().norm();
  }
}

void add_buckling(const model::Machine& machine, dynamics::ModelKind kind, PoseCheck& result) {
  if (kind == dynamics::ModelKind::rigid) return;
  result.buckling = dynamics::buckling_payload(machine, result.pose.X_BP, kind);
  if (result.buckling.status != dynamics::BucklingStatus::found) return;
  model::Machine loaded = machine;
  loaded.platform.mass += result.buckling.payload * (1.0 - 1e-5);
  const auto model = dynamics::linear_model(loaded, result.pose.X_BP, kind, &result.buckling.last);
  result.lowest_at_buckling = modal::normal_modes(model).omega(0);
}

void warn_of_load(const model::Machine& machine, PoseCheck& result) {
  const auto& buckling = result.buckling;
  if (buckling.status == dynamics::BucklingStatus::buckled)
    result.warnings.push_back(
        fmt::format("the legs buckle under the load they have: {:.4g} kg must come off, or the "
                    "guide sleeves must be "
                    "stiffer",
                    -buckling.payload));
  else if (buckling.status == dynamics::BucklingStatus::found &&
           buckling.payload < machine.platform.mass)
    result.warnings.push_back(fmt::format(
        "the legs buckle with {:.4g} kg more on the platform ({:.3g} times the mass it has)",
        buckling.payload, 1.0 + buckling.payload / machine.platform.mass));
  else if (!result.equilibrium)
    result.warnings.push_back("no static equilibrium was found at this pose");
}

void warn_of_legs(const model::Machine& machine, PoseCheck& result) {
  constexpr double little_stroke = 0.05;  // of the stroke
  constexpr double short_guide = 0.05;    // l_mh, of the rod's length
  constexpr double large_tilt = 0.02;     // rad
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = result.legs[i];
    const auto& stroke = machine.legs[i].stroke;
    if (stroke && std::min(*leg.retract_left, *leg.extend_left) < little_stroke * stroke->length)
      result.warnings.push_back(fmt::format("leg {}: only {:.3g} mm of stroke left", i + 1,
                                            1e3 * std::min(*leg.retract_left, *leg.extend_left)));
    if (leg.guided_length < short_guide * machine.legs[i].rod.length)
      result.warnings.push_back(fmt::format(
          "leg {}: the piston is only {:.3g} mm inside the guide sleeve; the knee is soft there",
          i + 1, 1e3 * leg.guided_length));
    if (leg.tilt > large_tilt)
      result.warnings.push_back(
          fmt::format("leg {}: the rod hangs {:.2g}° askew in its seals under the static load",
                      i + 1, leg.tilt * degrees));
  }
}

}  // namespace

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
