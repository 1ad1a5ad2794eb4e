#pragma once
/// Rows of a record on their way to the disk, which no sample waits for. Private to the module.

#include <atomic>
#include <exception>
#include <thread>
#include <vector>

#include "hydrapod/data/record_io.hpp"

namespace hydrapod::realtime {

/// One thread puts rows in, another writes them. Where the disk is too slow for a second, rows are
/// lost and stand as NaN in the record.
class RecordQueue {
 public:
  /// `waits`: a full queue waits for the disk instead, for a clock that can.
  RecordQueue(data::RecordWriter& writer, std::size_t columns, bool waits);
  ~RecordQueue();
  RecordQueue(const RecordQueue&) = delete;
  RecordQueue& operator=(const RecordQueue&) = delete;

  void put(const double* row);
  /// Everything is with the writer now; throws what it threw.
  void finish();
  /// The writer threw, for instance as the disk is full.
  [[nodiscard]] bool failed() const { return failed_.load(std::memory_order_acquire); }
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  static constexpr std::size_t capacity = 8192;  // rows

  void work();
  bool append(const double* row);

  data::RecordWriter& writer_;
  std::size_t columns_;
  bool waits_;
  std::vector<double> rows_;
  std::vector<double> nothing_;  ///< a lost row
  std::atomic<std::size_t> in_{}, out_{};
  std::atomic<bool> ends_{}, failed_{};
  std::uint64_t lost_{}, owed_{};
  std::exception_ptr error_{};
  std::jthread thread_{};
};

}  // namespace hydrapod::realtime
