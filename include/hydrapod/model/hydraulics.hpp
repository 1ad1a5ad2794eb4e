#pragma once
/// The servo-hydraulics of a hexapod as plain data: valves, supply, leakage, friction, end stops.
///
/// Only simulation needs it, and a machine file may leave all of it out. What has a default here
/// has it for every machine; what is optional follows from the machine by the rules of
/// hydraulics/servo_axis.hpp, and `hydrapod check` prints what was assumed.
///
/// Pressures are absolute. SI units.

#include <optional>

namespace hydrapod::model {

/// Four-edge servo valve with the spool as a lag of second order. Spool positions are fractions of
/// the travel: +1 opens supply to the cap side (the leg extends), −1 to the rod side.
struct ServoValve {
  std::optional<double> rated_flow{};  ///< [m³/s] at full opening and the rated pressure drop
  double rated_pressure_drop{7e6};     ///< [Pa] over both edges together, half of it over each
  double overlap{};                    ///< of the travel; negative: underlap
  double laminar_pressure{1e5};        ///< p_t [Pa]: below it an edge flows laminar
  double natural_frequency{600.0};     ///< ω_v [rad/s]
  double damping_ratio{0.8};           ///< ζ_v
  double rate_limit{100.0};            ///< [1/s] of the travel
  /// Null leakage [m³/s] from supply to return with ports blocked; default: 1 % of the rated flow.
  std::optional<double> leakage{};
};

/// Laminar leakage of a cylinder, flow per pressure.
struct CylinderLeakage {
  std::optional<double> internal{};  ///< [m³/(s Pa)] past the piston
  double external{};                 ///< [m³/(s Pa)] from each chamber to the outside
};

/// Bristles that stick before they slide (LuGre).
struct LuGreBristles {
  double stiffness{};  ///< σ0 [N/m]
  double damping{};    ///< σ1 [N s/m]
};

/// Friction of a cylinder's seals along its axis: Coulomb, Stribeck and viscous.
struct SealFriction {
  std::optional<double> coulomb{};    ///< F_c [N]
  std::optional<double> breakaway{};  ///< F_s [N], at rest; default: 1.5 F_c
  double stribeck_velocity{0.02};     ///< v_s [m/s]
  double smoothing_velocity{0.002};   ///< v_0 [m/s] of tanh(v / v_0); not used with bristles
  std::optional<double> viscous{};    ///< b [N s/m]
  std::optional<LuGreBristles> bristles{};
};

/// Friction in a leg's joints against turning of the leg's axis, at the base joint and at the
/// platform joint.
struct JointFriction {
  double viscous{};             ///< [N m s/rad]
  double coulomb{};             ///< [N m]
  double smoothing_rate{0.01};  ///< [rad/s]
};

/// What stops the piston at both ends of its stroke.
struct EndStops {
  std::optional<double> stiffness{};  ///< [N/m]; default: 20 times the oil spring
  double damping{0.5};                ///< [s/m]: the force is k δ (1 + damping δ̇)
};

/// Gas-charged accumulator at the supply.
struct Accumulator {
  double gas_volume{};     ///< [m³] of gas at the precharge
  double precharge{};      ///< [Pa]
  double polytropic{1.4};  ///< exponent n of p Vⁿ
};

struct Supply {
  double pressure{14e6};        ///< p_s [Pa]
  double return_pressure{5e5};  ///< p_r [Pa]
  /// Largest flow of the pump [m³/s]; not set: the supply holds its pressure whatever is drawn.
  std::optional<double> pump_flow{};
  std::optional<Accumulator> accumulator{};
  double line_volume{1e-3};  ///< [m³] of oil between pump and valves, with a pump flow only
};

/// The cylinder that stands in for a leg which gives only its oil spring's stiffness.
struct EquivalentCylinder {
  double area_ratio{0.5};        ///< e
  std::optional<double> area{};  ///< A_p [m²]
  double bulk_modulus{1e9};      ///< β_e [Pa]
};

/// What one leg has.
struct LegHydraulics {
  ServoValve valve{};
  CylinderLeakage leakage{};
  SealFriction friction{};
  JointFriction joint_friction{};
  EndStops end_stops{};
  EquivalentCylinder equivalent_cylinder{};
};

/// What the legs share.
struct Hydraulics {
  Supply supply{};
  double cavitation_pressure{5e4};  ///< [Pa] about which a chamber fills with vapour
};

}  // namespace hydrapod::model
