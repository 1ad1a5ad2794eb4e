#include "value_checks.hpp"

#include <fmt/format.h>

#include <cmath>

namespace hydrapod::model {

namespace {

/// "-3 kg", or "-3" for pure numbers.
std::string with_unit(double value, std::string_view unit) {
  return unit == "1" ? fmt::format("{:.6g}", value) : fmt::format("{:.6g} {}", value, unit);
}

}  // namespace

bool ValueChecks::finite(std::string_view key, double value, std::string_view unit) {
  if (!std::isfinite(value)) {
    if (non_finite_ == NonFinite::report) {
      add(key, fmt::format("is {}, expected a finite number", value));
    }
    return false;
  }
  if (std::abs(value) <= largest_number) return true;
  add(key,
      fmt::format("is {}, expected no more than {:g}", with_unit(value, unit), largest_number));
  return false;
}

bool ValueChecks::finite(std::string_view key, const Vector3& value, std::string_view unit) {
  for (int i = 0; i < 3; ++i) {
    if (!finite(key, value[i], unit)) return false;
  }
  return true;
}

bool ValueChecks::positive(std::string_view key, double value, std::string_view unit) {
  if (!finite(key, value, unit)) return false;
  if (value >= 1.0 / largest_number) return true;
  add(key, fmt::format("is {}, expected more than 0", with_unit(value, unit)));
  return false;
}

bool ValueChecks::not_negative(std::string_view key, double value, std::string_view unit) {
  if (!finite(key, value, unit)) return false;
  if (value >= 0.0) return true;
  add(key, fmt::format("is {}, expected 0 or more", with_unit(value, unit)));
  return false;
}

}  // namespace hydrapod::model
