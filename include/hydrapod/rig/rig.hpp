#pragma once
/// The test rig: the machine under its controller is excited in six directions and measured.
///
/// The machine is brought to rest at a pose, the excitation begins, and after `settling` the record
/// does. One thread, fixed order, own random numbers: the same options give the same record bit for
/// bit.
///
/// What a test rig measures with, and how that falsifies.
///
/// The chain of every measured channel: quantity → sensor's bandwidth (accelerometers) → noise →
/// anti-alias filter → range and resolution → drop-outs. Filters run at the simulation's output
/// rate, the record's rate times `oversampling`; the record takes every n-th of their samples.
/// Excitations are known and recorded as they are.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hydrapod/data/record.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/model/machine.hpp"
#include "hydrapod/signals/signals.hpp"
#include "hydrapod/simulation/closed_loop.hpp"

namespace hydrapod::rig {

using model::Vector3;

/// One axis of an accelerometer on the platform. It shows e·(a − g) less its value at rest, e and
/// the place turning with the platform: a piezoelectric one, which feels gravity when it tilts.
struct Accelerometer {
  std::string name{};
  Vector3 p_P{Vector3::Zero()};   ///< place in P [m]
  Vector3 e_P{Vector3::UnitX()};  ///< direction in P, unit
  data::Direction direction{data::Direction::x};
  int point{};                               ///< number of the place
  double noise_density{1e-3};                ///< [m/s²/√Hz], white
  double bandwidth{5000.0};                  ///< [Hz] of a second-order low pass, ζ = 0.7; 0: none
  model::Sensor sensor{.resolution = 1e-3};  ///< its `noise` is added to that of the density
};

struct Instruments {
  model::Sensor length{.resolution = 5e-6, .noise = 2e-6};   ///< leg lengths [m]
  model::Sensor pressure{.resolution = 2e3, .noise = 5e3};   ///< chambers [Pa]
  model::Sensor current{.resolution = 1e-4, .noise = 1e-4};  ///< valves, share of the rated current
  model::Sensor torque{.resolution = 0.01, .noise = 0.02};   ///< motors of electric drives [N m]
  model::Sensor speed{.resolution = 1e-3, .noise = 5e-3};    ///< the same [rad/s]
  std::vector<Accelerometer> accelerometers{};
  bool anti_alias{true};       ///< Butterworth of order 8, −3 dB at 0.4 of the record's rate
  double drop_outs{};          ///< per second and channel
  double drop_out_time{0.02};  ///< [s] of each
};

/// Three axes at the platform joints of legs 1, 3 and 5: enough for six directions.
std::vector<Accelerometer> default_accelerometers(const model::Machine& machine);

/// e·(a − g) of a sensor without faults, less its value at rest at `operating` [m/s²].
double specific_force(const Accelerometer& one, const model::Machine& machine,
                      const spatial::Pose& operating, const simulation::PlantOutput& plant);

/// "resolution=5 um, noise=2 um, low=0.8 m, high=1.2 m" in `unit`. Throws base::InputError with
/// `argument` as place.
model::Sensor parse_sensor(const std::string& argument, const std::string& text, const char* unit);

/// "front, at=0.3 0 0.1, along=z, noise=0.001, bandwidth=5 kHz, range=50, resolution=0.001".
Accelerometer parse_accelerometer(const std::string& text);

/// Low-pass sections of order two, by the bilinear transform with the corner kept in place.
class LowPass {
 public:
  /// Butterworth of even `order`, −3 dB at `corner` [Hz] < rate/2.
  static LowPass butterworth(int order, double corner, double rate);
  /// Order 2 with damping ratio `zeta`; passes everything where the corner is not below rate/2.
  static LowPass second_order(double corner, double zeta, double rate);

  double operator()(double value);
  /// As if `value` had been there for ever.
  void settle(double value);

 private:
  struct Section {
    double b{}, a1{}, a2{};  ///< y = b (x + 2x₁ + x₂) − a1 y₁ − a2 y₂
    double s1{}, s2{};
  };
  void add(double corner, double zeta, double rate);
  std::vector<Section> sections_{};
};

using spatial::Vector6;

/// Where the excitation goes in. It has the units of signals::displacement_units, drive_units or
/// wrench_units.
enum class Entry {
  command,  ///< displacement of the demanded pose, levels in m and rad
  drive,    ///< added to the drives of valves or motors: levels as shares of full drive of the leg
            ///< that a direction moves most
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

/// ∂l/∂(x … rz) about the origin of P: leg lengths per displacement of the demanded pose.
spatial::Matrix6 excitation_jacobian(const model::Machine& machine, const spatial::Pose& pose);

/// Columns of J over their largest entries: drives per direction.
spatial::Matrix6 drive_shares(const spatial::Matrix6& J);

/// Channels in the order of the record: 6 excitations, 6 valve currents, 6 leg lengths, 12 chamber
/// pressures, accelerometers. Electric cylinders have commands of the motors' speeds in place of
/// valve currents, and torque and speed of each motor in place of both pressures.
std::vector<data::Channel> rig_channels(const RigOptions& options,
                                        model::LegType legs = model::LegType::cylinder);

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
