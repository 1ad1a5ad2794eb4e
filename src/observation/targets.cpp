#include "hydrapod/observation/targets.hpp"

#include <array>

namespace hydrapod::observation {

const char* name(Observed observed) {
  constexpr std::array words{"mechanics", "plant", "system"};
  return words[static_cast<std::size_t>(observed)];
}

const char* name(Entry entry) {
  constexpr std::array words{"valves", "forces", "commands"};
  return words[static_cast<std::size_t>(entry)];
}

const char* name(MotionAgainst against) {
  return against == MotionAgainst::base ? "base" : "ground";
}

}  // namespace hydrapod::observation
