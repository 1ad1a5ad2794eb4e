#include "hydrapod/simulation/closed_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "run_accounts.hpp"
#include "sliding_seals.hpp"
#include "stiffness.hpp"
#include "true_measurement.hpp"

namespace hydrapod::simulation {

namespace {

constexpr double watch_interval = 0.01;  // [s] between looks at workspace and keep_going
constexpr double coincidence = 1e-6;     // of a sample time: instants closer than this are one
constexpr double most_samples = 1e9;     // of a run; at 1 kHz eleven days
// Where simulated time passes slowly keep_going is asked by the clock.
constexpr std::chrono::milliseconds patience{50};

void require_positive(const char* name, double value) {
  if (!(std::isfinite(value) && value > 0.0))
    throw std::invalid_argument(
        fmt::format("LoopOptions::{} is {:.6g}, expected more than 0", name, value));
}

void require_bounded(double until, double interval, const char* what) {
  const double samples = until / interval;
  if (!(samples <= most_samples))
    throw std::length_error(fmt::format(
        "{:.6g} s are {:.3g} samples of {} {:.6g} s, expected at most {:g}, which are {:.6g} s",
        until, samples, what, interval, most_samples, most_samples * interval));
}

/// Drives or a wrench from `time` on.
struct Pending {
  double time{};
  Vector6 values{};
};

LoopOptions with_its_plant(LoopOptions options) {
  if (options.actuators == Actuators::springs) options.plant.hydraulics = false;
  return options;
}

/// Of legs that their springs hold: there is nothing to control. Its drives are zero.
Tuning without_controller(const model::Machine& machine) {
  control::ControllerParameters p{.velocity_feedforward = 0.0,
                                  .sample_time = machine.controller.sample_time,
                                  .delay = machine.controller.delay,
                                  .compensation = model::Compensation::none,
                                  .output = machine.controller.output};
  p.axes.fill(
      {.piston_area = 1.0, .annulus_area = 1.0, .flow_coefficient = 1.0, .supply_pressure = 1.0});
  return {.parameters = p};
}

Tuning tuned(const model::Machine& machine, const Pose& pose, const LoopOptions& options) {
  return options.actuators == Actuators::springs ? without_controller(machine)
                                                 : tune_controller(machine, pose);
}

}  // namespace

struct ClosedLoop::Implementation {
  Implementation(const model::Machine& machine, const Pose& pose, const LoopOptions& given)
      : options(with_its_plant(given)),
        operating(pose),
        plant(options.plant.hydraulics ? with_sliding_seals(machine) : machine, given.kind,
              options.plant, pose),
        tuning(tuned(machine, pose, options)),
        rest(plant.equilibrium(pose)),
        start(given.initial.isZero()
                  ? rest.x
                  : plant.equilibrium(command_at(pose, {.value = given.initial}).X_BP).x),
        controller(machine, tuning.parameters) {}

  LoopOptions options;
  Pose operating;
  Plant plant;
  Tuning tuning;
  Plant::Rest rest;
  Eigen::VectorXd start;  ///< x at time 0
  control::Controller controller;
};

namespace {

/// One run, instant by instant.
class Run {
 public:
  Run(const LoopOptions& options, const Plant& plant, const Pose& operating,
      const Plant::Rest& rest, const Eigen::VectorXd& start, control::Controller& controller,
      double output_interval, const Vector6& band)
      : options_(options),
        plant_(plant),
        operating_(operating),
        controller_(controller),
        integrator_(plant, options.integrator),
        sensors_(options.ideal_sensors ? ideal() : plant.machine().sensors, options.seed),
        T_(controller.parameters().sample_time),
        output_interval_(output_interval),
        accounts_(plant, operating, band) {
    integrator_.start(0.0, start);
    input_ = rest.input;
    held_ = applied_ = drive_ = rest.input.command;
    measured_ = truth();
    controller_.reset(operating, measured_);
    controller_.take_over(rest.input.command);
    slack_ = coincidence * std::min(T_, output_interval);
  }

  RunSummary go(const Exchange& exchange, const LoopSink& sink, const KeepGoing& keep_going) {
    while (next_time() <= options_.until + slack_) {
      const double now = next_time();
      if (now > integrator_.time() + slack_ && !advance(now)) break;
      apply_due_drives(now);
      apply_due_wrench(now);
      if (tick_time() <= now + slack_ && !tick(now, exchange)) break;
      if (output_time() <= now + slack_) {
        output(now, sink);
        ++outputs_;
      }
      if (now >= watched_ + watch_interval - slack_ && !watch(now, keep_going)) break;
      if (std::chrono::steady_clock::now() - asked_ > patience && !goes_on(now, keep_going)) break;
    }
    accounts_.summary.integrator = integrator_.statistics();
    accounts_.summary.events = integrator_.events();
    return accounts_.finish(integrator_.time());
  }

 private:
  static model::Sensors ideal() {
    return {{0.0, 0.0, {}, {}}, {0.0, 0.0, {}, {}}, {0.0, 0.0, {}, {}}};
  }

  [[nodiscard]] double tick_time() const { return T_ * static_cast<double>(ticks_); }
  [[nodiscard]] double output_time() const {
    return output_interval_ * static_cast<double>(outputs_);
  }
  [[nodiscard]] double next_time() const {
    double next = std::min(tick_time(), output_time());
    if (!pending_.empty()) next = std::min(next, pending_.front().time);
    if (next_wrench_) next = std::min(next, next_wrench_->time);
    return next;
  }

  void fail(const std::string& message) {
    accounts_.summary.end = RunEnd::failed;
    accounts_.summary.message = message;
  }

  [[nodiscard]] control::Measurement truth() const {
    return true_measurement(plant_, integrator_.state().data(), input_,
                            controller_.parameters().feedback);
  }

  bool advance(double to) {
    try {
      integrator_.advance(to, input_);
      return true;
    } catch (const base::ComputationError& error) {
      fail(error.what());
      return false;
    }
  }

  void apply_due_drives(double now) {
    while (!pending_.empty() && pending_.front().time <= now + slack_) {
      applied_ = input_.command = pending_.front().values;
      pending_.erase(pending_.begin());
    }
  }

  void apply_due_wrench(double now) {
    if (!next_wrench_ || next_wrench_->time > now + slack_) return;
    input_.wrench = next_wrench_->values;
    next_wrench_.reset();
  }

  /// What the controller asks of the valves; none where it finds no pose.
  std::optional<Vector6> controlled_drive() {
    if (excitation_.outside) {
      outside_ = true;
      return excitation_.outside;
    }
    if (options_.actuators != Actuators::controlled) return held_;
    if (outside_) take_over();
    const Vector6 drive = controller_.step(measured_, command_at(operating_, excitation_.command));
    if (controller_.state().forward == kinematics::ForwardStatus::converged) return drive;
    fail(
        "the controller finds no pose for the measured leg lengths: the platform has reached a "
        "singular pose, or a sensor has left its range");
    return std::nullopt;
  }

  /// From a controller outside, where the platform is.
  void take_over() {
    outside_ = false;
    controller_.reset(plant_.pose(integrator_.state().data()), measured_);
    controller_.take_over(held_);
  }

  /// One sample of the controller; false where the run ends.
  bool tick(double now, const Exchange& exchange) {
    excitation_ = {};
    measured_ = sensors_.read(truth());
    if (!exchange({now, measured_, applied_, plant_, integrator_.state(), input_}, excitation_)) {
      accounts_.summary.end = RunEnd::stopped;
      return false;
    }
    const auto asked = controlled_drive();
    if (!asked) return false;
    const double limit = controller_.parameters().output.limit;
    drive_ = (*asked + excitation_.drive).cwiseMax(-limit).cwiseMin(limit);
    const double delay = controller_.parameters().delay * T_;
    pending_.push_back({now + delay, drive_});
    apply_due_drives(now);
    if (ticks_ == 0 || !excitation_.next_wrench) input_.wrench = excitation_.wrench;
    if (excitation_.next_wrench) next_wrench_ = {now + 0.5 * T_, *excitation_.next_wrench};
    accounts_.see(integrator_.state(), input_.command, excitation_.command.value,
                  controller_.state(), now);
    ++ticks_;
    return true;
  }

  void output(double now, const LoopSink& sink) {
    if (!sink) return;
    const PlantOutput plant = plant_.outputs(integrator_.state().data(), input_);
    sink({now, excitation_, measured_, controller_.state(), drive_, applied_, plant});
  }

  /// False ends the run.
  bool watch(double now, const KeepGoing& keep_going) {
    watched_ = now;
    const auto reason = leaves_workspace(plant_.machine(), plant_.pose(integrator_.state().data()));
    if (!reason.empty()) {
      fail(reason);
      return false;
    }
    return goes_on(now, keep_going);
  }

  bool goes_on(double now, const KeepGoing& keep_going) {
    asked_ = std::chrono::steady_clock::now();
    if (!keep_going || keep_going(now)) return true;
    accounts_.summary.end = RunEnd::stopped;
    return false;
  }

  const LoopOptions& options_;
  const Plant& plant_;
  const Pose& operating_;
  control::Controller& controller_;
  Integrator integrator_;
  SensorBank sensors_;
  double T_;
  double output_interval_;
  double slack_{};
  RunAccounts accounts_;

  long ticks_{}, outputs_{};
  double watched_{};
  std::chrono::steady_clock::time_point asked_{std::chrono::steady_clock::now()};
  std::vector<Pending> pending_{};  ///< drives; as many as the delay has samples
  std::optional<Pending> next_wrench_{};
  PlantInput input_{};
  bool outside_{};  ///< the last drives were of a controller outside
  Excitation excitation_{};
  control::Measurement measured_{};
  Vector6 held_{Vector6::Zero()}, drive_{Vector6::Zero()}, applied_{Vector6::Zero()};
};

}  // namespace

ClosedLoop::ClosedLoop(const model::Machine& machine, const Pose& operating,
                       const LoopOptions& options) {
  require_positive("until", options.until);
  if (options.output_interval) require_positive("output_interval", *options.output_interval);
  if (!options.plant.hydraulics && options.actuators != Actuators::springs)
    throw std::invalid_argument(
        "LoopOptions::plant.hydraulics is false: there are no valves to control");
  if (!options.initial.isZero() && options.actuators == Actuators::held)
    throw std::invalid_argument(
        "LoopOptions::initial is not 0: held valves hold the platform there");
  require_bounded(options.until, machine.controller.sample_time, "the controller's");
  if (options.output_interval)
    require_bounded(options.until, *options.output_interval, "the record's");
  implementation_ = std::make_unique<Implementation>(machine, operating, options);
  require_passable(plant(), rest(), options.integrator, options.until);
}
ClosedLoop::~ClosedLoop() = default;
ClosedLoop::ClosedLoop(ClosedLoop&&) noexcept = default;
ClosedLoop& ClosedLoop::operator=(ClosedLoop&&) noexcept = default;

const Plant& ClosedLoop::plant() const { return implementation_->plant; }
const control::ControllerParameters& ClosedLoop::parameters() const {
  return implementation_->tuning.parameters;
}
double ClosedLoop::lowest_oil_mode() const { return implementation_->tuning.lowest_oil_mode; }
const Pose& ClosedLoop::operating() const { return implementation_->operating; }
double ClosedLoop::output_interval() const {
  return implementation_->options.output_interval.value_or(parameters().sample_time);
}
const Plant::Rest& ClosedLoop::rest() const { return implementation_->rest; }
const LoopOptions& ClosedLoop::options() const { return implementation_->options; }

RunSummary ClosedLoop::run(const ExcitationSource& source, const LoopSink& sink,
                           const KeepGoing& keep_going, const Vector6& settling_band) {
  auto& own = *implementation_;
  Run run(own.options, own.plant, own.operating, own.rest, own.start, own.controller,
          output_interval(), settling_band);
  const Exchange blind = [&source](const SampledMachine& machine, Excitation& excitation) {
    source(machine.time, excitation);
    return true;
  };
  return run.go(blind, sink, keep_going);
}

RunSummary ClosedLoop::run_with(const Exchange& exchange, const LoopSink& sink,
                                const KeepGoing& keep_going) {
  auto& own = *implementation_;
  Run run(own.options, own.plant, own.operating, own.rest, own.start, own.controller,
          output_interval(), Vector6::Constant(1e-5));
  return run.go(exchange, sink, keep_going);
}

void LookAhead::fill(Excitation& excitation) {
  excitation.wrench = next_.value;
  next_ = signal_->next();
  excitation.next_wrench = next_.value;
}

ExcitationSource command_source(signals::Generator& signals, signals::Generator* wrenches) {
  std::optional<LookAhead> forces;
  if (wrenches != nullptr) forces.emplace(*wrenches);
  return [&signals, forces](double, Excitation& excitation) mutable {
    excitation.command = signals.next();
    if (forces) forces->fill(excitation);
  };
}

}  // namespace hydrapod::simulation
