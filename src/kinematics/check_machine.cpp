#include "hydrapod/kinematics/check_machine.hpp"

#include <fmt/format.h>

#include <numbers>

namespace hydrapod::kinematics {

namespace {

constexpr double degrees = 180.0 / std::numbers::pi;
using model::Finding;

/// Messages of one pose, filed under its key.
struct Findings {
  std::string key;
  std::vector<Finding> list{};
  void error(std::string message) {
    list.push_back({base::Severity::error, key, std::move(message)});
  }
};

/// False when the leg has no piston position at all, so that the other checks make no sense.
bool check_length(const model::Leg& leg, int number, double length, Findings& findings) {
  if (length > leg.rod.length) return true;
  findings.error(fmt::format(
      "leg {} is {:.4g} m long, shorter than its rod of {:.4g} m; move the platform away from the "
      "base or shorten the rod",
      number, length, leg.rod.length));
  return false;
}

void check_stroke(const model::Leg& leg, int number, double l_m, Findings& findings) {
  if (!leg.stroke) return;
  const double low = leg.stroke->retracted;
  const double high = low + leg.stroke->length;
  if (l_m >= low && l_m <= high) return;
  findings.error(fmt::format(
      "the piston of leg {} is {:.4g} m from its base joint, {:.3g} m {} its stroke from {:.4g} m "
      "to {:.4g} m",
      number, l_m, l_m < low ? low - l_m : l_m - high, l_m < low ? "below" : "beyond", low, high));
}

void check_guide_sleeve(const model::Leg& leg, int number, double l_m, Findings& findings) {
  const double l_mh = leg.guide_sleeve.position - l_m;
  if (l_mh > 0.0 && l_mh < leg.rod.length) return;
  findings.error(fmt::format(
      "the guide sleeve of leg {} stands {:.4g} m from its base joint; it must lie on the rod, "
      "between the piston at {:.4g} m and the platform joint at {:.4g} m",
      number, leg.guide_sleeve.position, l_m, l_m + leg.rod.length));
}

void check_tilt(int number, const char* joint, double tilt, std::optional<double> limit,
                Findings& findings) {
  if (!limit || tilt <= *limit) return;
  findings.error(
      fmt::format("the {} joint of leg {} is tilted {:.3g}° from the neutral pose, "
                  "limit {:.3g}°",
                  joint, number, tilt * degrees, *limit * degrees));
}

void check_legs(const model::Machine& machine, const Pose& X_BP, Findings& findings) {
  const auto lengths = leg_lengths(machine, X_BP);
  const auto angles = joint_angles(machine, X_BP);
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine.legs[i];
    const double l_m = lengths[i] - leg.rod.length;
    if (!check_length(leg, i + 1, lengths[i], findings)) continue;
    check_stroke(leg, i + 1, l_m, findings);
    check_guide_sleeve(leg, i + 1, l_m, findings);
    check_tilt(i + 1, "base", angles[i].base_tilt, leg.joint_limits.base, findings);
    check_tilt(i + 1, "platform", angles[i].platform_tilt, leg.joint_limits.platform, findings);
  }
}

void check_singular(const model::Machine& machine, const Pose& X_BP, Findings& findings) {
  const auto quality = pose_quality(machine, X_BP);
  if (quality.condition < singular_condition) return;
  constexpr double shown = 0.005;  // below this two decimals say 0.00, and must not say -0.00
  const Vector6 d =
      (quality.weakest_direction.array().abs() < shown).select(0.0, quality.weakest_direction);
  findings.error(fmt::format(
      "singular pose: the legs cannot resist the platform motion (x, y, z, rx, ry, rz) = ({:.2f}, "
      "{:.2f}, {:.2f}, {:.2f}, {:.2f}, {:.2f}) [m, rad]; condition of the Jacobian {:.2g}, "
      "accepted below {:.0g}",
      d[0], d[1], d[2], d[3], d[4], d[5], quality.condition, singular_condition));
}

}  // namespace

std::vector<Finding> check_pose(const model::Machine& machine, const Pose& X_BP,
                                const std::string& key) {
  Findings findings{key};
  check_legs(machine, X_BP, findings);
  if (findings.list.empty()) check_singular(machine, X_BP, findings);
  return findings.list;
}

std::vector<Finding> check_machine(const model::Machine& machine) {
  auto findings = model::validate(machine);
  for (const auto& finding : findings)
    if (finding.severity == base::Severity::error) return findings;
  for (const auto& pose : machine.poses) {
    const auto more = check_pose(machine, pose.X_BP, "poses." + pose.name);
    findings.insert(findings.end(), more.begin(), more.end());
  }
  return findings;
}

}  // namespace hydrapod::kinematics
