#pragma once
/// Outputs that cost more than modes do, see extra_outputs(). Private to the module.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/study/study.hpp"

namespace hydrapod::study {

/// Why a machine does not have the extra output of that name; none: it has it, or there is none.
std::optional<std::string> why_no_extra(const model::Machine& machine, dynamics::ModelKind kind,
                                        std::string_view name);

/// Those extra outputs of a machine that are asked for, in the order of extra_outputs().
class ExtraOutputs {
 public:
  ExtraOutputs(const model::Machine& machine, dynamics::ModelKind kind,
               const std::vector<std::string>& wanted);
  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  /// NaN where there is no value.
  void operator()(const model::Machine& machine, const spatial::Pose& X_BP,
                  std::span<double> outputs) const;
  /// Takes away what a machine without modes does not have.
  void only_buckling(std::span<double> outputs) const;

 private:
  dynamics::ModelKind kind_{};
  std::vector<Column> columns_{};
  std::vector<int> kinds_{};  ///< what each column is
  bool linear_{}, capability_{};
};

}  // namespace hydrapod::study
