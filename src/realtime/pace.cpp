#include "pace.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

namespace hydrapod::realtime {

double seconds_of(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void Histogram::add(double seconds) {
  const double place = per_octave * std::log2(std::max(seconds, least) / least);
  ++counts_[static_cast<std::size_t>(std::clamp(static_cast<int>(std::ceil(place)), 0, bins - 1))];
  ++all_;
  worst_ = std::max(worst_, seconds);
}

double Histogram::upper(int bin) { return least * std::exp2(bin / per_octave); }

Timing Histogram::timing() const {
  Timing timing{.samples = all_, .worst = worst_};
  const std::array quantiles{std::pair{0.5, &timing.p50}, std::pair{0.99, &timing.p99},
                             std::pair{0.999, &timing.p99_9}, std::pair{0.9999, &timing.p99_99}};
  std::size_t next = 0;
  long below = 0;
  for (int bin = 0; bin < bins; ++bin) {
    const long here = counts_[static_cast<std::size_t>(bin)];
    if (here == 0) continue;
    below += here;
    timing.bins.push_back({upper(bin), here});
    while (next < quantiles.size() &&
           static_cast<double>(below) >= quantiles[next].first * static_cast<double>(all_))
      *quantiles[next++].second = std::min(upper(bin), worst_);
  }
  return timing;
}

void Pace::wait_for_next() {
  double now = seconds_of(CLOCK_MONOTONIC);
  if (begin_ < 0.0) begin_ = now;
  double due = begin_ + T_ * static_cast<double>(next_);
  if (next_ > 0 && now > due) ++overruns_;
  while (now < due) {
    if (const double until = due - busy_; now < until) {
      timespec at{};
      at.tv_sec = static_cast<time_t>(until);
      at.tv_nsec = static_cast<long>((until - std::floor(until)) * 1e9);
      ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr);
    }
    now = seconds_of(CLOCK_MONOTONIC);
  }
  lateness_ = now - due;
  late_.add(lateness_);
  if (lateness_ > T_) ++misses_;
  if (lateness_ > longest_standstill) {
    begin_ += lateness_;
    ++shifts_;
  }
  ++next_;
}

void Pace::work_begins() {
  step_begin_ = seconds_of(CLOCK_MONOTONIC);
  processor_begin_ = seconds_of(CLOCK_THREAD_CPUTIME_ID);
  working_ = true;
}

void Pace::work_ends() {
  if (!working_) return;
  working_ = false;
  step_.add(seconds_of(CLOCK_MONOTONIC) - step_begin_);
  processor_.add(seconds_of(CLOCK_THREAD_CPUTIME_ID) - processor_begin_);
}

void Pace::tell(ServeResult& result) const {
  result.misses = misses_;
  result.overruns = overruns_;
  result.shifts = shifts_;
  result.lateness = late_.timing();
  result.step = step_.timing();
  result.step_processor = processor_.timing();
}

std::string schedule(std::optional<int> fifo) {
  ::prctl(PR_SET_TIMERSLACK, 1UL);  // [ns]; the default are 50 µs
  if (!fifo) return "SCHED_OTHER";
  sched_param parameters{};
  parameters.sched_priority = *fifo;
  if (::sched_setscheduler(0, SCHED_FIFO, &parameters) != 0)
    return fmt::format("SCHED_OTHER: SCHED_FIFO is not permitted ({})", std::strerror(errno));
  if (::mlockall(MCL_CURRENT | MCL_FUTURE) != 0)
    return fmt::format("SCHED_FIFO {}, memory not locked ({})", *fifo, std::strerror(errno));
  return fmt::format("SCHED_FIFO {}, memory locked", *fifo);
}

}  // namespace hydrapod::realtime
