#pragma once
/// Roles of channels that their file does not tell.

#include <vector>

#include "hydrapod/data/record.hpp"
#include "notes.hpp"

namespace hydrapod::data {

/// Sets the roles that names and units tell: a force, a hammer or a demand is an excitation, a
/// valve a drive, a motion, a pressure or a strain a response. Where there is an excitation or a
/// drive, channels that tell nothing are `other`; else they stay what they are. Units are SI by
/// now. One note says what was taken for what.
void guess_roles(std::vector<Channel>& channels, Notes& notes);

/// Of the inputs of responses by other programs, whose files do not tell a commanded motion from a
/// measured one: what is a motion by its unit is a response, unless its name says that it was
/// commanded.
void tell_measured_inputs(std::vector<Channel>& inputs);

}  // namespace hydrapod::data
