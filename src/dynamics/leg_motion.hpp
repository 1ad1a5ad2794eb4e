#pragma once
/// Kinematics of the legs in motion. Private to NonlinearModel.

#include "legs_in_motion.hpp"

namespace hydrapod::dynamics {

/// Fills `at` from the flexible coordinates in it, L = a − b and the joint's velocity in B.
/// `spinning`: gimbal axes, the case turns with its frame. Where a leg cannot be closed its lane of
/// the result is 0, else 1.
Lanes move_legs(const LegConstants& legs, const Vector3L& L, const Vector3L& v_a, bool spinning,
                bool flexible, LegsInMotion& at);

}  // namespace hydrapod::dynamics
