#include "hydrapod/model/machine.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hydrapod::model {

namespace {
constexpr double degree = std::numbers::pi / 180.0;

Vector3 on_circle(double radius, double angle) {
  return {radius * std::cos(angle), radius * std::sin(angle), 0.0};
}
}  // namespace

namespace {
bool is_elastomer(const std::optional<Elastomer>& seal) { return seal.has_value(); }
bool is_pressed(const std::optional<Elastomer>& seal) {
  return seal && seal->pressure_stiffening != 0.0;
}
bool any_seal(const Machine& machine, bool (*is)(const std::optional<Elastomer>&)) {
  return std::ranges::any_of(machine.legs, [&](const Leg& leg) {
    return is(leg.guide_sleeve.elastomer) || (leg.piston_ring && is(leg.piston_ring->elastomer));
  });
}
}  // namespace

bool has_elastomers(const Machine& machine) { return any_seal(machine, is_elastomer); }
bool has_pressed_seals(const Machine& machine) { return any_seal(machine, is_pressed); }

bool has_elastic_legs(const Machine& machine) {
  return std::ranges::any_of(machine.legs,
                             [](const Leg& leg) { return leg.bending == LegBending::elastic; });
}

LegType leg_type(const Leg& leg) {
  if (leg.strut) return LegType::strut;
  return leg.screw ? LegType::screw : LegType::cylinder;
}

std::optional<double> rod_diameter(const Leg& leg) {
  if (leg.rod.diameter) return leg.rod.diameter;
  const auto& cylinder = leg.oil_spring.cylinder;
  if (!cylinder || !(cylinder->rod_diameter > 0.0)) return {};
  return cylinder->rod_diameter;
}

bool has_leg_dampers(const Machine& machine) {
  return std::ranges::any_of(machine.legs, [](const Leg& leg) {
    return leg.guide_sleeve.damping != 0.0 || leg.oil_spring.damping != 0.0 ||
           (leg.piston_ring && leg.piston_ring->damping != 0.0) ||
           (leg.strut && leg.strut->damping != 0.0) || (leg.screw && leg.screw->damping != 0.0);
  });
}

bool has_rayleigh_damping(const Machine& machine) {
  return machine.damping.rayleigh_mass != 0.0 || machine.damping.rayleigh_stiffness != 0.0;
}

namespace {
bool states_flow(const LegHydraulics& of) {
  return of.valve.rated_flow || of.valve.leakage.value_or(0.0) != 0.0 ||
         of.leakage.internal.value_or(0.0) != 0.0 || of.leakage.external != 0.0;
}
}  // namespace

bool has_chambers(const Machine& machine) {
  if (machine.damping.oil != OilDamping::automatic)
    return machine.damping.oil == OilDamping::chambers;
  return leg_type(machine) == LegType::cylinder &&
         std::ranges::any_of(machine.legs,
                             [](const Leg& leg) { return states_flow(leg.hydraulics); });
}

ModalRatio modal_ratio(const Machine& machine) {
  return has_chambers(machine) ? ModalRatio{} : seal_ratio(machine);
}

ModalRatio seal_ratio(const Machine& machine) {
  if (machine.damping.modal_ratio) return {*machine.damping.modal_ratio, false};
  if (has_leg_dampers(machine) || has_elastomers(machine) || has_rayleigh_damping(machine))
    return {0.0, false};
  return {default_modal_ratio, true};
}

JointPoints base_joint_points(const JointCircle& circle) {
  const double alpha = circle.half_angle();
  JointPoints points;
  for (int pair = 0; pair < 3; ++pair) {
    const double center = (60.0 + 120.0 * pair) * degree;
    points[2 * pair] = on_circle(circle.radius, center - alpha);
    points[2 * pair + 1] = on_circle(circle.radius, center + alpha);
  }
  return points;
}

JointPoints platform_joint_points(const JointCircle& circle) {
  const double alpha = circle.half_angle();
  JointPoints points;
  for (int pair = 0; pair < 3; ++pair) {
    points[2 * pair] = on_circle(circle.radius, 120.0 * pair * degree + alpha);
    points[2 * pair + 1] = on_circle(circle.radius, 120.0 * (pair + 1) * degree - alpha);
  }
  return points;
}

}  // namespace hydrapod::model
