#pragma once
/// One instance of the FMU: a plant with its time, state, inputs and parameters. It knows nothing
/// of the interface's versions and call sequences; fmi2.cpp and fmi3.cpp do.
///
/// Nothing is shared between instances, so each may live in a thread of its own. The only file that
/// is read is resources/machine.json, when the instance is made.

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "exchange/fmu_interface.hpp"
#include "hydrapod/simulation/closed_loop.hpp"

namespace hydrapod::fmu {

using exchange::FmuRole;

/// What the caller must not do: answered by an error. Other exceptions are of a state that the
/// model cannot be in, answered by a discard.
class Misuse : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What is saved and restored, bit by bit.
struct SavedState {
  std::int64_t mode{};  ///< of the call sequence
  double time{}, start{}, stop{}, tolerance{};
  bool has_stop{}, ready{};
  std::vector<double> parameters{}, inputs{}, x{};

  [[nodiscard]] std::size_t bytes() const;
  void write(char* to) const;
  /// Throws Misuse for bytes that are no state with these numbers of values.
  static SavedState read(const char* from, std::size_t size, const SavedState& like);
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
  /// The plant with the present parameters, at rest. Throws for a machine that cannot be.
  void prepare();
  /// Between parameters that were set and a value that is asked for.
  void prepare_if_needed() {
    if (!state_.ready) prepare();
  }

  [[nodiscard]] const exchange::FmuInterface& interface() const { return interface_; }
  [[nodiscard]] int state_count() const { return states_; }
  [[nodiscard]] int indicator_count() const {
    return static_cast<int>(interface_.indicators.size());
  }
  [[nodiscard]] const simulation::Plant& plant() const { return *plant_; }

  [[nodiscard]] double time() const { return state_.time; }
  void set_time(double time);

  double get(unsigned reference);
  /// Throws Misuse where the variable cannot be set, the number is out of bounds or not finite.
  void set(unsigned reference, double value, bool initialized);

  [[nodiscard]] const std::vector<double>& states() const { return state_.x; }
  void set_states(const double* x);
  void derivatives(double* rates);
  std::vector<double> indicators();
  [[nodiscard]] std::vector<double> nominals() const;
  /// Has the model ended: has a piston left its guide sleeve?
  bool has_ended();

  /// Integrates with constant inputs from `from`, which must be the present time. False when it
  /// stopped on the way, at time(); `message` then says why.
  bool step(double from, double size, std::string& message);

  /// d unknowns / d known, one of states and inputs; `with_states`: states are knowns.
  void derivative(unsigned known, const unsigned* unknowns, std::size_t count, bool with_states,
                  double* result);

  /// `mode` of the call sequence comes along.
  [[nodiscard]] SavedState save(std::int64_t mode) const;
  void restore(const SavedState& saved);

 private:
  [[nodiscard]] const exchange::FmuVariable& variable(unsigned reference) const;
  [[nodiscard]] simulation::PlantInput input() const;
  void forget() { outputs_.clear(); }
  std::vector<double> unknowns_at(const std::vector<double>& x,
                                  const std::vector<double>& inputs) const;

  exchange::FmuMachine base_{};
  exchange::FmuInterface interface_{};
  SavedState state_{};
  int states_{};
  std::vector<double> built_with_{};  ///< parameters of the present plant
  std::unique_ptr<simulation::Plant> plant_{};
  std::unique_ptr<simulation::Integrator> integrator_{};
  double integrator_tolerance_{};
  std::vector<double> outputs_{};  ///< at the present state; empty: to be computed
};

}  // namespace hydrapod::fmu
