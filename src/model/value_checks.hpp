#pragma once
/// Checks of single numbers against the bounds of their rows. Private to the module.

#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hydrapod/model/machine_file.hpp"
#include "hydrapod/model/parameters.hpp"

namespace hydrapod::model {

/// Numbers beyond this overflow when they are squared and multiplied; numbers closer to zero than
/// its reciprocal do when they are divided by.
inline constexpr double largest_number = 1e30;

enum class NonFinite {
  report,
  ignore  ///< NaN stands for a value whose absence has been reported
};

/// Collects findings. A check that meets a number that is not finite reports that and nothing else.
class ValueChecks {
 public:
  explicit ValueChecks(NonFinite non_finite) : non_finite_(non_finite) {}

  /// The numbers of all rows that have no code of their own: of a leg, with keys below `legs.`, or
  /// of the machine itself.
  void rows(const Machine& machine, std::optional<int> leg);

  /// Each returns whether the number is sound.
  bool finite(std::string_view key, double value, std::string_view unit);
  bool finite(std::string_view key, const Vector3& value, std::string_view unit);
  bool within(std::string_view key, double value, std::string_view unit, const Bound& bound);

  /// "is 0.3 m, expected less than the bore, 0.2 m".
  void add_unexpected(std::string_view key, double value, std::string_view unit,
                      std::string_view expected, double limit) {
    add(key,
        fmt::format("is {0:.6g} {1}, expected {2}, {3:.6g} {1}", value, unit, expected, limit));
  }

  /// Has nothing been found about `key`?
  [[nodiscard]] bool sound(std::string_view key) const;

  void add(std::string_view key, std::string message) {
    findings_.push_back({base::Severity::error, std::string{key}, std::move(message)});
  }
  void warn(std::string_view key, std::string message) {
    findings_.push_back({base::Severity::warning, std::string{key}, std::move(message)});
  }
  std::vector<Finding> take() { return std::move(findings_); }

 private:
  NonFinite non_finite_;
  std::vector<Finding> findings_{};
};

/// validate() with a choice for machines of which parts could not be read.
std::vector<Finding> validate_values(const Machine& machine, NonFinite non_finite);

/// What the table cannot say: conditions between numbers. Keys of a leg are relative to it.
void check_sensors(const Sensors& sensors, ValueChecks& checks);
void check_leg_hydraulics(const Leg& leg, ValueChecks& checks);
void check_supply(const Hydraulics& hydraulics, ValueChecks& checks);
void check_lines(const Machine& machine, ValueChecks& checks);
void check_payload_modes(const Machine& machine, ValueChecks& checks);

/// The findings about one leg (0…5), with keys relative to it (`rod.length`).
std::vector<Finding> leg_findings(const Machine& machine, int leg, NonFinite non_finite);

}  // namespace hydrapod::model
