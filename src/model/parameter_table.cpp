// The table of all keys: the rows of its parts, one after the other; which type of leg has which.
#include <algorithm>
#include <array>

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

std::string_view name(LegType type) {
  constexpr std::array<std::string_view, 3> names{"hydraulic cylinder", "plain strut",
                                                  "electric cylinder"};
  return names.at(static_cast<std::size_t>(type));
}

std::string_view axial_part(LegType type) {
  constexpr std::array<std::string_view, 3> parts{"oil", "struts", "screws"};
  return parts.at(static_cast<std::size_t>(type));
}

bool belongs_to(LegType type, std::string_view path) {
  constexpr std::array<std::string_view, 7> of_oil{
      "oil_spring",          "valve",          "leakage", "friction", "end_stops",
      "equivalent_cylinder", "stick_stiffness"};
  constexpr std::array<std::string_view, 7> of_cylinders{
      "case", "rod", "guide_sleeve", "piston_ring", "stroke", "bending", "added_axial_inertia"};
  if (!path.starts_with(of_legs)) return true;
  auto key = path.substr(of_legs.size());
  key = key.substr(0, key.find('.'));
  if (key == "strut") return type == LegType::strut;
  if (key == "screw") return type == LegType::screw;
  if (std::ranges::find(of_oil, key) != of_oil.end()) return type == LegType::cylinder;
  return type != LegType::strut || std::ranges::find(of_cylinders, key) == of_cylinders.end();
}

const std::vector<bool>& rows_of(LegType type) {
  const auto found = [](LegType of) {
    std::vector<bool> rows;
    for (const auto& row : parameter_table()) rows.push_back(belongs_to(of, row.path));
    return rows;
  };
  static const std::array all{found(LegType::cylinder), found(LegType::strut),
                              found(LegType::screw)};
  return all[static_cast<std::size_t>(type)];
}

}  // namespace hydrapod::model
