#pragma once
/// What a run leaves behind: time histories in memory for pictures, and rows of a record.

#include <vector>

#include "hydrapod/data/record.hpp"
#include "hydrapod/simulation/closed_loop.hpp"

namespace hydrapod::simulation {

/// Time histories, thinned out for pictures.
struct Trace {
  std::vector<double> time{};      ///< [s]
  std::vector<Vector6> command{};  ///< displacement from the operating pose [m, rad]
  std::vector<Vector6> motion{};   ///< the same of the platform
  std::vector<Vector6> piston{};   ///< s per leg, from the base joint [m]
  std::vector<Vector6> drive{};    ///< at the valves
  std::vector<Vector6> cap_pressure{}, rod_pressure{};  ///< [Pa]
};

/// Collects at most `most` samples of a run, evenly.
class TraceRecorder {
 public:
  TraceRecorder(const ClosedLoop& loop, double until, std::size_t most = 3000);
  void operator()(const LoopSample& sample);
  [[nodiscard]] const Trace& trace() const { return trace_; }

 private:
  Pose operating_;
  long stride_{1};
  long seen_{};
  Trace trace_{};
};

/// The channels of a run's record: command.x … rz, platform.x … rz (displacements from the
/// operating pose), platform.ax … arz (acceleration of the platform's origin), then per leg its
/// length, measured length, drive at the valve, spool, both pressures, oil force, and with flexible
/// legs the offset of the rod in its guide sleeve; the supply pressure where it moves.
std::vector<data::Channel> record_channels(const ClosedLoop& loop);

/// The sample as one row of that record; `row` has record_channels().size() places.
void record_row(const ClosedLoop& loop, const LoopSample& sample, double* row);

}  // namespace hydrapod::simulation
