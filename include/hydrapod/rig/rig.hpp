#pragma once
/// The test rig: the machine under its controller is excited in six directions and measured.
///
/// The machine is brought to rest at a pose, the excitation begins, and after `settling` the record
/// does. One thread, fixed order, own random numbers: the same options give the same record bit for
/// bit.

#include <functional>
#include <string>
#include <vector>

#include "hydrapod/data/record_io.hpp"
#include "hydrapod/rig/instruments.hpp"
#include "hydrapod/signals/signal_text.hpp"
#include "hydrapod/simulation/closed_loop.hpp"

namespace hydrapod::rig {

using spatial::Vector6;

/// Where the excitation goes in. It has the units of signals::displacement_units, drive_units or
/// wrench_units.
enum class Entry {
  command,  ///< displacement of the demanded pose, levels in m and rad
  drive,    ///< added to the valves' drives: levels as shares of full drive of the leg that a
            ///< direction moves most
  wrench    ///< force and moment about the mass centre, levels in N and N m
};

struct RigOptions {
  std::vector<signals::Signal> signals{};  ///< empty: default_signals()
  Entry entry{Entry::command};
  double settling{2.0};   ///< [s]
  double duration{60.0};  ///< [s] of the record
  double rate{1000.0};    ///< [Hz] of the record
  int oversampling{2};    ///< simulation outputs per sample of the record
  int repeat{1};
  std::uint64_t seed{1};
  Instruments instruments{};
  simulation::LoopOptions loop{};  ///< `until`, `output_interval` and `seed` are set by the rig
};

/// White noise in all six directions: 0.1 mm and 0.1 mrad RMS (Entry::command), 2 % of full drive
/// (drive), 100 N and 50 N m (wrench).
std::vector<signals::Signal> default_signals(Entry entry);

const signals::Units& units_of(Entry entry);

/// Channels in the order of the record: 6 excitations, 6 valve currents, 6 leg lengths, 12 chamber
/// pressures, accelerometers.
std::vector<data::Channel> rig_channels(const RigOptions& options);

/// What keeps the machine from following, too little stroke, valves, full drive; or from standing
/// still: a loop that is unstable.
struct LevelFinding {
  base::Severity severity{base::Severity::error};
  std::string message{};  ///< "ry at this level needs 31 mm of stroke in leg 4, 12 mm left"
  bool of_controller{};   ///< of the controller, not of the excitation
};

/// Runs the excitation through kinematics (linear in the displacement, legs at the pose), up to
/// `longest_checked` seconds of it.
std::vector<LevelFinding> check_levels(const simulation::ClosedLoop& loop,
                                       const RigOptions& options);
inline constexpr double longest_checked = 120.0;  ///< [s]

/// Loop options as the rig wants them.
simulation::LoopOptions loop_options(const RigOptions& options);

struct RigResult {
  simulation::RunSummary summary{};
  std::int64_t samples{};  ///< of the record
};

/// Runs `loop`, made with loop_options(), and appends the record's samples to `writer`, in blocks.
/// `keep_going` as in ClosedLoop::run. What was measured before an early end is in the record.
RigResult run_rig(simulation::ClosedLoop& loop, const RigOptions& options,
                  data::RecordWriter& writer, const simulation::KeepGoing& keep_going = {});

}  // namespace hydrapod::rig
