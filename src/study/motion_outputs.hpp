#pragma once
/// What samples do when they are commanded to move, see Motion. Private to the module.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hydrapod/simulation/closed_loop.hpp"
#include "hydrapod/study/study.hpp"

namespace hydrapod::study {

class MotionOutputs {
 public:
  /// None: no motion, no columns.
  MotionOutputs(const std::optional<Motion>& motion, dynamics::ModelKind kind,
                std::shared_ptr<const Interruption> interruption);
  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  /// NaN where the run does not come to its end.
  void operator()(const model::Machine& machine, const spatial::Pose& X_BP,
                  std::span<double> outputs) const;

 private:
  std::optional<Motion> motion_;
  dynamics::ModelKind kind_;
  std::shared_ptr<const Interruption> interruption_;
  std::vector<Column> columns_{};
  simulation::Settling settling_{};
};

}  // namespace hydrapod::study
