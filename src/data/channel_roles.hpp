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

}  // namespace hydrapod::data
