#pragma once
/// The machine under its controller: plant, sensors, sampled control law, delay, valve drives.
///
/// At every sample t_k = k T the sensors are read and the controller computes drives, which reach
/// the valves at t_k + delay · T (any fraction of samples) and stay until the next ones do. Between
/// these instants and those of the output the plant is integrated with constant input. One thread,
/// fixed order, own random numbers: the same options give the same samples bit for bit.
///
///     ClosedLoop loop(machine, pose, {.until = 5.0});
///     signals::Generator commands({{.size = …, .form = signals::Step{}}}, 1.0 / T);
///     loop.run(command_source(commands), [&](const LoopSample& sample) { … });

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hydrapod/control/controller.hpp"
#include "hydrapod/signals/signals.hpp"
#include "hydrapod/simulation/integrator.hpp"

namespace hydrapod::simulation {

struct LoopOptions {
  ModelKind kind{ModelKind::guide};
  PlantOptions plant{};
  IntegratorOptions integrator{};
  double until{5.0};                        ///< [s]
  std::optional<double> output_interval{};  ///< [s]; default: the controller's sample time
  std::uint64_t seed{1};                    ///< of the sensors' noise
  bool ideal_sensors{};                     ///< no noise, range, resolution
};

/// What comes from outside at a sample: the commanded displacement from the operating pose, drives
/// added to the controller's (shares, delayed and limited as they are), a wrench about C.
struct Excitation {
  signals::Sample command{};
  Vector6 drive{Vector6::Zero()};
  Vector6 wrench{Vector6::Zero()};
};
/// Called once per controller sample, in order, with its time [s].
using ExcitationSource = std::function<void(double time, Excitation& excitation)>;

/// The commands of `signals`, from its next sample on. It must outlive the source.
ExcitationSource command_source(signals::Generator& signals);

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
};

class ClosedLoop {
 public:
  /// Tunes the controller and brings the machine to rest at `operating`. Throws
  /// base::ComputationError where it cannot stand there, std::invalid_argument for options that
  /// make no sense.
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

  /// From rest at time 0 to `until`; may be called again. The run ends early, with a message, when
  /// forward kinematics finds no pose, when the platform leaves its workspace (joint limits,
  /// singular pose) or when the integrator cannot go on. Exceptions of source and sink pass
  /// through. `settling_band` [m, rad] is for RunSummary::settled.
  RunSummary run(const ExcitationSource& source, const LoopSink& sink,
                 const KeepGoing& keep_going = {},
                 const Vector6& settling_band = Vector6::Constant(1e-5));

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

}  // namespace hydrapod::simulation
