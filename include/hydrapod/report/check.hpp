#pragma once
/// What follows from a machine file without solving for modes: `hydrapod check`.

#include <optional>
#include <string>
#include <vector>

#include "hydrapod/dynamics/buckling.hpp"
#include "hydrapod/kinematics/pose_quality.hpp"
#include "hydrapod/report/json.hpp"

namespace hydrapod::report {

/// One leg at a pose.
struct LegCheck {
  double length{};                       ///< l [m]
  double piston{};                       ///< l_m [m]
  double guided_length{};                ///< l_mh [m]
  std::optional<double> retract_left{};  ///< stroke left inwards [m]; none without a stroke
  std::optional<double> extend_left{};   ///< and outwards [m]
  double oil_stiffness{};                ///< k_h [N/m]
  double axial_force{};  ///< static, of the oil on the piston [N], positive in compression
  double tilt{};         ///< static tilt of the rod in the guide sleeve [rad]
  double base_tilt{}, platform_tilt{};  ///< joint angles from the neutral pose [rad]
};

struct PoseCheck {
  PoseChoice pose{};
  kinematics::PoseQuality quality{};
  std::array<LegCheck, model::leg_count> legs{};
  bool equilibrium{};      ///< static forces and tilts are valid
  bool buckling_sought{};  ///< not without gravity, nor for legs that cannot fold
  dynamics::Buckling buckling{};
  std::optional<double>
      lowest_at_buckling{};  ///< ω of the lowest mode just below that payload [rad/s]
  std::vector<std::string> warnings{};
};

/// Statics are those of the model `kind`.
PoseCheck check(const model::Machine& machine, const PoseChoice& pose, dynamics::ModelKind kind);

Json check_json(const PoseCheck& check);

/// "45.92 kg", "74940 kg": four digits, but never a power of ten.
std::string mass_text(double mass);

}  // namespace hydrapod::report
