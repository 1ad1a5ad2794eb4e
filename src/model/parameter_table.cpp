// The table of all keys: the rows of its parts, one after the other.
#include "parameter_rows.hpp"

namespace hydrapod::model {

namespace {

std::vector<ParameterRow> all_rows() {
  std::vector<ParameterRow> all;
  for (const auto part :
       {rows::bodies(), rows::payload_modes(), rows::legs(), rows::leg_hydraulics(),
        rows::single_legs_and_damping(), rows::supply_and_control(), rows::poses()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

constexpr Alternatives pairs[]{{"oil_spring", "stiffness", "cylinder"},
                               {"joints", "circle", "points"},
                               {"controller", "gain", "bandwidth"}};

}  // namespace

std::span<const ParameterRow> parameter_table() {
  static const std::vector<ParameterRow> all = all_rows();
  return all;
}

std::span<const Alternatives> alternatives() { return pairs; }

}  // namespace hydrapod::model
