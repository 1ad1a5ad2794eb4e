#pragma once
/// What makers of causes have in common, and those of the seals (seal_causes.cpp). Private to the
/// module.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <string>
#include <vector>

#include "hydrapod/diagnosis/diagnose.hpp"

namespace hydrapod::diagnosis::causes {

using Leg = std::optional<int>;  ///< none: all legs

inline constexpr std::array<Leg, 7> all_and_each{std::nullopt, 0, 1, 2, 3, 4, 5};

/// A number that keeps its sign, within `factor` of `value`.
inline calibration::FreeParameter within(const std::string& path, double value, double factor) {
  const double a = value / factor, b = value * factor;
  return {.paths = {path}, .start = value, .lower = std::min(a, b), .upper = std::max(a, b)};
}

/// A number within `reach` of `value`.
inline calibration::FreeParameter near(const std::string& path, double value, double reach) {
  return {.paths = {path}, .start = value, .lower = value - reach, .upper = value + reach};
}

/// `value` for the number at `path`.
inline model::Assignment change(const model::MachineFile& file, const std::string& path,
                                double value) {
  const auto own = find_parameter(file, path);
  return {own ? *own : find_parameter(file.machine, path).value(), value};
}

inline std::string leg_path(Leg leg, const std::string& rest) {
  return leg ? fmt::format("leg.{}.{}", *leg + 1, rest) : "legs." + rest;
}

/// The first stands for all.
inline const model::Leg& leg_of(const model::MachineFile& file, Leg leg) {
  return file.machine.legs[static_cast<std::size_t>(leg.value_or(0))];
}

/// For all legs the first of those that the number at legs.`rest` sets: others may have their own.
inline int index_with(const model::MachineFile& file, Leg leg, const std::string& rest) {
  if (leg) return *leg;
  const auto id = find_parameter(file, leg_path({}, rest));
  return id ? std::countr_zero(id->legs) : 0;
}

inline const model::Leg& leg_with(const model::MachineFile& file, Leg leg,
                                  const std::string& rest) {
  return leg_of(file, index_with(file, leg, rest));
}

void add_guide_sleeves(const model::MachineFile& file, std::vector<Cause>& all);
void add_piston_rings(const model::MachineFile& file, std::vector<Cause>& all);
void add_guide_clearance(const model::MachineFile& file, std::vector<Cause>& all);
void add_elastomers(const model::MachineFile& file, std::vector<Cause>& all);

}  // namespace hydrapod::diagnosis::causes
