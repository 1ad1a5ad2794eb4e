#pragma once
/// What the page shows of one pose. Private to the module, and to the page's core (web/core).

#include "hydrapod/report/json.hpp"

namespace hydrapod::report {

/// `poses[]` of report_json(): answer, modes, geometry, Bode diagram of `points` points, none
/// for 0. `table`: that of `machine` at `pose`.
Json pose_report(const model::Machine& machine, const model::NamedPose& pose,
                 const modal::ModeTable& table, int points);

/// What a comparison of frequencies needs of it, while a value is dragged: neither shapes nor
/// geometry.
Json brief_pose_report(const model::NamedPose& pose, const modal::ModeTable& table);

}  // namespace hydrapod::report
