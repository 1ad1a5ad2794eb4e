#pragma once
/// straight_leg() where the element is to stand: with 2 kB it is too large to be copied in inner
/// loops. Private to the module.

#include "hydrapod/dynamics/leg.hpp"

namespace hydrapod::dynamics {

/// `element`: a new one.
void set_straight_leg(const model::Leg& leg, const kinematics::LegGeometry& geometry,
                      model::FlexibleAxes axes, LegElement& element);

}  // namespace hydrapod::dynamics
