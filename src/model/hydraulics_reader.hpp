#pragma once
/// The tables that only simulation needs. Private to the reader.

#include "section.hpp"

namespace hydrapod::model {

/// `leg`: the tables of one leg, its own over those of all legs.
LegHydraulics read_leg_hydraulics(const Section& leg);
Hydraulics read_hydraulics(const Section& root);

}  // namespace hydrapod::model
