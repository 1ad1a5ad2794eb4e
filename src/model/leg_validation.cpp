#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>

#include "validate_values.hpp"
#include "value_checks.hpp"

namespace hydrapod::model {

namespace {

constexpr double unit_length_tolerance = 1e-9;
constexpr double half_turn = std::numbers::pi;
constexpr double relative_tolerance = 1e-9;

/// Mass, inertia about its centre, and that a body can have them: about its axis no body has more
/// than twice what it has across (2 I_t = I_a + twice the integral of z²).
void check_body(const std::string& key, double mass, double mass_center, double transverse,
                double axial, ValueChecks& checks) {
  checks.not_negative(key + ".mass", mass, "kg");
  checks.finite(key + ".mass_center", mass_center, "m");
  const bool across = checks.not_negative(key + ".transverse_inertia", transverse, "kg m^2");
  const bool along = checks.not_negative(key + ".axial_inertia", axial, "kg m^2");
  if (across && along && axial > 2.0 * transverse * (1.0 + relative_tolerance)) {
    checks.add(key + ".axial_inertia",
               fmt::format("is {:.6g} kg m^2: no body has this, expected no more than twice the "
                           "transverse inertia, {:.6g} kg m^2",
                           axial, 2.0 * transverse));
  }
}

/// With the platform held, the case turns about the base joint and the rod about the platform
/// joint: a part without inertia about its joint would leave the mass matrix singular.
void check_flexible_inertia(const Leg& leg, ValueChecks& checks) {
  const auto& [case_mass, r_b, I_t, I_ta] = leg.cylinder_case;
  const double to_joint = leg.rod.length - leg.rod.mass_center;
  const double of_case = I_t + case_mass * r_b * r_b;
  const double of_rod = leg.rod.transverse_inertia + leg.rod.mass * to_joint * to_joint;
  constexpr double least = 1.0 / largest_number;
  if (of_case + of_rod < least) {
    checks.add("rod.transverse_inertia",
               "case and rod have no inertia about their joints, expected a mass or a transverse "
               "inertia for one of them");
  } else if (leg.piston_ring && of_case < least) {
    checks.add("case.transverse_inertia",
               "the case has no inertia about the base joint, expected a mass or a transverse "
               "inertia because the piston ring lets it move on its own");
  } else if (leg.piston_ring && of_rod < least) {
    checks.add("rod.transverse_inertia",
               "the rod has no inertia about the platform joint, expected a mass or a transverse "
               "inertia because the piston ring lets it move on its own");
  }
}

void check_air(const EntrainedAir& air, ValueChecks& checks) {
  const std::string key = "oil_spring.cylinder.air";
  if (checks.not_negative(key + ".fraction", air.fraction, "1") && air.fraction >= 1.0) {
    checks.add(key + ".fraction", fmt::format("is {:.6g}, expected less than 1", air.fraction));
  }
  checks.positive(key + ".pressure", air.pressure, "Pa");
  if (checks.finite(key + ".polytropic", air.polytropic, "1") &&
      (air.polytropic < 1.0 || air.polytropic > 2.0)) {
    checks.add(key + ".polytropic",
               fmt::format("is {:.6g}, expected 1 (slow) to about 1.4 (fast)", air.polytropic));
  }
}

void check_volumes(const Cylinder& cylinder, bool has_stroke, ValueChecks& checks) {
  const std::string key = "oil_spring.cylinder";
  checks.not_negative(key + ".cap_dead_volume", cylinder.cap_dead_volume, "m^3");
  checks.not_negative(key + ".rod_dead_volume", cylinder.rod_dead_volume, "m^3");
  checks.not_negative(key + ".cap_line_volume", cylinder.cap_line_volume, "m^3");
  checks.not_negative(key + ".rod_line_volume", cylinder.rod_line_volume, "m^3");
  if (cylinder.control_volume) {
    checks.positive(key + ".control_volume", *cylinder.control_volume, "m^3");
  }
  if (has_stroke) return;
  if (cylinder.volumes == VolumeRule::chambers) {
    checks.add(key + ".volumes",
               "\"chambers\" follows the piston and needs a stroke, expected a table `stroke`, or "
               "volumes = \"equal\" with a `control_volume`");
  } else if (!cylinder.control_volume) {
    checks.add(key + ".control_volume",
               "is needed for volumes = \"equal\" where there is no stroke to take the mean from, "
               "expected a volume above 0 or a table `stroke`");
  }
}

void check_cylinder(const Cylinder& cylinder, bool has_stroke, ValueChecks& checks) {
  const std::string key = "oil_spring.cylinder";
  const bool bore = checks.positive(key + ".bore", cylinder.bore, "m");
  const bool rod = checks.not_negative(key + ".rod_diameter", cylinder.rod_diameter, "m");
  if (bore && rod && cylinder.rod_diameter >= cylinder.bore) {
    checks.add(key + ".rod_diameter", fmt::format("is {:.6g} m, expected less than the bore, "
                                                  "{:.6g} m",
                                                  cylinder.rod_diameter, cylinder.bore));
  }
  checks.positive(key + ".bulk_modulus", cylinder.bulk_modulus, "Pa");
  if (cylinder.air) check_air(*cylinder.air, checks);
  check_volumes(cylinder, has_stroke, checks);
}

void check_oil_spring(const Leg& leg, ValueChecks& checks) {
  const auto& spring = leg.oil_spring;
  if (spring.stiffness && spring.cylinder) {
    checks.add("oil_spring", "both `stiffness` and `cylinder` are given, expected one of them");
  } else if (!spring.stiffness && !spring.cylinder) {
    checks.add("oil_spring", "neither `stiffness` nor `cylinder` is given, expected one of them");
  }
  if (spring.stiffness) checks.positive("oil_spring.stiffness", *spring.stiffness, "N/m");
  if (spring.cylinder) check_cylinder(*spring.cylinder, leg.stroke.has_value(), checks);
  checks.not_negative("oil_spring.damping", spring.damping, "N s/m");
}

void check_seals(const Leg& leg, ValueChecks& checks) {
  checks.positive("guide_sleeve.position", leg.guide_sleeve.position, "m");
  checks.positive("guide_sleeve.stiffness", leg.guide_sleeve.stiffness, "N/m");
  checks.not_negative("guide_sleeve.damping", leg.guide_sleeve.damping, "N s/m");
  if (!leg.piston_ring) return;
  checks.positive("piston_ring.stiffness", leg.piston_ring->stiffness, "N/m");
  checks.not_negative("piston_ring.damping", leg.piston_ring->damping, "N s/m");
}

/// At both ends of its stroke the piston is on the base side of the guide sleeve, and the guide
/// sleeve is on the rod.
void check_stroke(const Leg& leg, ValueChecks& checks) {
  if (!leg.stroke) return;
  const auto& [retracted, length] = *leg.stroke;
  const bool begins = checks.not_negative("stroke.retracted", retracted, "m");
  const bool has_length = checks.positive("stroke.length", length, "m");
  const double L_g = leg.guide_sleeve.position;
  if (!begins || !has_length || !std::isfinite(L_g) || L_g <= 0.0) return;  // said elsewhere
  if (L_g <= retracted + length) {
    checks.add("guide_sleeve.position",
               fmt::format("is {:.6g} m, expected more than the piston's position at the end of "
                           "its stroke, {:.6g} m",
                           L_g, retracted + length));
  }
  if (leg.rod.length > 0.0 && L_g >= retracted + leg.rod.length) {
    checks.add("guide_sleeve.position",
               fmt::format("is {:.6g} m, expected less than the rod's end with the piston "
                           "retracted, {:.6g} m",
                           L_g, retracted + leg.rod.length));
  }
}

void check_joint_limit(const std::string& key, const std::optional<double>& limit,
                       ValueChecks& checks) {
  if (!limit || !checks.positive(key, *limit, "rad")) return;
  if (*limit > half_turn * (1.0 + relative_tolerance)) {
    checks.add(key, fmt::format("is {:.6g} deg, expected no more than 180 deg",
                                *limit * 180.0 / std::numbers::pi));
  }
}

void check_gimbal_axis(const Vector3& axis, ValueChecks& checks) {
  if (!checks.finite("gimbal_axis", axis, "1")) return;
  if (axis.isZero(0.0)) {
    checks.add("gimbal_axis", "is zero, expected a direction such as [0, 1, 0]");
  } else if (std::abs(axis.norm() - 1.0) > unit_length_tolerance) {
    checks.add("gimbal_axis",
               fmt::format("has the length {:.6g}, expected a unit vector", axis.norm()));
  }
}

}  // namespace

std::vector<Finding> leg_findings(const Leg& leg, NonFinite non_finite) {
  ValueChecks checks(non_finite);
  const auto& body = leg.cylinder_case;
  check_body("case", body.mass, body.mass_center, body.transverse_inertia, body.axial_inertia,
             checks);
  const auto& rod = leg.rod;
  checks.positive("rod.length", rod.length, "m");
  check_body("rod", rod.mass, rod.mass_center, rod.transverse_inertia, rod.axial_inertia, checks);
  check_flexible_inertia(leg, checks);
  check_seals(leg, checks);
  check_oil_spring(leg, checks);
  check_stroke(leg, checks);
  check_joint_limit("joint_limits.base", leg.joint_limits.base, checks);
  check_joint_limit("joint_limits.platform", leg.joint_limits.platform, checks);
  checks.not_negative("added_axial_inertia", leg.added_axial_inertia, "kg");
  if (leg.gimbal_stiffness) checks.positive("gimbal_stiffness", *leg.gimbal_stiffness, "N/m");
  check_gimbal_axis(leg.gimbal_axis, checks);
  check_leg_hydraulics(leg, checks);
  return checks.take();
}

}  // namespace hydrapod::model
