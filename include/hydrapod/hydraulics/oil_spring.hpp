#pragma once
/// The oil column of a double-acting cylinder as an axial spring.
///
///     k_h = β_e (A_p² / V_1 + (e A_p)² / V_2)                     chambers at the present
///     extension k_h = β_e (1 + e²) A_p² / V_0                               (Eq. 16), equal
///     volumes
///
/// A_p piston area, e = (A_p − A_rod) / A_p the area ratio, V_1 the chamber on the base side, V_2
/// the one around the rod, both with dead and line volumes. Valves are closed: no oil leaves.
///
/// Entrained air, share α of the volume at atmospheric pressure p_0, at chamber pressure p,
/// exponent n:
///
///     β_e = [(1 − α) + α x] / [(1 − α) / β + α x / (n p)],   x = (p_0 / p)^(1/n)
///
/// (springs in series: the oil's own compressibility and that of the air compressed to p).

#include "hydrapod/model/machine.hpp"

namespace hydrapod::hydraulics {

inline constexpr double atmospheric_pressure = 101325.0;  ///< p_0 [Pa]

/// β_e [Pa] with the air that `cylinder` carries.
double effective_bulk_modulus(const model::Cylinder& cylinder);

struct CylinderAreas {
  double piston{};                                                 ///< A_p [m²]
  double annulus{};                                                ///< e A_p [m²]
  [[nodiscard]] double ratio() const { return annulus / piston; }  ///< e
};
CylinderAreas areas(const model::Cylinder& cylinder);

struct ChamberVolumes {
  double cap{};  ///< V_1 [m³]
  double rod{};  ///< V_2 [m³]
};
/// Volumes with the piston at `l_m` [m] from the base joint. The leg must have a stroke.
ChamberVolumes chamber_volumes(const model::Cylinder& cylinder, const model::Stroke& stroke,
                               double l_m);

/// V_0 [m³] of Eq. 16: `control_volume`, or the mean of both chambers at mid stroke.
double control_volume(const model::Leg& leg);

/// k_h [N/m] of `leg` with the piston at `l_m` [m] from the base joint.
/// Throws std::invalid_argument when the leg has no oil spring or lacks the stroke that it needs.
double oil_stiffness(const model::Leg& leg, double l_m);

/// What holds a leg along its axis: the oil spring, and in series the gimbals where they give way.
struct AxialSpring {
  double stiffness{};  ///< k_h k_j / (k_h + k_j) [N/m]
  /// c_h (k_j / (k_h + k_j))² [N s/m]: the share of the motion that the oil's damper sees, as long
  /// as the damper's force is small beside the spring's.
  double damping{};
};
AxialSpring axial_spring(const model::Leg& leg, double l_m);

}  // namespace hydrapod::hydraulics
