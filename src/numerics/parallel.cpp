#include "hydrapod/numerics/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace hydrapod::numerics {

Progress part_of(const Progress& progress, double from, double to) {
  if (!progress) return {};
  return [progress, from, to](double share) { return progress(from + (to - from) * share); };
}

bool Watch::at(double share) {
  const std::lock_guard lock(mutex_);
  largest_ = std::max(largest_, share);
  if (!stopped_ && progress_) stopped_ = progress_(largest_);
  return stopped_;
}

int processor_count() {
  return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

bool parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& task,
                  const Progress& progress) {
  const auto wanted = static_cast<unsigned>(threads > 0 ? threads : processor_count());
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stopped{false};
  std::mutex mutex;
  std::size_t done = 0;
  std::exception_ptr failure;
  const auto tell = [&](std::size_t finished) {
    const std::lock_guard lock(mutex);
    done += finished;
    if (progress && progress(static_cast<double>(done) / static_cast<double>(count)))
      stopped = true;
  };
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        tell(0);
        if (stopped) return;
        task(i);
        tell(1);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        stopped = true;
      }
    }
  };
  {
    std::vector<std::jthread> others;
    for (unsigned k = 1; k < std::min<std::size_t>(wanted, count); ++k) others.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
  return !stopped;
}

}  // namespace hydrapod::numerics
