#pragma once
/// What the reader finds wrong, until it is told to whoever asked. Private to the reader.

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "value_tree.hpp"

namespace hydrapod::model {

class Faults {
 public:
  /// `sources` names the file and the overrides, as Place::source counts them.
  explicit Faults(std::vector<std::string> sources) : sources_(std::move(sources)) {}

  /// Records a mistake; the same one (six legs share a table) is recorded once.
  void add(const Place& place, std::string key, std::string message,
           base::Severity severity = base::Severity::error);

  /// Says that a value could not be read and the machine therefore holds a NaN.
  void mark_incomplete() { incomplete_ = true; }
  [[nodiscard]] bool incomplete() const { return incomplete_; }

  /// Says that `path` is absent because it was misspelt, which has been reported.
  void mark_misspelt(std::string path) { misspelt_.insert(std::move(path)); }
  [[nodiscard]] bool misspelt(const std::string& path) const { return misspelt_.contains(path); }

  [[nodiscard]] bool any_error() const { return errors_ > 0; }

  /// Everything of that severity in the order of the file, then of the overrides.
  [[nodiscard]] std::vector<base::Diagnostic> diagnostics(base::Severity severity) const;

 private:
  struct Fault {
    Place place{};
    base::Diagnostic diagnostic{};
  };

  std::vector<std::string> sources_;
  std::vector<Fault> faults_;
  std::set<std::string> misspelt_;
  std::size_t errors_{};
  std::size_t not_kept_{};
  bool incomplete_{};
};

}  // namespace hydrapod::model
