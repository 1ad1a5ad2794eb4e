#include "hydrapod/diagnosis/diagnose.hpp"

#include <algorithm>

namespace hydrapod::diagnosis {

std::vector<Suspect> suspects_of(const model::MachineFile& file) {
  std::vector<Suspect> all;
  for (const auto make : all_suspects)
    for (auto& suspect : make(file)) all.push_back(std::move(suspect));
  return all;
}

bool can_be_together(const Suspect& a, const Suspect& b) {
  if (!a.in_pairs || !b.in_pairs) return false;
  if (a.family != b.family) return true;
  return a.leg && b.leg && *a.leg != *b.leg;
}

}  // namespace hydrapod::diagnosis
