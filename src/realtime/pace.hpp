#pragma once
/// The wall clock of the server and what it says of it. Private to the module.

#include <chrono>
#include <ctime>

#include "hydrapod/realtime/realtime.hpp"

namespace hydrapod::realtime {

/// Seconds of a clock since its own beginning.
double seconds_of(clockid_t clock);

/// Counts times in bins of 3 % from 10 ns to 1000 s, without allocation.
class Histogram {
 public:
  void add(double seconds);
  [[nodiscard]] Timing timing() const;

 private:
  static constexpr double least = 1e-8, per_octave = 24.0;
  static constexpr int bins = 880;
  [[nodiscard]] static double upper(int bin);
  std::array<long, bins> counts_{};
  long all_{};
  double worst_{};
};

/// Samples at begin + k T of the monotonic clock.
class Pace {
 public:
  /// `busy`: ServeOptions::busy.
  explicit Pace(double sample_time, double busy = 0.0) : T_(sample_time), busy_(busy) {}

  /// Sleeps until the next sample, but for `busy` before it. Where the machine stood still for long
  /// (suspended, stopped), the samples go on from now.
  void wait_for_next();
  /// The work of a sample, which is measured. An end without a beginning is none.
  void work_begins();
  void work_ends();

  /// Of the last sample [s].
  [[nodiscard]] double lateness() const { return lateness_; }
  [[nodiscard]] std::uint64_t misses() const { return misses_; }
  void tell(ServeResult& result) const;

 private:
  static constexpr double longest_standstill = 0.1;  // [s]

  double T_, busy_;
  double begin_{-1.0};
  long next_{};
  double lateness_{}, step_begin_{}, processor_begin_{};
  bool working_{};
  std::uint64_t misses_{}, overruns_{}, shifts_{};
  Histogram late_{}, step_{}, processor_{};
};

/// Asks for SCHED_FIFO and for memory that stays; returns what there is now, and why not where not.
std::string schedule(std::optional<int> fifo);

}  // namespace hydrapod::realtime
