#pragma once
/// Where in a machine file a finding of validation belongs. Private to the reader.

#include <string>

#include "hydrapod/model/section.hpp"

namespace hydrapod::model {

struct FindingPlace {
  Place place{};
  std::string path{};  ///< of the value or table found; empty for the top level
};

/// The value that `key` of a Finding names, or the nearest thing above it that is in the file.
/// `leg.3.rod.length` may stand in `legs.rod.length`, and what all legs share (`legs.rod.length`)
/// in the legs' own tables; a leg's joint may stand in `base.joints` or `platform.joints`.
FindingPlace find_place(const Node& root, const std::string& key);

}  // namespace hydrapod::model
