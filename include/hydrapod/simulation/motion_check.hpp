#pragma once
/// Can the machine do what it is commanded? Judged before a run, by kinematics alone.

#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/control/parameters.hpp"
#include "hydrapod/signals/signals.hpp"
#include "hydrapod/simulation/plant.hpp"

namespace hydrapod::simulation {

struct MotionFinding {
  base::Severity severity{base::Severity::error};
  std::string message{};
};

/// The worst of each kind per leg, with its time and by how much: stroke and joint limits exceeded,
/// a singular pose (errors); a speed beyond what the valve gives under the load at rest (a warning:
/// the drive will be at its limit). `signal` is run through from its start and restarted.
std::vector<MotionFinding> check_motion(const Plant& plant,
                                        const control::ControllerParameters& parameters,
                                        const Pose& operating, signals::Generator& signal,
                                        double until);

/// Why a pose that the platform has come to ends a run: a joint beyond its limit, a singular pose.
/// Empty when it does not.
std::string leaves_workspace(const model::Machine& machine, const Pose& X_BP);

}  // namespace hydrapod::simulation
