#pragma once
/// A simulated run from commands as people write them: what `hydrapod simulate` runs, prints and
/// plots.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hydrapod/report/json.hpp"
#include "hydrapod/simulation/motion_check.hpp"
#include "hydrapod/simulation/trace.hpp"
#include "hydrapod/simulation/tuning.hpp"

namespace hydrapod::report {

struct SimulationOptions {
  std::vector<std::string> commands{};  ///< see signals/signal_text.hpp; they add up
  std::optional<double> until{};        ///< [s]; default: what the commands need, and a little more
  simulation::LoopOptions loop{};       ///< `until` is not used
  std::size_t trace_samples{3000};
};

/// A run that can begin: commands read, machine at rest, motion checked.
struct PreparedSimulation {
  SimulationOptions options{};  ///< with `until` filled in
  std::vector<signals::Signal> commands{};
  std::unique_ptr<signals::Generator> signal{};
  std::unique_ptr<simulation::ClosedLoop> loop{};
  std::vector<std::string> warnings{};  ///< valves too small for the motion
};

/// Throws base::InputError for commands that cannot be read, make no sense, or lead out of the
/// workspace; base::ComputationError where the machine does not stand at the pose.
PreparedSimulation prepare_simulation(const model::Machine& machine, const model::NamedPose& pose,
                                      const SimulationOptions& options);

struct Simulation {
  std::vector<std::string> commands{};  ///< as signals::signal_text writes them
  std::vector<std::string> warnings{};
  double until{};
  double output_interval{};
  simulation::LoopOptions loop{};
  control::ControllerParameters controller{};
  double lowest_oil_mode{};  ///< [rad/s]
  std::array<hydraulics::Stops, model::leg_count> stops{};
  /// Of the steps among the commands, per direction: when [s], and within which band a settled
  /// platform stays: 2 % of the step. Not set without a step.
  std::array<std::optional<double>, 6> step_time{};
  Eigen::Matrix<double, 6, 1> settling_band{};
  simulation::RunSummary summary{};
  simulation::Trace trace{};
};

/// Runs it; `sink` gets every sample.
Simulation run_simulation(PreparedSimulation& prepared, const simulation::LoopSink& sink = {},
                          const simulation::KeepGoing& keep_going = {});

/// `model`, `commands[]`, `controller`, `run`, `directions[]`, `legs[]`, `trace`.
Json simulation_json(const Simulation& simulation);
Simulation simulation_from_json(const Json& json, const std::string& file);

/// The run as the page of `hydrapod report` shows it: `pose`, `geometry` of the machine there,
/// `summary` in words, and the above. `rest`: the model at the pose at which the run began.
Json simulation_section(const Simulation& simulation, const model::Machine& machine,
                        const model::NamedPose& pose, const dynamics::LinearModel& rest);

/// The controller's numbers: `controller` of the above.
Json controller_json(const control::ControllerParameters& parameters, double lowest_oil_mode);
simulation::Tuning controller_from_json(const Json& json, const std::string& file);

/// Commanded and true motion in the six directions, and pistons and drives of the legs, over time.
/// Throws as plot_bode does.
void plot_simulation(const Simulation& simulation, const std::string& title,
                     const std::string& subtitle, const std::string& path);
/// Throws base::InputError for a picture ending that plots do not know.
void require_picture_ending(const std::string& path);

}  // namespace hydrapod::report
