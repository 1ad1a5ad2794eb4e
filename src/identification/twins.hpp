#pragma once
/// Modes that stand so close together, and are so alike, that one resonance may have become them:
/// by a window that nobody told, or because it moved during the record. A tuned absorber makes such
/// modes too. Private to the module.

#include <limits>

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

/// Groups of modes, of one member or more, by ascending frequency: neighbours have the same shapes
/// and participations, and are apart by less than 3 times the sum of their half widths and by less
/// than `closest` [rad/s].
std::vector<std::vector<std::size_t>> twin_groups(
    const std::vector<IdentifiedMode>& modes,
    double closest = std::numeric_limits<double>::infinity());

/// Of responses at even lines: twins that a window may have made, whose main lobe is 5 lines wide
/// to either side, or less.
bool has_twins(const Identification& found);

/// One mode for each group: the one that explains most, in the middle of the group and as wide.
Identification with_twins_merged(const Identification& found,
                                 const std::vector<std::vector<std::size_t>>& groups);

/// Of responses without errors that leave more than what a window adds: names twins that a window
/// may have made, and lowers the quality of all modes.
void warn_of_twins(const IdentifyOptions& options, Identification& result);

}  // namespace hydrapod::identification
