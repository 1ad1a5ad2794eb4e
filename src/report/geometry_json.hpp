#pragma once
/// The mechanism at a pose as JSON: all that is needed to draw it, at rest and moving in a mode.

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/report/json.hpp"

namespace hydrapod::report {

/// `platform` (`origin_m`, `rotation`, `mass_center_m`) and per leg the joints, l, l_m, l_mh, L_g,
/// l_mn, r_b, c_g, the case's frame (t, a2, n), the tilt and offset under gravity, bore and rod
/// diameter where the machine gives them, and the points of dynamics::DrawnLeg: of the leg as it is
/// (`bent`; not in the rigid model) and of the straight one in its place (`straight`). Lengths [m]
/// in base axes, angles [rad].
Json geometry_json(const model::Machine& machine, const dynamics::LinearModel& model);

}  // namespace hydrapod::report
