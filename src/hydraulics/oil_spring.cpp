#include "hydrapod/hydraulics/servo_axis.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace hydrapod::hydraulics {

double effective_bulk_modulus(const model::Cylinder& cylinder) {
  const double beta = cylinder.bulk_modulus;
  if (!cylinder.air) return beta;
  const auto& air = *cylinder.air;
  const double x =
      air.fraction * std::pow(atmospheric_pressure / air.pressure, 1.0 / air.polytropic);
  const double oil = 1.0 - air.fraction;
  return (oil + x) / (oil / beta + x / (air.polytropic * air.pressure));
}

CylinderAreas areas(const model::Cylinder& cylinder) {
  constexpr double quarter_pi = std::numbers::pi / 4.0;
  const double piston = quarter_pi * cylinder.bore * cylinder.bore;
  return {piston, piston - quarter_pi * cylinder.rod_diameter * cylinder.rod_diameter};
}

ChamberVolumes chamber_volumes(const model::Cylinder& cylinder, const model::Stroke& stroke,
                               double l_m) {
  const auto [piston, annulus] = areas(cylinder);
  const double extension = l_m - stroke.retracted;
  return {
      piston * extension + cylinder.cap_dead_volume + cylinder.cap_line_volume,
      annulus * (stroke.length - extension) + cylinder.rod_dead_volume + cylinder.rod_line_volume};
}

double control_volume(const model::Leg& leg) {
  const auto& cylinder = *leg.oil_spring.cylinder;
  if (cylinder.control_volume) return *cylinder.control_volume;
  if (!leg.stroke) throw std::invalid_argument("oil spring: control volume needs a stroke");
  const auto mid =
      chamber_volumes(cylinder, *leg.stroke, leg.stroke->retracted + 0.5 * leg.stroke->length);
  return 0.5 * (mid.cap + mid.rod);
}

namespace {

bool has_hoses(const model::Cylinder& cylinder) {
  return cylinder.cap_line_compliance != 0.0 || cylinder.rod_line_compliance != 0.0;
}

/// Volumes by the cylinder's rule.
ChamberVolumes ruled_volumes(const model::Leg& leg, double l_m) {
  const auto& cylinder = *leg.oil_spring.cylinder;
  if (cylinder.volumes == model::VolumeRule::equal) {
    const double V_0 = control_volume(leg);
    return {V_0, V_0};
  }
  if (!leg.stroke) throw std::invalid_argument("oil spring: chamber volumes need a stroke");
  return chamber_volumes(cylinder, *leg.stroke, l_m);
}

/// A line of a chamber whose other volume is still.
struct Line {
  double length{}, volume{}, compliance{};  ///< of the line: [m], [m³], of its wall [m³/Pa]
  double chamber_area{}, chamber_volume{};
};

double inertia_of(const Line& line, double density, double beta) {
  if (line.length == 0.0) return 0.0;
  const double share =
      (line.volume / beta + line.compliance) / (line.chamber_volume / beta + line.compliance);
  const double section = line.volume / line.length;
  return density * line.length * line.chamber_area * line.chamber_area / section * share * share /
         3.0;
}

}  // namespace

double line_inertia(const model::Leg& leg, double l_m) {
  if (!leg.oil_spring.cylinder) return 0.0;
  const auto& cylinder = *leg.oil_spring.cylinder;
  if (cylinder.cap_line_length == 0.0 && cylinder.rod_line_length == 0.0) return 0.0;
  const double beta = effective_bulk_modulus(cylinder);
  const auto [piston, annulus] = areas(cylinder);
  const auto volume = ruled_volumes(leg, l_m);
  return inertia_of({cylinder.cap_line_length, cylinder.cap_line_volume,
                     cylinder.cap_line_compliance, piston, volume.cap},
                    cylinder.density, beta) +
         inertia_of({cylinder.rod_line_length, cylinder.rod_line_volume,
                     cylinder.rod_line_compliance, annulus, volume.rod},
                    cylinder.density, beta);
}

double oil_stiffness(const model::Leg& leg, double l_m) {
  if (leg.strut) return leg.strut->stiffness;
  if (leg.screw) return leg.screw->stiffness;
  if (leg.oil_spring.stiffness) return *leg.oil_spring.stiffness;
  if (!leg.oil_spring.cylinder)
    throw std::invalid_argument("oil spring: neither stiffness nor cylinder is given");
  const auto& cylinder = *leg.oil_spring.cylinder;
  const double beta = effective_bulk_modulus(cylinder);
  const auto [piston, annulus] = areas(cylinder);
  if (has_hoses(cylinder)) {
    const auto volume = ruled_volumes(leg, l_m);
    return piston * piston / (volume.cap / beta + cylinder.cap_line_compliance) +
           annulus * annulus / (volume.rod / beta + cylinder.rod_line_compliance);
  }
  if (cylinder.volumes == model::VolumeRule::equal)
    return beta * (piston * piston + annulus * annulus) / control_volume(leg);
  if (!leg.stroke) throw std::invalid_argument("oil spring: chamber volumes need a stroke");
  const auto volume = chamber_volumes(cylinder, *leg.stroke, l_m);
  return beta * (piston * piston / volume.cap + annulus * annulus / volume.rod);
}

AxialSpring axial_spring(const model::Leg& leg, double l_m) {
  const double k_h = oil_stiffness(leg, l_m);
  const double damping = leg.strut   ? leg.strut->damping
                         : leg.screw ? leg.screw->damping
                                     : leg.oil_spring.damping;
  const double between = k_h + leg.stick_stiffness;  // of case and rod
  if (!leg.gimbal_stiffness) return {between, damping};
  const double share = *leg.gimbal_stiffness / (between + *leg.gimbal_stiffness);
  return {between * share, damping * share * share};
}

}  // namespace hydrapod::hydraulics
