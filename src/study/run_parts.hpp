#pragma once
/// What runs of one program and of a team share.

#include <memory>
#include <mutex>

#include "hydrapod/study/study.hpp"
#include "spool.hpp"

namespace hydrapod::study {

/// Evaluators that tasks on several threads take and give back: as many as there are threads.
class Evaluators {
 public:
  explicit Evaluators(const Problem& problem) : problem_(problem) {}
  std::unique_ptr<Evaluator> take() {
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) return std::make_unique<Evaluator>(problem_);
    auto one = std::move(idle_.back());
    idle_.pop_back();
    return one;
  }
  void give(std::unique_ptr<Evaluator> one) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(one));
  }

 private:
  const Problem& problem_;
  std::mutex mutex_{};
  std::vector<std::unique_ptr<Evaluator>> idle_{};
};

}  // namespace hydrapod::study
