#pragma once
/// How stiff the guide sleeves must be. The sleeves of all legs are scaled by one factor. Where
/// today's do not meet the goal, the smallest factor is wanted from which on everything stiffer
/// meets it at every pose; where they do, how much softer they might be. It is found downwards from
/// nearly rigid (or today's) sleeves in steps of a tenth of a decade to the first that is too soft,
/// then by bisection, to 1e-6 of itself. First resonances: diagnose.hpp.

#include <optional>
#include <string>
#include <vector>

#include "hydrapod/dynamics/statics.hpp"
#include "hydrapod/model/machine.hpp"
#include "hydrapod/numerics/parallel.hpp"

namespace hydrapod::diagnosis {

/// What is wanted: a frequency, or a largest drop below the rigid-leg model; one of the two.
struct RemedyGoal {
  std::optional<double> omega{};   ///< [rad/s] the first resonance must reach
  std::optional<double> drop{};    ///< 0.02: at most 2 % below rigid
  std::optional<int> direction{};  ///< 0…5; none: every direction
};

struct RemedyPoint {
  double factor{};     ///< on today's stiffness
  double stiffness{};  ///< of the stiffest leg's sleeve [N/m]
  double omega{};      ///< lowest first resonance over poses and directions asked for [rad/s]
  double drop{};       ///< largest drop
  double mac{};        ///< FirstResonance::mac of the resonance with that drop
  std::optional<double> softest{};  ///< as `stiffness`, of the softest leg where legs differ [N/m]
};

/// Stiffness of the guide sleeves [N/m] of the stiffest leg, and where legs differ of the softest.
struct SleeveRange {
  double stiffest{};
  std::optional<double> softest{};
};
SleeveRange sleeves_of(const model::Machine& machine);

enum class RemedyStatus {
  found,
  met_already,  ///< today's stiffness, or less, is enough
  out_of_reach  ///< rigid sleeves would not be enough: `limit` is what they give
};

/// A first resonance before and after.
struct Change {
  std::string pose{}, direction{};                      ///< no direction: every one
  double omega_rigid{}, omega_today{}, omega_needed{};  ///< [rad/s]; 0 where the legs fold
  double mac_today{}, mac_needed{};                     ///< FirstResonance::mac
};

struct Remedy {
  RemedyStatus status{};
  RemedyPoint today{}, needed{}, limit{};
  std::string pose{};       ///< that asks for the most
  std::string direction{};  ///< and its direction; empty: every one
  /// Where rods or cases bend: rigid sleeves and legs that do not bend. Beyond `limit` no sleeve
  /// gets; up to this the rods are what stands in the way.
  std::optional<RemedyPoint> limit_without_bending{};
  std::vector<RemedyPoint> curve{};  ///< from a tenth of today's stiffness to what is nearly rigid
  std::vector<Change> changes{};     ///< everywhere, with the stiffness that is needed
};

/// `poses`: at least one. Throws std::invalid_argument for a goal that says neither or both.
/// `progress`: share of the work done; true asks to stop, and base::ComputationError says so.
Remedy find_remedy(const model::Machine& machine, const std::vector<model::NamedPose>& poses,
                   dynamics::ModelKind kind, const RemedyGoal& goal,
                   const numerics::Progress& progress = {});

/// Poses spread over what stroke and joints allow around the neutral one: its own, and where each
/// of 26 directions of translation and of rotation ends at a limit (halfway there too).
std::vector<model::NamedPose> workspace_poses(const model::Machine& machine);

}  // namespace hydrapod::diagnosis
