#pragma once
/// Work on samples in memory that goes on beside the reading of the same samples. Private to the
/// module.

#include <atomic>
#include <future>
#include <utility>

#include "hydrapod/data/record_io.hpp"

namespace hydrapod::identification {

/// A thread with samples of its own (data::RecordSet::of_memory), which ends with its owner.
template <class Result>
class Background {
 public:
  /// Begins work(records, stop); work looks at `stop` now and then, and what it gives after that
  /// became true is not used.
  template <class Work>
  Background(data::RecordSet records, Work work)
      : records_(std::move(records)),
        result_(std::async(std::launch::async, [this, work = std::move(work)] {
          return work(records_, std::as_const(stop_));
        })) {}
  ~Background() { stop_ = true; }  // the future waits for its end
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  /// Waits for it; once.
  Result result() { return result_.get(); }

 private:
  data::RecordSet records_;
  std::atomic<bool> stop_{};
  std::future<Result> result_;  // last: it is waited for before the others end
};

}  // namespace hydrapod::identification
