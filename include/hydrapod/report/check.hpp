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

/// What a user should know of a pose.
struct PoseWarning {
  enum class Kind {
    buckled,        ///< value: mass that must come off [kg]
    near_buckling,  ///< value: payload that the legs carry [kg]; ratio: of all mass to today's
    no_equilibrium,
    little_stroke,  ///< value: stroke left [m]
    short_guide,    ///< value: length of the piston inside the guide sleeve [m]
    tilted_rod,     ///< value: static tilt [rad]
    near_singular   ///< value: condition
  };
  Kind kind{};
  double value{};  ///< of the worst leg
  double ratio{};
  std::vector<int> legs{};  ///< 0…5
};

struct PoseCheck {
  model::NamedPose pose{};
  kinematics::PoseQuality quality{};
  std::array<LegCheck, model::leg_count> legs{};
  bool equilibrium{};      ///< static forces and tilts are valid
  bool buckling_sought{};  ///< not without gravity, nor for legs that cannot fold
  dynamics::Buckling buckling{};
  std::optional<double>
      lowest_at_buckling{};  ///< ω of the lowest mode just below that payload [rad/s]
  std::vector<PoseWarning> warnings{};
};

/// `hydrapod check`: legs, strokes, static forces and buckling at poses.
Json check_json(const std::vector<PoseCheck>& poses, const model::Machine& machine);
std::vector<PoseCheck> checks_from_json(const Json& json, const std::string& file);

std::string warning_text(const PoseWarning& warning);

/// "45.92 kg", "74940 kg": four digits, but never a power of ten.
std::string mass_text(double mass);

}  // namespace hydrapod::report
