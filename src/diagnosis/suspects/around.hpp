#pragma once
/// Free parameters around what the file says. Private to the suspects.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hydrapod/diagnosis/diagnose.hpp"
#include "hydrapod/kinematics/legs.hpp"

namespace hydrapod::diagnosis {

/// A number that keeps its sign, within `factor` of `value`.
inline calibration::FreeParameter within(const std::string& path, double value, double factor) {
  const double a = value / factor, b = value * factor;
  return {.paths = {path}, .start = value, .lower = a < b ? a : b, .upper = a < b ? b : a};
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

inline std::string leg_path(int leg, const char* rest) {
  return fmt::format("leg.{}.{}", leg + 1, rest);
}

}  // namespace hydrapod::diagnosis
