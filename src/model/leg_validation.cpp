#include <fmt/format.h>

#include <cmath>
#include <string>

#include "value_checks.hpp"

namespace hydrapod::model {

namespace {

constexpr double unit_length_tolerance = 1e-9;
constexpr double relative_tolerance = 1e-9;

/// About its axis no body has more inertia than twice what it has across (2 I_t = I_a + twice the
/// integral of z²).
void check_body(const std::string& key, double transverse, double axial, ValueChecks& checks) {
  if (checks.sound(key + ".transverse_inertia") && checks.sound(key + ".axial_inertia") &&
      axial > 2.0 * transverse * (1.0 + relative_tolerance)) {
    checks.add(key + ".axial_inertia",
               fmt::format("is {:.6g} kg m^2: no body has this, expected no more than twice the "
                           "transverse inertia, {:.6g} kg m^2",
                           axial, 2.0 * transverse));
  }
}

/// With the platform held, the case turns about the base joint and the rod about the platform
/// joint: a part without inertia about its joint would leave the mass matrix singular.
void check_flexible_inertia(const Leg& leg, ValueChecks& checks) {
  // nothing follows from a number that is wrong itself
  for (const auto* key : {"case.mass", "case.mass_center", "case.transverse_inertia", "rod.mass",
                          "rod.mass_center", "rod.transverse_inertia", "rod.length"})
    if (!checks.sound(key)) return;
  const auto& of = leg.cylinder_case;
  const double to_joint = leg.rod.length - leg.rod.mass_center;
  const double of_case = of.transverse_inertia + of.mass * of.mass_center * of.mass_center;
  const double of_rod = leg.rod.transverse_inertia + leg.rod.mass * to_joint * to_joint;
  constexpr double least = 1.0 / largest_number;
  if (of_case + of_rod < least) {
    checks.add("rod.transverse_inertia",
               "case and rod have no inertia about their joints, expected a mass or a transverse "
               "inertia for one of them");
  } else if (leg.piston_ring && of_case < least) {
    checks.add("case.transverse_inertia",
               "the case has no inertia about the base joint, expected a mass or a transverse "
               "inertia because it moves independently with a piston ring");
  } else if (leg.piston_ring && of_rod < least) {
    checks.add("rod.transverse_inertia",
               "the rod has no inertia about the platform joint, expected a mass or a transverse "
               "inertia because it moves independently with a piston ring");
  }
}

void check_wall(const std::string& key, double wall, double diameter, ValueChecks& checks) {
  if (checks.sound(key + ".wall") && checks.sound(key + ".diameter") && wall > 0.5 * diameter)
    checks.add_unexpected(key + ".wall", wall, "m", "no more than half the diameter",
                          0.5 * diameter);
}

/// What the leg as a column is made of.
void check_sections(const Leg& leg, ValueChecks& checks) {
  const auto& around = leg.cylinder_case;
  const auto& rod = leg.rod;
  if (around.diameter && around.wall)
    check_wall("case", *around.wall, *around.diameter, checks);
  else if (around.diameter)
    checks.add("case.wall", "is missing beside `diameter`, expected the thickness of the wall");
  else if (around.wall)
    checks.add("case.diameter", "is missing beside `wall`, expected the outside diameter");
  const auto& cylinder = leg.oil_spring.cylinder;
  if (rod.wall && !rod.diameter && !cylinder) {
    checks.add("rod.diameter", "is missing beside `wall`, expected the outside diameter");
  } else if (rod.wall) {
    check_wall("rod", *rod.wall, rod.diameter ? *rod.diameter : cylinder->rod_diameter, checks);
  }
  if (rod.diameter && cylinder && checks.sound("rod.diameter") && *rod.diameter >= cylinder->bore)
    checks.add_unexpected("rod.diameter", *rod.diameter, "m", "less than the bore", cylinder->bore);
}

/// What rod and case are as beams.
void check_bending(const Leg& leg, ValueChecks& checks) {
  if (leg.bending == LegBending::elastic && !rod_diameter(leg))
    checks.add("bending",
               "is \"elastic\" for a rod of unknown thickness, expected `rod.diameter` (or "
               "`oil_spring.cylinder.rod_diameter`); `rod.wall` too where the rod is hollow");
}

void check_volumes(const Cylinder& cylinder, bool has_stroke, ValueChecks& checks) {
  const std::string key = "oil_spring.cylinder";
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

/// The cross-section of a line is its volume over its length.
void check_line(const std::string& side, double length, double volume, ValueChecks& checks) {
  const std::string key = "oil_spring.cylinder." + side + "_line_";
  if (!checks.sound(key + "length") || !checks.sound(key + "volume")) return;
  if (length > 0.0 && volume == 0.0)
    checks.add(key + "volume",
               fmt::format("is 0 beside `{}_line_length`, expected the volume of the line", side));
}

void check_cylinder(const Cylinder& cylinder, bool has_stroke, ValueChecks& checks) {
  const std::string key = "oil_spring.cylinder";
  if (checks.sound(key + ".bore") && checks.sound(key + ".rod_diameter") &&
      cylinder.rod_diameter >= cylinder.bore) {
    checks.add_unexpected(key + ".rod_diameter", cylinder.rod_diameter, "m", "less than the bore",
                          cylinder.bore);
  }
  check_volumes(cylinder, has_stroke, checks);
  check_line("cap", cylinder.cap_line_length, cylinder.cap_line_volume, checks);
  check_line("rod", cylinder.rod_line_length, cylinder.rod_line_volume, checks);
}

void check_screw(const Leg& leg, ValueChecks& checks) {
  const auto& screw = *leg.screw;
  if (screw.torque_limit && checks.sound("screw.torque_limit") &&
      checks.sound("screw.friction_torque") && screw.friction_torque >= *screw.torque_limit)
    checks.add_unexpected("screw.friction_torque", screw.friction_torque, "N m",
                          "less than the torque limit", *screw.torque_limit);
  const auto pressed = [](const std::optional<Elastomer>& seal) {
    return seal && seal->pressure_stiffening != 0.0;
  };
  if (pressed(leg.guide_sleeve.elastomer) ||
      (leg.piston_ring && pressed(leg.piston_ring->elastomer)))
    checks.add(pressed(leg.guide_sleeve.elastomer) ? "guide_sleeve.elastomer.pressure_stiffening"
                                                   : "piston_ring.elastomer.pressure_stiffening",
               "needs oil beside the seal, and an electric cylinder has none; expected 0");
}

void check_oil_spring(const Leg& leg, ValueChecks& checks) {
  if (leg.screw) return check_screw(leg, checks);
  const auto& spring = leg.oil_spring;
  if (spring.stiffness && spring.cylinder) {
    checks.add("oil_spring", "both `stiffness` and `cylinder` are given, expected one of them");
  } else if (!spring.stiffness && !spring.cylinder) {
    checks.add("oil_spring", "neither `stiffness` nor `cylinder` is given, expected one of them");
  }
  if (spring.cylinder) check_cylinder(*spring.cylinder, leg.stroke.has_value(), checks);
}

/// What the stiffness over frequency follows from.
void check_elastomer(const std::string& key, const std::optional<Elastomer>& elastomer,
                     ValueChecks& checks) {
  if (!elastomer) return;
  const bool all = elastomer->dynamic_ratio && elastomer->loss_factor && elastomer->frequency;
  const bool some = elastomer->dynamic_ratio || elastomer->loss_factor || elastomer->frequency;
  if (elastomer->arms && some)
    checks.add(key,
               "has arms (or a table) and `dynamic_ratio`, `loss_factor` or `frequency`, "
               "expected one of both");
  else if (!elastomer->arms && !all)
    checks.add(key,
               "expected `dynamic_ratio`, `loss_factor` and `frequency`, or `arms`, or a "
               "`table` of measured values");
  else if (elastomer->arms && checks.sound(key + ".arms.strength") &&
           elastomer->arms->strength.isZero(0.0))
    checks.add(key + ".arms.strength", "is 0 for all arms, expected one above 0");
}

/// At both ends of its stroke the piston is on the base side of the guide sleeve, and the guide
/// sleeve is on the rod.
void check_stroke(const Leg& leg, ValueChecks& checks) {
  if (!leg.stroke) return;
  const auto& [retracted, length] = *leg.stroke;
  const double L_g = leg.guide_sleeve.position;
  for (const auto* key : {"stroke.retracted", "stroke.length", "guide_sleeve.position"})
    if (!checks.sound(key)) return;
  if (L_g <= retracted + length) {
    checks.add_unexpected("guide_sleeve.position", L_g, "m",
                          "more than the piston's position at the end of its stroke",
                          retracted + length);
  }
  if (leg.rod.length > 0.0 && L_g >= retracted + leg.rod.length) {
    checks.add_unexpected("guide_sleeve.position", L_g, "m",
                          "less than the rod's end with the piston retracted",
                          retracted + leg.rod.length);
  }
}

void check_gimbal_axis(const Vector3& axis, ValueChecks& checks) {
  if (!checks.sound("gimbal_axis")) return;
  if (axis.isZero(0.0)) {
    checks.add("gimbal_axis", "is zero, expected a direction such as [0, 1, 0]");
  } else if (std::abs(axis.norm() - 1.0) > unit_length_tolerance) {
    checks.add("gimbal_axis",
               fmt::format("has the length {:.6g}, expected a unit vector", axis.norm()));
  }
}

}  // namespace

std::vector<Finding> leg_findings(const Machine& machine, int index, NonFinite non_finite) {
  ValueChecks checks(non_finite);
  checks.rows(machine, index);
  const auto& leg = machine.legs[static_cast<std::size_t>(index)];
  // where values are missing, the reader has said why
  if (leg_type(leg) != leg_type(machine) && non_finite == NonFinite::report)
    checks.add(leg.strut   ? "strut"
               : leg.screw ? "screw"
                           : "oil_spring",
               fmt::format("makes this leg of the type {}, and leg 1 is a {}; expected six legs "
                           "of one type",
                           name(leg_type(leg)), name(leg_type(machine))));
  if (leg.strut) {
    check_gimbal_axis(leg.gimbal_axis, checks);
    check_leg_hydraulics(leg, checks);
    return checks.take();
  }
  check_body("case", leg.cylinder_case.transverse_inertia, leg.cylinder_case.axial_inertia, checks);
  check_body("rod", leg.rod.transverse_inertia, leg.rod.axial_inertia, checks);
  check_flexible_inertia(leg, checks);
  check_sections(leg, checks);
  check_bending(leg, checks);
  check_oil_spring(leg, checks);
  check_elastomer("guide_sleeve.elastomer", leg.guide_sleeve.elastomer, checks);
  if (leg.piston_ring) check_elastomer("piston_ring.elastomer", leg.piston_ring->elastomer, checks);
  check_stroke(leg, checks);
  check_gimbal_axis(leg.gimbal_axis, checks);
  check_leg_hydraulics(leg, checks);
  return checks.take();
}

}  // namespace hydrapod::model
