#include "record_queue.hpp"

#include <signal.h>

#include <algorithm>
#include <chrono>
#include <limits>

namespace hydrapod::realtime {

RecordQueue::RecordQueue(data::RecordWriter& writer, std::size_t columns, bool waits)
    : writer_(writer),
      columns_(columns),
      waits_(waits),
      rows_(capacity * columns),
      nothing_(columns, std::numeric_limits<double>::quiet_NaN()) {
  sigset_t all, before;  // signals are for the thread that serves
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::jthread([this] { work(); });
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

RecordQueue::~RecordQueue() { ends_.store(true, std::memory_order_release); }

bool RecordQueue::append(const double* row) {
  const std::size_t in = in_.load(std::memory_order_relaxed);
  while (in - out_.load(std::memory_order_acquire) == capacity) {
    if (!waits_ || failed()) return false;
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  std::copy_n(row, columns_, rows_.data() + (in % capacity) * columns_);
  in_.store(in + 1, std::memory_order_release);
  return true;
}

void RecordQueue::put(const double* row) {
  while (owed_ > 0 && append(nothing_.data())) --owed_;
  if (owed_ == 0 && append(row)) return;
  ++owed_;
  ++lost_;
}

void RecordQueue::work() {
  try {
    for (;;) {
      const bool last = ends_.load(std::memory_order_acquire);
      std::size_t out = out_.load(std::memory_order_relaxed);
      const std::size_t in = in_.load(std::memory_order_acquire);
      while (out != in) {
        const std::size_t first = out % capacity;
        const std::size_t count = std::min({in - out, capacity - first, std::size_t{512}});
        writer_.append(Eigen::Map<const data::Samples>(rows_.data() + first * columns_,
                                                       static_cast<Eigen::Index>(count),
                                                       static_cast<Eigen::Index>(columns_)));
        out += count;
        out_.store(out, std::memory_order_release);
      }
      if (last) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  } catch (...) {
    error_ = std::current_exception();
    failed_.store(true, std::memory_order_release);
  }
}

void RecordQueue::finish() {
  ends_.store(true, std::memory_order_release);
  if (thread_.joinable()) thread_.join();
  if (error_) std::rethrow_exception(error_);
}

}  // namespace hydrapod::realtime
