#pragma once
/// Modes of the plant as a measurement sees them, and which of them is which target. Private to the
/// module.
///
/// Poles closer to each other than half of `seen_as_one` of |λ|, or a fifth of the smaller decay
/// rate, are one group: a shape is compared with what the group shows together, as with mechanics
/// (pairing.hpp).

#include <span>

#include "hydrapod/observation/observation.hpp"

namespace hydrapod::observation {

/// What is observed at one pose. Both lists are per target of the problem; targets at other poses
/// have −1 and none.
struct SeenPoint {
  Observation seen{};
  std::vector<int> mode_of{};
  std::vector<std::vector<int>> group_of{};
};

/// Groups of modes that are seen as one.
std::vector<std::vector<int>> groups_of(const std::vector<ObservedMode>& modes);

/// Motion of the target's point per motion of the mass centre.
spatial::Matrix6 to_target_point(const dynamics::LinearModel& model, const ModeTarget& target);

/// The target's shape: complex if it was measured so.
Vector6c shape_of(const ModeTarget& target);

/// A Wᴴ u: what the modes show of the shape u; A is the sum of their residues for the six valves,
/// all in the metric `root`, u of length one. Where the target's shape is real, A's columns are
/// turned to real.
Vector6c shown_part(const Observation& seen, const std::vector<int>& modes,
                    const ModeTarget& target, const spatial::Matrix6& root, const Vector6c& u);

/// MAC of the target's shape with its group of modes, in the metric of the platform's mass.
double shown_mac(const Observation& seen, const std::vector<int>& modes, const ModeTarget& target);

/// Pairs the targets `here` (numbers in `targets`) with modes that are damped less than
/// `overdamped`. False where there are fewer of those.
inline constexpr double overdamped = 0.5;
bool pair_seen(std::span<const ModeTarget> targets, const std::vector<std::size_t>& here,
               SeenPoint& point);

/// The same for a machine a little beside that of `center`: groups are those of the centre, so that
/// differences are those of one and the same mode. False where modes were lost.
bool follow_seen(std::span<const ModeTarget> targets, const std::vector<std::size_t>& here,
                 const SeenPoint& center, SeenPoint& point);

/// The mode of mechanics whose shape is most like it.
int nearest_mode(const Observation& seen, const ObservedMode& mode);

}  // namespace hydrapod::observation
