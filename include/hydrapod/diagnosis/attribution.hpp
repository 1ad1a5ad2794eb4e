#pragma once
/// How much of each drop below the rigid calculation belongs to which compliance.
///
/// Each part is made rigid alone (seals a million times stiffer; gimbals and mount that do not give
/// way) and the modes are computed again, gravity and preload included. Shares need not sum to one:
/// two compliances in one leg do more together than either alone, and one leg alone stiffened
/// breaks the symmetry.

#include <optional>

#include "hydrapod/diagnosis/resonances.hpp"

namespace hydrapod::diagnosis {

enum class Compliance { guide_sleeve, piston_ring, gimbals, base_mount };

struct Part {
  Compliance what{};
  std::optional<int> leg{};  ///< 0…5; none: that of all legs, or the base's
};

/// "guide sleeves of all legs", "guide sleeve of leg 3".
std::string part_name(const Part& part);

struct PartShare {
  Part part{};
  double omega{};  ///< first resonance with this part rigid [rad/s]
  double share{};  ///< of the drop that is gone then
};

struct AttributedDrop {
  FirstResonance resonance{};
  std::vector<PartShare> parts{};  ///< all legs first, then single legs
};

/// One per rigid mode. `machine` in its model `kind`; parts it does not have are left out.
std::vector<AttributedDrop> attribute_drops(const model::Machine& machine,
                                            const spatial::Pose& X_BP, dynamics::ModelKind kind);

}  // namespace hydrapod::diagnosis
