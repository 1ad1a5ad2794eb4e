#pragma once
/// Modes that stand so close together, and are so alike, that one resonance may have become them:
/// by a window that nobody told, or because it moved during the record. A tuned absorber makes such
/// modes too. Private to the module.

#include <limits>

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

struct TwinOptions {
  double alike{0.98};  ///< MAC of shapes, and of participations, > alike
  double near{3.0};    ///< |Δω| < near · the sum of both half widths, or
  /// |Δω| < apart · ω: a resonance that jumps stands for a while at either place, however far apart
  /// these are. Machines change that much as they warm up.
  double apart{0.0};
  /// |Δω| < closest [rad/s] besides.
  double closest{std::numeric_limits<double>::infinity()};
};

/// Groups of modes, of one member or more, by ascending frequency: neighbours are twins.
std::vector<std::vector<std::size_t>> twin_groups(const std::vector<IdentifiedMode>& modes,
                                                  const TwinOptions& options = {});

/// Twins are one resonance that moved where
///
///     E|v|²/E|y − v|² > incoherent    in the half-power band of one of them,
///
/// y being the output for which this is least and v the part that no input explains. A machine that
/// had both modes at all times follows its inputs at both frequencies. One that had the first and
/// then the second does not: half of the time makes 1, a drift through both 0.3 to 2. Leakage makes
/// 1.3/b² of it in a resonance that is b lines wide. Where sensors are so noisy, or blocks so
/// short, that it is more than that, nobody can tell.
struct MovedOptions {
  TwinOptions twins{.apart = 0.1};
  double incoherent{0.25};
  double quality{0.3};  ///< at most
};

/// Of responses at even lines: twins that a window may have made, whose main lobe is 5 lines wide
/// to either side, or less.
bool has_twins(const Identification& found);

/// One mode for each group: the one that explains most, in the middle of the group and as wide.
Identification with_twins_merged(const Identification& found,
                                 const std::vector<std::vector<std::size_t>>& groups);

/// Of responses without errors that leave more than what a window adds: names twins that a window
/// may have made, and lowers the quality of all modes. Of averages of a record: names those that
/// are one resonance that moved, and lowers the quality of these.
void warn_of_twins(const IdentifyOptions& options, Identification& result,
                   const MovedOptions& moved = {});

}  // namespace hydrapod::identification
