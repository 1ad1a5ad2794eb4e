#pragma once
/// Work shared out over threads, with progress and cancellation.

#include <cstddef>
#include <functional>
#include <mutex>
#include <utility>

namespace hydrapod::numerics {

/// Called with the share of the work that is done, 0 to 1; true asks to stop.
using Progress = std::function<bool(double)>;

/// `progress` with its share mapped to `from` … `to`.
Progress part_of(const Progress& progress, double from, double to);

/// Progress that several threads may report and ask. It remembers the largest share and that a stop
/// was asked for.
class Watch {
 public:
  explicit Watch(Progress progress) : progress_(std::move(progress)) {}
  /// Reports `share`; true when the work is to stop.
  bool at(double share);
  /// Asks again, without progress.
  bool stopped() { return at(0.0); }

 private:
  Progress progress_;
  std::mutex mutex_{};
  double largest_{};
  bool stopped_{};
};

/// At least 1.
int processor_count();

/// Calls task(i) once for each i in [0, count), on `threads` threads (0: one per processor, the
/// caller's thread among them). Which thread takes which i is open. `progress` is called before and
/// after each task, by one thread at a time. When it asks to stop no further task begins, and the
/// result is false. An exception of a task ends the work and is thrown again here.
bool parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& task,
                  const Progress& progress = {});

}  // namespace hydrapod::numerics
