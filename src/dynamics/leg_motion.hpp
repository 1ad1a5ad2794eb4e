#pragma once
/// Kinematics of one leg in motion. Private to NonlinearModel.

#include "hydrapod/dynamics/nonlinear.hpp"

namespace hydrapod::dynamics {

/// Fills `at` from joint position and velocity (`at.a`, `at.v_a`) and the flexible coordinates
/// (`at.flexible`, `at.flexible_rate`). `axis`: first axis of the leg's frame in B. `spinning`:
/// gimbal axes, the case turns with its frame.
void move_leg(const model::Leg& leg, const Vector3& axis, bool spinning, bool flexible,
              LegMotion& at);

}  // namespace hydrapod::dynamics
