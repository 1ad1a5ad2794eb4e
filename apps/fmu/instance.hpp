#pragma once
/// One instance of the FMU: a plant with its time, state, inputs and parameters, and the controller
/// where it is inside. It knows nothing of the interface's versions and call sequences; fmi2.cpp
/// and fmi3.cpp do.
///
/// Nothing is shared between instances, so each may live in a thread of its own. The only file that
/// is read is resources/machine.json, when the instance is made.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "exchange/fmu_interface.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "loop.hpp"

namespace hydrapod::fmu {

using exchange::FmuRole;

/// What the caller must not do: answered by an error. Other exceptions are of a state that the
/// model cannot be in, answered by a discard.
class Misuse : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A value that is not taken; all is as before the call. Answered by a discard.
class Refusal : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What is saved and restored, bit by bit.
struct SavedState {
  std::string token{};  ///< of the FMU, at most 39 bytes
  std::int64_t mode{};  ///< of the call sequence
  double time{}, start{}, stop{}, tolerance{};
  bool has_stop{}, ready{};
  std::vector<double> parameters{};
  std::vector<double> at_rest{};  ///< the parameters when the machine was brought to rest
  std::vector<double> inputs{}, x{}, loop{};

  [[nodiscard]] std::size_t bytes() const;
  void write(char* to) const;
  /// Throws Misuse for bytes that are no state of the FMU that `like` is of, or not finite.
  static SavedState read(const char* from, std::size_t size, const SavedState& like);
};

struct StepOptions {
  bool stops_at_events{};
  /// Called after each part of a step, with the time; inputs may be set there. A time that it
  /// returns is the end of the step.
  std::function<std::optional<double>(double)> between{};
};

struct StepResult {
  bool whole{true};  ///< no failure on the way, time() is where it stopped
  bool early{};      ///< an event, or the end that `between` asked for
  bool event{};
  std::string message{};  ///< of a failure
};

/// Which variables may be set now.
struct Settable {
  bool fixed{}, tunable{}, states{};
};

class Instance {
 public:
  static constexpr double default_tolerance = 1e-6;

  /// Throws for a folder without a machine, and for another token.
  Instance(const std::string& resource_folder, const std::string& token);

  /// Back to what it was when it was made.
  void reset();
  /// Throws Misuse for times or tolerances that are none.
  void set_up(double start, bool has_stop, double stop, bool has_tolerance, double tolerance);
  /// The machine with the present parameters, at rest. Throws Misuse for one that cannot be.
  void prepare();
  /// Between parameters that were set and a value that is asked for.
  void prepare_if_needed() {
    if (!state_.ready) prepare();
  }

  [[nodiscard]] int state_count() const { return states_; }
  [[nodiscard]] int indicator_count() const {
    return static_cast<int>(interface_.indicators.size());
  }
  /// May it be reached within a step?
  [[nodiscard]] bool is_intermediate(unsigned reference) const {
    return variable(reference).is_intermediate();
  }

  [[nodiscard]] double time() const { return state_.time; }
  void set_time(double time);

  double get(unsigned reference);
  /// All of them or none. Throws Misuse where a variable cannot be set or a number is not finite,
  /// Refusal for a number out of its bounds and for parameters that no machine can have.
  void set(const unsigned* references, std::size_t count, const double* values,
           const Settable& settable);

  [[nodiscard]] const std::vector<double>& states() const { return state_.x; }
  void set_states(const double* x);
  void derivatives(double* rates);
  std::vector<double> indicators();
  [[nodiscard]] std::vector<double> nominals() const;
  /// Has the model ended: has a piston left its guide sleeve?
  bool has_ended();
  /// Of model exchange: what the controller does now; the time when it does the next thing. Nothing
  /// without a controller.
  std::optional<double> update_discrete_states(bool of_exchange);

  /// Integrates from `from`, which must be the present time.
  StepResult step(double from, double size, const StepOptions& options);

  /// d unknowns / d known, one of states and inputs; `with_states`: states are knowns.
  void derivative(unsigned known, const unsigned* unknowns, std::size_t count, bool with_states,
                  double* result);

  /// `mode` of the call sequence comes along.
  [[nodiscard]] SavedState save(std::int64_t mode) const;
  void restore(const SavedState& saved);

 private:
  [[nodiscard]] const exchange::FmuVariable& variable(unsigned reference) const;
  [[nodiscard]] simulation::PlantInput input() const {
    return exchange::fmu_plant_input(base_, state_.inputs,
                                     loop_ ? loop_->applied() : Vector6(Vector6::Zero()));
  }
  void forget() { outputs_.clear(); }
  [[nodiscard]] exchange::FmuMachine machine_with(const std::vector<double>& parameters) const;
  [[nodiscard]] std::unique_ptr<simulation::Plant> plant_with(
      const std::vector<double>& parameters) const;
  void take(std::unique_ptr<simulation::Plant> plant, const std::vector<double>& parameters);
  void check(const exchange::FmuVariable& of, double value, const Settable& settable) const;
  /// All that the controller does now.
  void pass_loop();
  void advance(double to, bool stops_at_events, StepResult& result);
  void stop_at(const simulation::EventRecord& event, double from, const std::vector<double>& x);
  [[nodiscard]] bool has_happened(const simulation::EventRecord& event, const double* x) const;
  [[nodiscard]] std::vector<double> unknowns_at(const std::vector<double>& x,
                                                const std::vector<double>& inputs) const;

  exchange::FmuMachine base_{};
  exchange::FmuInterface interface_{};
  SavedState state_{};
  int states_{};
  std::vector<double> built_with_{};  ///< parameters of the present plant
  std::unique_ptr<simulation::Plant> plant_{};
  std::vector<double> tuned_with_{};  ///< parameters of the present controller
  std::unique_ptr<Loop> loop_{};
  std::unique_ptr<simulation::Integrator> integrator_{};
  double integrator_tolerance_{};
  std::vector<double> outputs_{};  ///< at the present state; empty: to be computed
};

}  // namespace hydrapod::fmu
