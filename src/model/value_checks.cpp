#include "value_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "parameter_access.hpp"

namespace hydrapod::model {

namespace {

/// "-3 kg", or "-3" for pure numbers.
std::string with_unit(double value, std::string_view unit) {
  return unit == "1" ? fmt::format("{:.6g}", value) : fmt::format("{:.6g} {}", value, unit);
}

/// "more than 0", "no more than 2", "1e-05 s to 1 s": what a number that is too small, or too large
/// where it is `above` the lowest, should be.
std::string expected(const Bound& bound, std::string_view unit, bool above) {
  const bool both = std::isfinite(bound.lowest) && std::isfinite(bound.highest);
  if (!bound.expected.empty() && (above || bound.lowest != 0.0)) return std::string{bound.expected};
  if (both && bound.lowest != 0.0)
    return fmt::format("{} to {}", with_unit(bound.lowest, unit), with_unit(bound.highest, unit));
  if (above)
    return fmt::format("{} {:g}", bound.less_than_highest ? "less than" : "no more than",
                       bound.highest / bound.shown_size);
  return bound.more_than_lowest ? "more than 0" : "0 or more";
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

bool ValueChecks::within(std::string_view key, double value, std::string_view unit,
                         const Bound& bound) {
  if (!finite(key, value, unit)) return false;
  // a limit that was given in another unit, as "10 us", may differ by rounding
  constexpr double rounding = 1e-14;
  const double least = bound.lowest - rounding * std::abs(bound.lowest),
               most = bound.highest + rounding * std::abs(bound.highest);
  const bool above =
      bound.more_than_lowest ? value - bound.lowest >= 1.0 / largest_number : value >= least;
  const bool below = bound.less_than_highest ? value < bound.highest : value <= most;
  if (above && below) return true;
  const bool in_other = above && !bound.shown_in.empty();
  const std::string found =
      in_other ? with_unit(value / bound.shown_size, bound.shown_in) : with_unit(value, unit);
  add(key, fmt::format("is {}, expected {}", found, expected(bound, unit, above)));
  return false;
}

void ValueChecks::rows(const Machine& machine, std::optional<int> leg) {
  auto& from = const_cast<Machine&>(machine);
  const auto table = parameter_table();
  for (std::size_t r = 0; r < table.size(); ++r) {
    const auto& row = table[r];
    const bool of_leg = row.path.starts_with(of_legs);
    if (row.in_code || row.find == nullptr || of_leg != leg.has_value()) continue;
    if (leg && !rows_of(leg_type(machine.legs[static_cast<std::size_t>(*leg)]))[r]) continue;
    const auto key = of_leg ? row.path.substr(of_legs.size()) : row.path;
    const auto unit = unit_of(machine, row);
    for (int k = 0; k < row.numbers; ++k) {
      const double* number = row.find(from, leg.value_or(0), k);
      if (number != nullptr && !within(key, *number, unit, row.bound)) break;
    }
  }
}

bool ValueChecks::sound(std::string_view key) const {
  return std::none_of(findings_.begin(), findings_.end(),
                      [&](const Finding& finding) { return finding.key == key; });
}

}  // namespace hydrapod::model
