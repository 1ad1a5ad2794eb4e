#pragma once
/// The machine under its controller: plant, sensors, sampled control law, delay, drives of the
/// valves or of the motors of electric cylinders.
///
/// At every sample t_k = k T the sensors are read and the controller computes drives, which reach
/// the valves at t_k + delay · T (any fraction of samples) and stay until the next ones do. Between
/// these instants and those of the output the plant is integrated with constant input. One thread,
/// fixed order, own random numbers: the same options give the same samples bit for bit.
///
///     ClosedLoop loop(machine, pose, {.until = 5.0});
///     signals::Generator commands({{.size = …, .form = signals::Step{}}}, 1.0 / T);
///     loop.run(command_source(commands), [&](const LoopSample& sample) { … });
///
/// Sensors with their faults: noise, range, resolution.
///
/// Time integration of a Plant with inputs that are held between calls.
///
///     Integrator run(plant, {.method = Method::exponential});
///     run.start(0.0, plant.equilibrium(pose).x);
///     for (int k = 1; k <= 1000; ++k) run.advance(1e-3 * k, input);
///
/// Local errors are kept below  relative_tolerance |x_i| + absolute_tolerance · scale_i  with
/// Plant::scales(). Methods (docs/theory/integration.md):
/// - exponential: the spools by the exponential of their matrix, everything else by Dormand and
///   Prince 5(4); the default. Spools are the fastest states of most machines and nothing acts on
///   them, so that steps are two to five times as long. Errors are kept in every state. No
///   allocation. Events are noticed within IntegratorOptions::event_time.
/// - adaptive: Dormand and Prince 5(4) for all states (ARKODE's ERKStep). Starts again at no cost
///   after every change of the input. This one and those of CVODE keep errors in the weighted root
///   mean square. Events are noticed at the end of a step.
/// - cvode_adams, cvode_bdf: CVODE's multistep methods; for long stretches of constant input, BDF
///   with a dense Jacobian by differences where something is stiff. They find events to rounding
///   and start again there.
/// - fixed: classical Runge–Kutta of order 4 with a fixed step, no allocation, the same work in
/// every
///   call, the spools as in `exponential`: for real time.
///
/// What a run leaves behind: time histories in memory for pictures, and rows of a record.
///
/// Can the machine do what it is commanded? Judged before a run, by kinematics alone.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/control/controller.hpp"
#include "hydrapod/data/record.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "hydrapod/signals/signals.hpp"
#include "hydrapod/simulation/plant.hpp"

namespace hydrapod::simulation {

/// What one sensor shows of `value`; `noise` is a normally distributed number.
double shown(const model::Sensor& sensor, double value, double noise);

/// The sensors that a controller reads. The same seed gives the same noise.
class SensorBank {
 public:
  SensorBank(const model::Sensors& sensors, std::uint64_t seed);
  [[nodiscard]] control::Measurement read(const control::Measurement& truth);

 private:
  model::Sensors sensors_;
  numerics::Gaussian random_;
};

enum class Method { adaptive, cvode_adams, cvode_bdf, fixed, exponential };
const char* name(Method method);

struct IntegratorOptions {
  Method method{Method::exponential};
  double relative_tolerance{1e-5};
  double absolute_tolerance{1e-5};  ///< of Plant::scales()
  double fixed_step{1e-4};          ///< [s], `fixed` only; calls are divided into equal steps
  double largest_step{0.0};         ///< [s]; 0: none
  /// [s], `exponential` only: a step in which an event happens is at most this long. Ten of them
  /// fit between two samples of a controller at 1 kHz.
  double event_time{1e-4};
};

struct IntegratorStatistics {
  long steps{};
  long evaluations{};  ///< of the right-hand side, those for Jacobians included
  long rejected{};     ///< steps that failed the error test
  long jacobians{};
};

/// Something that happened; `begins`: the event's function turned negative (touched, cavitates).
struct EventRecord {
  double time{};
  int leg{};  ///< from 0
  Plant::Event event{};
  bool begins{};
};

class Integrator {
 public:
  /// The plant must outlive the integrator.
  Integrator(const Plant& plant, const IntegratorOptions& options = {});
  ~Integrator();
  Integrator(Integrator&&) noexcept;
  Integrator& operator=(Integrator&&) noexcept;

  void start(double time, const Eigen::VectorXd& x);
  /// Integrates to `to` ≥ time() with constant input. Throws base::ComputationError that names the
  /// time and the part when it cannot go on (a piston leaves its guide sleeve, a leg does not
  /// close, a value is not finite, the step becomes too small); time() and state() are then the
  /// last good ones.
  void advance(double to, const PlantInput& input);

  [[nodiscard]] double time() const;
  [[nodiscard]] const Eigen::VectorXd& state() const;
  [[nodiscard]] const IntegratorStatistics& statistics() const;
  /// Events since the start, in order; by Runge–Kutta noticed at the end of the step, by
  /// CVODE located.
  [[nodiscard]] const std::vector<EventRecord>& events() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// What moves or holds the legs.
enum class Actuators {
  controlled,  ///< valves or motors, by the controller
  held,        ///< valves that stay as they are at rest, motors whose speed is held at 0, but for
               ///< the excitation's drives
  springs      ///< the oil springs of the linear model, motors that cannot turn;
               ///< `plant.hydraulics` is false then
};

struct LoopOptions {
  ModelKind kind{ModelKind::guide};
  PlantOptions plant{};
  IntegratorOptions integrator{};
  double until{5.0};                        ///< [s]
  std::optional<double> output_interval{};  ///< [s]; default: the controller's sample time
  std::uint64_t seed{1};                    ///< of the sensors' noise
  bool ideal_sensors{};                     ///< no noise, range, resolution
  Actuators actuators{};
  /// Displacement from the operating pose [m, rad] where the platform stands at time 0, at rest and
  /// held there by what then lets it go: the controller, or the oil springs. Not for valves that
  /// are held, which would hold it.
  Vector6 initial{Vector6::Zero()};
  bool records_wrench{};  ///< the wrench has channels in the record
};

/// What comes from outside at a sample: the commanded displacement from the operating pose, drives
/// added to the controller's (shares, delayed and limited as they are), a wrench about C.
struct Excitation {
  signals::Sample command{};
  Vector6 drive{Vector6::Zero()};
  Vector6 wrench{Vector6::Zero()};
  /// That of the next sample. Where it is given, each wrench is held about its sample, half a
  /// sample to each side; else from its sample to the next one, half a sample late on average.
  std::optional<Vector6> next_wrench{};
  /// Drives in place of the controller's, of a controller outside (shares; `drive` is added, delay
  /// and limit are those of the own controller). Where they end, the own controller takes over at
  /// the pose that the platform has then.
  std::optional<Vector6> outside{};
};
/// Called once per controller sample, in order, with its time [s].
using ExcitationSource = std::function<void(double time, Excitation& excitation)>;

/// The machine at a controller sample, before the excitation of the sample is known.
struct SampledMachine {
  double time{};
  const control::Measurement& measured;  ///< what the controller is going to see at this sample
  const Vector6& applied;                ///< at the valves until now
  const Plant& plant;
  const Eigen::VectorXd& x;
  const PlantInput& input;  ///< until now
};
/// A source that sees the machine, such as a client beyond a network. False ends the run.
using Exchange = std::function<bool(const SampledMachine& machine, Excitation& excitation)>;

/// The commands of `signals`, from its next sample on, and the wrench of `wrenches`, if any. They
/// must outlive the source.
ExcitationSource command_source(signals::Generator& signals,
                                signals::Generator* wrenches = nullptr);

/// One signal, and the sample after the one that is given.
class LookAhead {
 public:
  /// From the next sample of `signal` on; it must outlive this.
  explicit LookAhead(signals::Generator& signal) : signal_(&signal), next_(signal.next()) {}
  /// Sets both wrenches.
  void fill(Excitation& excitation);

 private:
  signals::Generator* signal_;
  signals::Sample next_;
};

/// What is known at an output instant. With an output at a controller sample, it is of that sample.
struct LoopSample {
  double time{};
  const Excitation& excitation;
  const control::Measurement& measured;  ///< as the controller saw it last
  const control::ControllerState& controller;
  const Vector6& drive;    ///< the controller's last, excitation added
  const Vector6& applied;  ///< at the valves
  const PlantOutput& plant;
};
using LoopSink = std::function<void(const LoopSample& sample)>;
/// Called every 10 ms of simulated time; false ends the run.
using KeepGoing = std::function<bool(double time)>;

enum class RunEnd {
  finished,
  stopped,  ///< by KeepGoing
  failed    ///< `message` says why; everything before is sound
};

/// Accounts of a run, over its controller samples.
struct RunSummary {
  RunEnd end{RunEnd::finished};
  std::string message{};
  double time{};  ///< simulated [s]
  long samples{};
  IntegratorStatistics integrator{};
  std::vector<EventRecord> events{};

  Vector6 rms_error{Vector6::Zero()};  ///< commanded less true pose, x…rz [m, rad]
  Vector6 peak_error{Vector6::Zero()};
  Vector6 final_error{Vector6::Zero()};
  Vector6 peak_command{Vector6::Zero()};  ///< of the commanded displacement
  Vector6 peak_motion{Vector6::Zero()};   ///< of the true displacement
  /// Time after which the true displacement stays within `settling_band` of the command [s].
  Vector6 settled{Vector6::Zero()};
  std::array<double, model::leg_count> piston_low{}, piston_high{};  ///< s [m]
  std::array<double, model::leg_count> peak_speed{};                 ///< |ṡ| [m/s]
  std::array<double, model::leg_count> peak_drive{};                 ///< applied
  std::array<long, model::leg_count> limited{};  ///< samples with the drive at its limit
  /// Of electric drives: |T| [N m], and samples with the torque at its limit.
  std::array<double, model::leg_count> peak_torque{};
  std::array<long, model::leg_count> torque_limited{};
};

/// Of the steps among commands, per direction: when the last one comes, and how near to its end a
/// settled motion stays.
struct Settling {
  std::array<std::optional<double>, 6> step{};  ///< [s]; none: no step
  Vector6 band{Vector6::Constant(1e-5)};        ///< 2 % of the step; without one 1e-5 [m, rad]
};
Settling settling_of(const std::vector<signals::Signal>& commands);
/// From the last step in a direction, or from the beginning, until the motion of a run with this
/// band stays within it [s]; none: not for the last tenth of the time since then.
std::optional<double> settling_time(const RunSummary& run, const Settling& settling, int direction);

class ClosedLoop {
 public:
  /// Tunes the controller and brings the machine to rest at `operating`. Throws
  /// base::ComputationError where it cannot stand there (or at `initial`), std::invalid_argument
  /// for options that make no sense, std::length_error for more than 10⁹ samples of the controller
  /// or the record.
  ClosedLoop(const model::Machine& machine, const Pose& operating, const LoopOptions& options = {});
  ~ClosedLoop();
  ClosedLoop(ClosedLoop&&) noexcept;
  ClosedLoop& operator=(ClosedLoop&&) noexcept;

  [[nodiscard]] const Plant& plant() const;
  [[nodiscard]] const control::ControllerParameters& parameters() const;
  [[nodiscard]] double lowest_oil_mode() const;  ///< [rad/s], see tuning.hpp
  [[nodiscard]] const Pose& operating() const;
  [[nodiscard]] double output_interval() const;
  [[nodiscard]] const Plant::Rest& rest() const;
  [[nodiscard]] const LoopOptions& options() const;

  /// From rest at time 0 to `until`; may be called again. The run ends early, with a message, when
  /// forward kinematics finds no pose, when the platform leaves its workspace (joint limits,
  /// singular pose) or when the integrator cannot go on. Exceptions of source and sink pass
  /// through. `settling_band` [m, rad] is for RunSummary::settled.
  RunSummary run(const ExcitationSource& source, const LoopSink& sink,
                 const KeepGoing& keep_going = {},
                 const Vector6& settling_band = Vector6::Constant(1e-5));

  /// The same with a source that sees the machine. For equal excitations the run is the same bit
  /// for bit.
  RunSummary run_with(const Exchange& exchange, const LoopSink& sink,
                      const KeepGoing& keep_going = {});

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// The command that a displacement d = (x, y, z, rx, ry, rz) [m, rad] from `operating` is: p = p_0
/// + (x, y, z), R = Rz(rz) Ry(ry) Rx(rx) R_0, as `--pose "z=50 mm, ry=5 deg"` does. Its rate
/// becomes the velocity for the controller's feed-forward.
control::Command command_at(const Pose& operating, const signals::Sample& displacement);

/// (x, y, z; rx, ry, rz) of `X_BP` as a displacement from `operating`: the inverse of command_at.
Vector6 displacement_between(const Pose& operating, const Pose& X_BP);

/// Time histories, thinned out for pictures.
struct Trace {
  std::vector<double> time{};      ///< [s]
  std::vector<Vector6> command{};  ///< displacement from the operating pose [m, rad]
  std::vector<Vector6> motion{};   ///< the same of the platform
  std::vector<Vector6> piston{};   ///< s per leg, from the base joint [m]
  std::vector<Vector6> drive{};    ///< at the valves
  std::vector<Vector6> cap_pressure{}, rod_pressure{};  ///< [Pa]; none with electric drives
  /// Of electric drives alone: way of the nuts [m], speed [rad/s] and torque [N m] of the motors.
  std::vector<Vector6> nut{}, motor_speed{}, torque{};
};

/// Collects at most `most` samples of a run, evenly.
class TraceRecorder {
 public:
  TraceRecorder(const ClosedLoop& loop, double until, std::size_t most = 3000);
  void operator()(const LoopSample& sample);
  [[nodiscard]] const Trace& trace() const { return trace_; }

 private:
  Pose operating_;
  bool drives_;  ///< electric ones
  long stride_{1};
  long seen_{};
  Trace trace_{};
};

/// The channels of a run's record: command.x … rz (with a controller), wrench.x … rz (where it is
/// recorded), platform.x … rz (displacements from the
/// operating pose), platform.ax … arz (acceleration of the platform's origin), then per leg its
/// length, measured length, drive at the valve, spool, both pressures (of these four nothing with
/// oil springs; with electric drives drive, way of the nut, speed and torque of the motor in their
/// place), oil force, and with flexible legs the offset of the rod in its guide sleeve; the
/// supply pressure where it moves.
std::vector<data::Channel> record_channels(const ClosedLoop& loop);

/// The sample as one row of that record; `row` has record_channels().size() places.
void record_row(const ClosedLoop& loop, const LoopSample& sample, double* row);

struct MotionFinding {
  base::Severity severity{base::Severity::error};
  std::string message{};
};

/// The worst of each kind per leg, with its time and by how much: stroke and joint limits exceeded,
/// a singular pose (errors); a speed beyond what the valve gives under the load at rest (a warning:
/// the drive will be at its limit). `signal` is run through from its start and restarted. Where
/// `keep_going` ends it, the findings are those of the time before.
std::vector<MotionFinding> check_motion(const Plant& plant,
                                        const control::ControllerParameters& parameters,
                                        const Pose& operating, signals::Generator& signal,
                                        double until, const KeepGoing& keep_going = {});

/// Why the machine does not stay at its operating pose without excitation: legs that buckle under
/// the present load, or a closed loop that is unstable by its sampled poles. Empty where it stays.
std::string instability(const ClosedLoop& loop);
/// The same of a machine; no `controller`: as tune_controller has it. Not `controlled`: on its oil
/// springs.
std::string instability(const model::Machine& machine, const Pose& X_BP, ModelKind kind,
                        bool controlled, const control::ControllerParameters* controller = {});

/// Where the command first brings a machine that stands at its operating pose to a pose at which it
/// does not: its legs buckle there, and the loop is unstable. Empty: nowhere. At most 500 places of
/// the command are looked at, as long as `keep_going` says so. `signal` is run through from its
/// start and restarted.
std::string loss_of_rest(const ClosedLoop& loop, signals::Generator& signal, double until,
                         const KeepGoing& keep_going = {});

/// Why a pose that the platform has come to ends a run: a joint beyond its limit, a singular pose.
/// Empty when it does not.
std::string leaves_workspace(const model::Machine& machine, const Pose& X_BP);

}  // namespace hydrapod::simulation
