#pragma once
/// Everything a simulation needs to know of one leg's hydraulics, with every default resolved.
///
/// What a machine file leaves out follows from the machine; the rules, in this order:
/// - Cylinder. With `oil_spring.cylinder`: its areas, and its chambers (`volumes = "chambers"`) or
///   two chambers that hold `control_volume` at mid stroke ("equal"). With `oil_spring.stiffness`
///   k_h alone, an equivalent cylinder: area ratio e; a piston area A_p on which a sixth of the
///   supply pressure carries the leg's share F = m g_0 l / (6 h) of platform and payload (h the
///   leg's rise at the neutral pose; also without gravity); both chambers hold
///   V_0 = β_e (1 + e²) A_p² / k_h at mid stroke, so that Eq. 16 gives k_h there exactly. Without a
///   stroke, mid stroke is where the piston stands at the neutral pose.
/// - Stroke. Without a `stroke` the piston may go 90 % of the way to where a chamber would be
///   empty, it would leave the guide sleeve or the sleeve the rod, or it would reach the base
///   joint.
/// - Valve: moves the piston at 0.5 m/s at the rated flow; null leakage 1 % of that.
/// - Leakage past the piston: 1 % of the rated flow at the supply pressure.
/// - Seals: F_c is 1 % of A_p p_s, F_s = 1.5 F_c, b = 10 F_c per m/s.
/// - End stops: 20 times as stiff as the oil spring at mid stroke.

#include <array>
#include <string>
#include <vector>

#include "hydrapod/hydraulics/chamber.hpp"
#include "hydrapod/hydraulics/friction.hpp"
#include "hydrapod/hydraulics/supply.hpp"
#include "hydrapod/hydraulics/valve.hpp"
#include "hydrapod/model/machine.hpp"

namespace hydrapod::hydraulics {

/// Stops at both ends: against a piston δ beyond an end, N = k δ (1 + d δ̇), never pulling.
struct Stops {
  double low{}, high{};  ///< [m] piston positions s where they touch
  double stiffness{};    ///< k [N/m]
  double damping{};      ///< d [s/m]
};

/// Force of the stops on the piston along s [N].
inline double stop_force(const Stops& stops, double s, double rate) {
  if (s < stops.low)
    return std::max(0.0, stops.stiffness * (stops.low - s) * (1.0 - stops.damping * rate));
  if (s > stops.high)
    return -std::max(0.0, stops.stiffness * (s - stops.high) * (1.0 + stops.damping * rate));
  return 0.0;
}

struct ServoAxis {
  CylinderAreas area{};      ///< A_p, e A_p [m²]
  ChamberVolumes volume{};   ///< V_1, V_2 [m³] with the piston at s_mid
  double s_mid{};            ///< [m] from the base joint
  double smallest_volume{};  ///< [m³] chambers are never taken for smaller
  Oil oil{};
  Valve valve{};
  double internal_leakage{};  ///< [m³/(s Pa)]
  double external_leakage{};  ///< [m³/(s Pa)]
  Friction friction{};
  Stops stops{};

  /// V_1 and V_2 [m³] with the piston at `s` [m].
  [[nodiscard]] ChamberVolumes volumes(double s) const {
    return {std::max(volume.cap + area.piston * (s - s_mid), smallest_volume),
            std::max(volume.rod - area.annulus * (s - s_mid), smallest_volume)};
  }
  /// Force of the oil on the piston [N] along s (it pushes the leg out), the air's on the rod taken
  /// off.
  [[nodiscard]] double force(double p_cap, double p_rod) const {
    return p_cap * area.piston - p_rod * area.annulus -
           atmospheric_pressure * (area.piston - area.annulus);
  }
};

/// Leg `i` (from 0). The machine must be sound (model::validate).
ServoAxis servo_axis(const model::Machine& machine, int i);

/// What was assumed, for people: one entry for all legs where they agree.
struct Assumption {
  std::string key{};   ///< the key that would say it, for instance "legs.valve.rated_flow"
  std::string text{};  ///< "29.1 l/min: 0.5 m/s at the rated flow"
};
std::vector<Assumption> hydraulic_assumptions(const model::Machine& machine);

/// Pressures and spool position at which a piston at rest carries a load.
struct HydraulicRest {
  double p_cap{}, p_rod{};  ///< [Pa]
  double spool{};           ///< x
  bool found{};             ///< false: the supply cannot carry the load
};
/// `force` [N] is what the oil must push with along s. Where closed edges and tight seals leave the
/// pressures open, their sum is taken as that of a leaking valve.
HydraulicRest hydraulic_rest(const ServoAxis& axis, const model::Supply& supply, double force);

}  // namespace hydrapod::hydraulics
