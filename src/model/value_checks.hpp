#pragma once
/// Checks of single numbers against the bounds of their rows. Private to the module.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hydrapod/model/parameters.hpp"
#include "hydrapod/model/validation.hpp"
#include "validate_values.hpp"

namespace hydrapod::model {

/// Numbers beyond this overflow when they are squared and multiplied; numbers closer to zero than
/// its reciprocal do when they are divided by.
inline constexpr double largest_number = 1e30;

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

  /// Has nothing been found about `key`?
  [[nodiscard]] bool sound(std::string_view key) const;

  void add(std::string_view key, std::string message) {
    findings_.push_back({base::Severity::error, std::string{key}, std::move(message)});
  }
  std::vector<Finding> take() { return std::move(findings_); }

 private:
  NonFinite non_finite_;
  std::vector<Finding> findings_{};
};

}  // namespace hydrapod::model
