#pragma once
/// Free parameters around what the file says. Private to the suspects.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hydrapod/diagnosis/suspect.hpp"
#include "hydrapod/kinematics/inverse.hpp"

namespace hydrapod::diagnosis {

/// A number that keeps its sign, within `factor` of `value`.
inline calibration::FreeParameter within(const std::string& path, double value, double factor) {
  const double a = value / factor, b = value * factor;
  return {.paths = {path},
          .start = fmt::format("{:.17g}", value),
          .lower = fmt::format("{:.17g}", a < b ? a : b),
          .upper = fmt::format("{:.17g}", a < b ? b : a)};
}

/// A number within `reach` of `value`.
inline calibration::FreeParameter near(const std::string& path, double value, double reach) {
  return {.paths = {path},
          .start = fmt::format("{:.17g}", value),
          .lower = fmt::format("{:.17g}", value - reach),
          .upper = fmt::format("{:.17g}", value + reach)};
}

inline std::string leg_path(int leg, const char* rest) {
  return fmt::format("leg.{}.{}", leg + 1, rest);
}

}  // namespace hydrapod::diagnosis
