#pragma once
/// Piston area of a leg with k_h alone. Private to the module.

#include "hydrapod/model/machine.hpp"

namespace hydrapod::hydraulics {

struct EquivalentArea {
  enum class Rule {
    given,     ///< in the file
    carrying,  ///< a sixth of the supply pressure carries the leg's share of the platform
    roomy      ///< larger than that: the chambers of the given oil spring are as long as the stroke
  };
  double area{};  ///< A_p [m²]
  Rule rule{};
};

EquivalentArea equivalent_area(const model::Machine& machine, const model::Leg& leg);

}  // namespace hydrapod::hydraulics
