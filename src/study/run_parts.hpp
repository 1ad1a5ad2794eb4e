#pragma once
/// What runs of one program and of a team share.

#include <functional>
#include <memory>
#include <mutex>
#include <utility>

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

/// Lets a problem's model ask whether to stop, as long as it lives.
class Interruptible {
 public:
  Interruptible(const Problem& problem, std::function<bool()> asked)
      : interruption_(problem.interruption), asked_(std::move(asked)) {
    if (interruption_) interruption_->set(&asked_);
  }
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;
  ~Interruptible() {
    if (interruption_) interruption_->set(nullptr);
  }
  [[nodiscard]] const std::function<bool()>& asked() const { return asked_; }

 private:
  std::shared_ptr<Interruption> interruption_;
  std::function<bool()> asked_;
};

}  // namespace hydrapod::study
