#include "hydrapod/hydraulics/servo_axis.hpp"

#include <cmath>
#include <limits>

#include "equivalent_cylinder.hpp"
#include "hydrapod/base/error.hpp"

namespace hydrapod::hydraulics {

namespace {

constexpr double load_share = 1.0 / 6.0;        // of the supply pressure carries the platform
constexpr double no_load_speed = 0.5;           // m/s at the rated flow
constexpr double valve_leakage_share = 0.01;    // of the rated flow
constexpr double piston_leakage_share = 0.01;   // of the rated flow, at the supply pressure
constexpr double breakaway_ratio = 1.5;         // F_s / F_c
constexpr double viscous_per_coulomb = 10.0;    // s/m
constexpr double stop_stiffness_ratio = 20.0;   // to the oil spring at mid stroke
constexpr double usable_share = 0.9;            // of the way that an unknown stroke may take
constexpr double least_dead_share = 0.1;        // of half the stroke, on the cap side
constexpr double smallest_volume_share = 0.01;  // of a chamber at mid stroke

/// The leg at the neutral pose.
struct NeutralLeg {
  double length;
  double rise;  ///< |n_z|, taken as no less than a fifth

  NeutralLeg(const model::Machine& machine, const model::Leg& leg) {
    const spatial::Vector3 L = machine.neutral() * leg.platform_joint - leg.base_joint;
    length = L.norm();
    rise = std::max(std::abs(L.z()) / length, 0.2);
  }
};

double half_stroke(const model::Leg& leg) { return leg.stroke ? 0.5 * leg.stroke->length : 0.0; }

}  // namespace

EquivalentArea equivalent_area(const model::Machine& machine, const model::Leg& leg) {
  using Rule = EquivalentArea::Rule;
  const auto& cylinder = leg.hydraulics.equivalent_cylinder;
  if (cylinder.area) return {*cylinder.area, Rule::given};
  const NeutralLeg neutral(machine, leg);
  const double load =
      machine.platform.mass * model::standard_gravity / (model::leg_count * neutral.rise);
  const double carrying = load / (load_share * machine.hydraulics.supply.pressure);
  const double e2 = cylinder.area_ratio * cylinder.area_ratio;
  const double roomy = (1.0 + least_dead_share) * half_stroke(leg) * *leg.oil_spring.stiffness /
                       (cylinder.bulk_modulus * (1.0 + e2));
  if (roomy > carrying) return {roomy, Rule::roomy};
  return {carrying, Rule::carrying};
}

namespace {

/// Areas, volumes at mid stroke, oil.
void set_cylinder(const model::Machine& machine, const model::Leg& leg, const NeutralLeg& neutral,
                  ServoAxis& axis) {
  axis.s_mid = leg.stroke ? leg.stroke->retracted + 0.5 * leg.stroke->length
                          : neutral.length - leg.rod.length;
  axis.oil.cavitation_pressure = machine.hydraulics.cavitation_pressure;
  if (leg.oil_spring.cylinder) {
    const auto& cylinder = *leg.oil_spring.cylinder;
    axis.area = areas(cylinder);
    axis.oil.bulk_modulus = cylinder.bulk_modulus;
    axis.cap_line_compliance = cylinder.cap_line_compliance;
    axis.rod_line_compliance = cylinder.rod_line_compliance;
    if (cylinder.air) {
      axis.oil.air_fraction = cylinder.air->fraction;
      axis.oil.air_exponent = cylinder.air->polytropic;
    }
    if (cylinder.volumes == model::VolumeRule::chambers) {
      axis.volume = chamber_volumes(cylinder, *leg.stroke, axis.s_mid);
    } else {
      axis.volume.cap = axis.volume.rod = control_volume(leg);
    }
  } else {
    const auto& cylinder = leg.hydraulics.equivalent_cylinder;
    const double e = cylinder.area_ratio, A_p = equivalent_area(machine, leg).area;
    axis.area = {A_p, e * A_p};
    axis.oil.bulk_modulus = cylinder.bulk_modulus;
    axis.volume.cap = axis.volume.rod =
        cylinder.bulk_modulus * (1.0 + e * e) * A_p * A_p / *leg.oil_spring.stiffness;
  }
  axis.smallest_volume = smallest_volume_share * std::min(axis.volume.cap, axis.volume.rod);
}

/// Oil spring at mid stroke.
double stiffness(const ServoAxis& axis) {
  return axis.oil.bulk_modulus * (axis.area.piston * axis.area.piston / axis.volume.cap +
                                  axis.area.annulus * axis.area.annulus / axis.volume.rod);
}

/// `spring`: the leg's axial stiffness [N/m].
Stops stops_between(double low, double high, const model::EndStops& given, double spring) {
  return {.low = low,
          .high = high,
          .stiffness = given.stiffness.value_or(stop_stiffness_ratio * spring),
          .damping = given.damping};
}

void set_stops(const model::Leg& leg, ServoAxis& axis) {
  const auto& given = leg.hydraulics.end_stops;
  if (leg.stroke) {
    const auto& [retracted, length] = *leg.stroke;
    axis.stops = stops_between(retracted, retracted + length, given, stiffness(axis));
    return;
  }
  const double L_g = leg.guide_sleeve.position, s = axis.s_mid;
  const double in = std::min({axis.volume.cap / axis.area.piston, s, s - (L_g - leg.rod.length)});
  const double out = std::min(axis.volume.rod / axis.area.annulus, L_g - s);
  axis.stops = stops_between(s - usable_share * in, s + usable_share * out, given, stiffness(axis));
}

double rated_flow(const model::Leg& leg, const ServoAxis& axis) {
  return leg.hydraulics.valve.rated_flow.value_or(no_load_speed * axis.area.piston);
}

/// K and ε: o(1) is one opening at the rated flow, o(0) what the null leakage needs.
void set_valve(const model::Leg& leg, const model::Supply& supply, ServoAxis& axis) {
  const auto& given = leg.hydraulics.valve;
  auto& valve = axis.valve;
  valve.overlap = given.overlap;
  valve.laminar_pressure = given.laminar_pressure;
  valve.natural_frequency = given.natural_frequency;
  valve.damping_ratio = given.damping_ratio;
  valve.rate_limit = given.rate_limit;
  const double flow = rated_flow(leg, axis);
  const double leakage = given.leakage.value_or(valve_leakage_share * flow);
  const double at_rated = orifice(0.5 * given.rated_pressure_drop, given.laminar_pressure);
  const double at_null =
      orifice(0.5 * (supply.pressure - supply.return_pressure), given.laminar_pressure);
  constexpr int iterations = 60;  // o(1) hardly depends on ε
  for (int k = 0; k < iterations; ++k) {
    valve.gain = flow / (opening(valve, 1.0) * at_rated);
    const double at_middle = 0.5 * leakage / (valve.gain * at_null);
    valve.rounding = 2.0 * std::sqrt(std::max(at_middle * (at_middle + valve.overlap), 0.0));
  }
}

void set_friction(const model::Leg& leg, ServoAxis& axis) {
  const auto& given = leg.hydraulics.friction;
  auto& friction = axis.friction;
  friction.coulomb = given.coulomb.value_or(0.0);
  friction.breakaway = given.breakaway.value_or(breakaway_ratio * friction.coulomb);
  friction.viscous = given.viscous.value_or(viscous_per_coulomb * friction.coulomb);
  friction.stribeck_velocity = given.stribeck_velocity;
  friction.smoothing_velocity = given.smoothing_velocity;
  if (!given.bristles) return;
  friction.bristle_stiffness = given.bristles->stiffness;
  friction.bristle_damping = given.bristles->damping;
}

/// The largest argument in [low, high] at which a falling function is still positive, to some
/// epsilons: false position (Illinois), with a halving wherever three steps do not make the bracket
/// eight times narrower, or where the function is zero over a stretch.
template <class Function>
double falling_zero(double low, double high, Function function) {
  constexpr int most_steps = 300;
  constexpr double finest = 2.0 * std::numeric_limits<double>::epsilon();
  double at_low = function(low), at_high = function(high);
  if (!(at_low > 0.0)) return low;
  if (at_high > 0.0) return high;
  double wanted = high - low;  // width of the bracket after three steps
  for (int k = 0, side = 0; k < most_steps; ++k) {
    const double least = finest * std::max(std::abs(low), std::abs(high));
    if (!(high - low > 2.0 * least)) break;
    bool halve = at_high == 0.0;
    if (k % 3 == 2) {
      halve = halve || high - low > wanted;
      wanted = 0.125 * (high - low);
    }
    const double secant = low + (high - low) * at_low / (at_low - at_high);
    const double x = halve ? 0.5 * (low + high) : std::clamp(secant, low + least, high - least);
    const double f = function(x);
    if (f > 0.0) {
      low = x;
      at_low = f;
      if (side == 1) at_high *= 0.5;
      side = 1;
    } else {
      high = x;
      at_high = f;
      if (side == -1) at_low *= 0.5;
      side = -1;
    }
  }
  return 0.5 * (low + high);
}

}  // namespace

void require_actuators(const model::Machine& machine) {
  if (model::leg_type(machine) == model::LegType::strut)
    base::refuse("legs.strut",
                 "has no valves, oil and supply, and this needs hydraulics; expected what is of "
                 "mechanics alone (in simulations --actuators springs), or hydraulic cylinders "
                 "(legs.oil_spring)");
}

void require_hydraulics(const model::Machine& machine) {
  require_actuators(machine);
  if (model::leg_type(machine) == model::LegType::screw)
    base::refuse(
        "legs.screw",
        "has no valves, oil and supply, and this needs hydraulics; expected what contains "
        "electric drives (simulate, serve, rig, modes, bode, export), or hydraulic cylinders "
        "(legs.oil_spring)");
}

Stops mechanical_stops(const model::Leg& leg) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  if (!leg.stroke) return {.low = -infinite, .high = infinite};
  const auto& [retracted, length] = *leg.stroke;
  const double spring = axial_spring(leg, retracted + 0.5 * length).stiffness;
  return stops_between(retracted, retracted + length, leg.hydraulics.end_stops, spring);
}

ServoAxis servo_axis(const model::Machine& machine, int i) {
  require_hydraulics(machine);
  const auto& leg = machine.legs[i];
  const auto& supply = machine.hydraulics.supply;
  ServoAxis axis;
  set_cylinder(machine, leg, NeutralLeg(machine, leg), axis);
  set_stops(leg, axis);
  set_valve(leg, supply, axis);
  const auto& leakage = leg.hydraulics.leakage;
  axis.internal_leakage =
      leakage.internal.value_or(piston_leakage_share * rated_flow(leg, axis) / supply.pressure);
  axis.external_leakage = leakage.external;
  set_friction(leg, axis);
  return axis;
}

ServoAxisOf<numerics::Lanes> side_by_side(const std::array<ServoAxis, model::leg_count>& axes) {
  const auto of = [&axes](auto value) {
    return numerics::gather([&](int i) { return value(axes[static_cast<std::size_t>(i)]); });
  };
  ServoAxisOf<numerics::Lanes> all;
  all.area = {of([](const auto& a) { return a.area.piston; }),
              of([](const auto& a) { return a.area.annulus; })};
  all.volume = {of([](const auto& a) { return a.volume.cap; }),
                of([](const auto& a) { return a.volume.rod; })};
  all.s_mid = of([](const auto& a) { return a.s_mid; });
  all.smallest_volume = of([](const auto& a) { return a.smallest_volume; });
  all.cap_line_compliance = of([](const auto& a) { return a.cap_line_compliance; });
  all.rod_line_compliance = of([](const auto& a) { return a.rod_line_compliance; });
  all.oil = {of([](const auto& a) { return a.oil.bulk_modulus; }),
             of([](const auto& a) { return a.oil.air_fraction; }),
             of([](const auto& a) { return a.oil.air_exponent; }),
             of([](const auto& a) { return a.oil.cavitation_pressure; })};
  all.valve = {of([](const auto& a) { return a.valve.gain; }),
               of([](const auto& a) { return a.valve.overlap; }),
               of([](const auto& a) { return a.valve.rounding; }),
               of([](const auto& a) { return a.valve.laminar_pressure; }),
               of([](const auto& a) { return a.valve.natural_frequency; }),
               of([](const auto& a) { return a.valve.damping_ratio; }),
               of([](const auto& a) { return a.valve.rate_limit; })};
  all.internal_leakage = of([](const auto& a) { return a.internal_leakage; });
  all.external_leakage = of([](const auto& a) { return a.external_leakage; });
  all.friction = {of([](const auto& a) { return a.friction.coulomb; }),
                  of([](const auto& a) { return a.friction.breakaway; }),
                  of([](const auto& a) { return a.friction.stribeck_velocity; }),
                  of([](const auto& a) { return a.friction.smoothing_velocity; }),
                  of([](const auto& a) { return a.friction.viscous; }),
                  of([](const auto& a) { return a.friction.bristle_stiffness; }),
                  of([](const auto& a) { return a.friction.bristle_damping; })};
  all.stops = {of([](const auto& a) { return a.stops.low; }),
               of([](const auto& a) { return a.stops.high; }),
               of([](const auto& a) { return a.stops.stiffness; }),
               of([](const auto& a) { return a.stops.damping; })};
  return all;
}

namespace {

/// Pressure at the valve's end of a line, whose steady flow(p) leaves the valve and meets the
/// chamber's `p`.
template <class Flow>
double at_valve(double p, double loss, const model::Supply& supply, Flow flow) {
  if (loss == 0.0) return p;
  return falling_zero(std::min(p, supply.return_pressure), std::max(p, supply.pressure),
                      [&](double at) { return p + loss * flow(at) - at; });
}

}  // namespace

HydraulicRest hydraulic_rest(const ServoAxis& axis, const model::Supply& supply, double force,
                             const LinesOf<double>& line_loss) {
  const double A_p = axis.area.piston, A_r = axis.area.annulus;
  const double pushed = force + atmospheric_pressure * (A_p - A_r);
  const bool tight = axis.internal_leakage == 0.0 && axis.external_leakage == 0.0;
  const bool sealed = tight && axis.valve.overlap >= 0.0 && axis.valve.rounding == 0.0;
  Valve valve = axis.valve;
  if (sealed) {
    valve.overlap = 0.0;
    valve.rounding = 1e-3;
  }
  const auto cap_pressure = [&](double p_rod) { return (pushed + p_rod * A_r) / A_p; };
  const auto flows = [&](double x, double p_cap, double p_rod) {
    return valve_flows(valve, x, {supply.pressure, supply.return_pressure, p_cap, p_rod});
  };
  const auto cap_port = [&](double x, double p_rod) {
    return at_valve(cap_pressure(p_rod), line_loss.cap, supply,
                    [&](double at) { return flows(x, at, p_rod).cap; });
  };
  const auto rod_port = [&](double x, double p_rod) {
    return at_valve(p_rod, line_loss.rod, supply,
                    [&](double at) { return flows(x, p_rod, at).rod; });
  };
  const auto past_piston = [&](double p_rod) {
    return axis.internal_leakage * (cap_pressure(p_rod) - p_rod);
  };
  const auto outside = [&](double p) { return axis.external_leakage * (p - atmospheric_pressure); };
  // For each p_rod the spool that keeps the cap side; what then stays in the rod side falls with
  // p_rod.
  const auto spool_at = [&](double p_rod) {
    return falling_zero(-1.0, 1.0, [&](double x) {
      return past_piston(p_rod) + outside(cap_pressure(p_rod)) -
             flows(x, cap_port(x, p_rod), p_rod).cap;
    });
  };
  const auto into_rod_side = [&](double p_rod) {
    const double x = spool_at(p_rod);
    return flows(x, p_rod, rod_port(x, p_rod)).rod + past_piston(p_rod) - outside(p_rod);
  };
  const double low =
      std::max(supply.return_pressure, (supply.return_pressure * A_p - pushed) / A_r);
  const double high = std::min(supply.pressure, (supply.pressure * A_p - pushed) / A_r);
  HydraulicRest rest;
  if (!(low < high)) return rest;
  rest.p_rod = falling_zero(low, high, into_rod_side);
  rest.p_cap = cap_pressure(rest.p_rod);
  rest.spool = sealed ? 0.0 : spool_at(rest.p_rod);
  rest.valve_pressure = {rest.p_cap, rest.p_rod};  // no flow where it is sealed
  if (!sealed)
    rest.valve_pressure = {cap_port(rest.spool, rest.p_rod), rod_port(rest.spool, rest.p_rod)};
  rest.found = std::abs(rest.spool) < 1.0 - 1e-9 && rest.p_rod > low && rest.p_rod < high;
  return rest;
}

}  // namespace hydrapod::hydraulics
