#include "instance.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "hydrapod/model/machine_file.hpp"

namespace hydrapod::fmu {

namespace {

std::string read_all(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw std::runtime_error("cannot read " + path);
  return text.str();
}

/// Of a time, relative to its size.
constexpr double time_tolerance = 1e-9;
bool later(double a, double b) { return a > b + time_tolerance * std::max(1.0, std::abs(b)); }

}  // namespace

Instance::Instance(const std::string& resource_folder, const std::string& token)
    : base_(exchange::read_fmu_machine(read_all(resource_folder + "/machine.json"))) {
  if (token != base_.token)
    throw Misuse("the model description is of another FMU: its token is " + token +
                 ", that of the resources " + base_.token);
  plant_ = std::make_unique<simulation::Plant>(base_.machine, base_.kind, base_.options(),
                                               base_.reference());
  interface_ = exchange::fmu_interface(base_, *plant_);
  states_ = plant_->layout().size;
  reset();
  built_with_ = state_.parameters;
}

void Instance::reset() {
  state_ = {.token = base_.token, .tolerance = default_tolerance};
  for (const auto& one : interface_.variables) {
    if (one.role == FmuRole::parameter) state_.parameters.push_back(*one.start);
    if (one.role == FmuRole::input) state_.inputs.push_back(*one.start);
  }
  state_.at_rest = state_.parameters;
  state_.x.assign(static_cast<std::size_t>(states_), 0.0);
  forget();
}

void Instance::set_up(double start, bool has_stop, double stop, bool has_tolerance,
                      double tolerance) {
  constexpr double tightest = 1e-14;
  if (!std::isfinite(start)) throw Misuse("the start time is not finite");
  if (has_stop && !(stop > start)) throw Misuse("the stop time is not after the start time");
  if (has_tolerance && !(tolerance >= tightest && tolerance < 1.0))
    throw Misuse("the tolerance is " + std::to_string(tolerance) + ", expected 1e-14 to 1");
  state_.start = state_.time = start;
  state_.has_stop = has_stop;
  state_.stop = stop;
  state_.tolerance = has_tolerance ? tolerance : default_tolerance;
  state_.ready = false;
}

/// Only numbers that were changed are assigned, so that all others keep their bits.
exchange::FmuMachine Instance::machine_with(const std::vector<double>& parameters) const {
  std::vector<model::Assignment> changed;
  const auto first = static_cast<std::size_t>(interface_.first(FmuRole::parameter));
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (parameters[k] != *interface_.variables[first + k].start)
      changed.push_back({interface_.parameters[k], parameters[k]});
  auto fmu = base_;
  model::assign(fmu.machine, changed);
  return fmu;
}

std::unique_ptr<simulation::Plant> Instance::plant_with(
    const std::vector<double>& parameters) const {
  const auto fmu = machine_with(parameters);
  for (const auto& finding : model::validate(fmu.machine))
    if (finding.severity == base::Severity::error)
      throw Refusal("parameters: " + finding.key + ": " + finding.message);
  auto plant =
      std::make_unique<simulation::Plant>(fmu.machine, fmu.kind, fmu.options(), fmu.reference());
  if (plant->layout() != plant_->layout() || plant->base().directions != plant_->base().directions)
    throw Refusal("parameters: these values change which states the model has");
  return plant;
}

void Instance::take(std::unique_ptr<simulation::Plant> plant,
                    const std::vector<double>& parameters) {
  integrator_.reset();  // it refers to the plant
  plant_ = std::move(plant);
  built_with_ = parameters;
  forget();
}

void Instance::prepare() {
  try {
    if (built_with_ != state_.parameters) take(plant_with(state_.parameters), state_.parameters);
  } catch (const Refusal& refusal) {
    throw Misuse(refusal.what());
  }
  const auto& operating = plant_->machine().poses.back().X_BP;
  const auto rest = plant_->equilibrium(operating);
  state_.x.assign(rest.x.begin(), rest.x.end());
  state_.at_rest = state_.parameters;
  if (base_.controlled) {
    if (!loop_ || tuned_with_ != state_.at_rest) loop_ = std::make_unique<Loop>(*plant_, operating);
    tuned_with_ = state_.at_rest;
    loop_->start(state_.start, *plant_, rest);
  }
  state_.ready = true;
  forget();
}

void Instance::set_time(double time) {
  if (!std::isfinite(time)) throw Misuse("the time is not finite");
  if (later(state_.start, time)) throw Misuse("the time is before the start time");
  if (state_.has_stop && later(time, state_.stop)) throw Misuse("the time is after the stop time");
  state_.time = time;
}

const exchange::FmuVariable& Instance::variable(unsigned reference) const {
  if (reference >= interface_.variables.size())
    throw Misuse("there is no variable with the value reference " + std::to_string(reference));
  return interface_.variables[reference];
}

double Instance::get(unsigned reference) {
  const auto& of = variable(reference);
  const auto index = static_cast<std::size_t>(of.index);
  switch (of.role) {
    case FmuRole::time:
      return state_.time;
    case FmuRole::input:
      return state_.inputs[index];
    case FmuRole::parameter:
      return state_.parameters[index];
    default:
      break;
  }
  prepare_if_needed();
  if (of.role == FmuRole::state) return state_.x[index];
  if (of.role == FmuRole::drive) return loop_->applied()[of.index];
  if (of.role == FmuRole::indicator) return indicators()[index];
  if (of.role == FmuRole::derivative) {
    std::vector<double> rates(state_.x.size());
    derivatives(rates.data());
    return rates[index];
  }
  if (outputs_.empty()) outputs_ = exchange::fmu_outputs(*plant_, state_.x.data(), input());
  return outputs_[index];
}

void Instance::check(const exchange::FmuVariable& of, double value,
                     const Settable& settable) const {
  if (!std::isfinite(value)) throw Misuse(of.name + ": the value is not finite");
  if (of.role == FmuRole::input || (of.role == FmuRole::state && settable.states)) return;
  if (of.role != FmuRole::parameter)
    throw Misuse(of.name + " is neither an input nor a parameter, so it cannot be set here");
  if (!settable.fixed && !of.tunable)
    throw Misuse(of.name + " is a fixed parameter: set it before or during initialization");
  if (!settable.fixed && !settable.tunable)
    throw Misuse(of.name + " is a parameter: it can be tuned at events and between steps");
  if ((of.low && value < *of.low) || (of.high && value > *of.high))
    throw Refusal(of.name + ": " + std::to_string(value) + " is out of its bounds");
}

void Instance::set(const unsigned* references, std::size_t count, const double* values,
                   const Settable& settable) {
  auto inputs = state_.inputs, parameters = state_.parameters, x = state_.x;
  for (std::size_t k = 0; k < count; ++k) {
    const auto& of = variable(references[k]);
    check(of, values[k], settable);
    auto& list = of.role == FmuRole::input ? inputs : of.role == FmuRole::state ? x : parameters;
    list[static_cast<std::size_t>(of.index)] = values[k];
  }
  if (parameters != state_.parameters) {
    if (settable.fixed)
      state_.ready = false;
    else
      take(plant_with(parameters), parameters);
  }
  state_.inputs = std::move(inputs);
  state_.parameters = std::move(parameters);
  state_.x = std::move(x);
  forget();
}

void Instance::set_states(const double* x) {
  for (int k = 0; k < states_; ++k)
    if (!std::isfinite(x[k])) throw Refusal("a continuous state is not finite");
  state_.x.assign(x, x + states_);
  forget();
}

void Instance::derivatives(double* rates) {
  prepare_if_needed();
  if (!plant_->derivative(state_.time, state_.x.data(), input(), rates))
    throw std::runtime_error("a leg does not close in this state, or a rate is not finite");
}

std::vector<double> Instance::indicators() {
  prepare_if_needed();
  return exchange::fmu_indicators(interface_, *plant_, state_.x.data());
}

std::vector<double> Instance::nominals() const {
  const auto scales = plant_->scales();
  return {scales.begin(), scales.end()};
}

bool Instance::has_ended() {
  const auto values = indicators();
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto event = static_cast<simulation::Plant::Event>(interface_.indicators[k] %
                                                             simulation::Plant::events_per_leg);
    if (event == simulation::Plant::Event::unguided && values[k] <= 0.0) return true;
  }
  return false;
}

/// States, derivatives, outputs, indicators.
std::vector<double> Instance::unknowns_at(const std::vector<double>& x,
                                          const std::vector<double>& inputs) const {
  const auto at =
      exchange::fmu_plant_input(base_, inputs, loop_ ? loop_->applied() : Vector6(Vector6::Zero()));
  std::vector<double> all(x);
  all.resize(2 * x.size());
  if (!plant_->derivative(state_.time, x.data(), at, all.data() + x.size()))
    throw std::runtime_error("a leg does not close near this state");
  const auto outputs = exchange::fmu_outputs(*plant_, x.data(), at);
  const auto events = exchange::fmu_indicators(interface_, *plant_, x.data());
  all.insert(all.end(), outputs.begin(), outputs.end());
  all.insert(all.end(), events.begin(), events.end());
  return all;
}

/// Differences of order 4 with the plant's own steps.
void Instance::derivative(unsigned known, const unsigned* unknowns, std::size_t count,
                          bool with_states, double* result) {
  prepare_if_needed();
  const auto& by = variable(known);
  const bool by_state = with_states && by.role == FmuRole::state;
  if (!by_state && by.role != FmuRole::input)
    throw Misuse(by.name + " is no known: states (after initialization) and inputs are");
  const auto first = static_cast<unsigned>(interface_.first(FmuRole::state));
  const auto end = static_cast<unsigned>(interface_.first(FmuRole::parameter));
  for (std::size_t k = 0; k < count; ++k)
    if (variable(unknowns[k]).name.empty() || unknowns[k] < first || unknowns[k] >= end)
      throw Misuse(variable(unknowns[k]).name + " is no unknown");
  const auto index = static_cast<std::size_t>(by.index);
  constexpr double command_step = 3e-5;  // forces and moments enter linearly
  const bool is_command = base_.hydraulics && by.index < base_.wrench_input();
  const double step = by_state     ? plant_->steps()[by.index]
                      : is_command ? command_step
                                   : plant_->machine().platform.mass;
  const auto at = [&](double h) {
    auto x = state_.x, inputs = state_.inputs;
    (by_state ? x : inputs)[index] += h;
    return unknowns_at(x, inputs);
  };
  const auto a = at(step), b = at(-step), c = at(2.0 * step), d = at(-2.0 * step);
  for (std::size_t k = 0; k < count; ++k) {
    const auto u = unknowns[k] - first;
    result[k] = u < state_.x.size() ? static_cast<double>(by_state && u == index)
                                    : (8.0 * (a[u] - b[u]) - (c[u] - d[u])) / (12.0 * step);
  }
}

SavedState Instance::save(std::int64_t mode) const {
  auto saved = state_;
  saved.mode = mode;
  if (loop_ && state_.ready) saved.loop = loop_->save();
  return saved;
}

void Instance::restore(const SavedState& saved) {
  if (saved.token != state_.token) throw Misuse("the state is of another FMU");
  if (saved.ready) {
    if (!saved.loop.empty() && (!loop_ || tuned_with_ != saved.at_rest)) {
      const auto at_rest = plant_with(saved.at_rest);
      loop_ = std::make_unique<Loop>(*at_rest, at_rest->machine().poses.back().X_BP);
      tuned_with_ = saved.at_rest;
    }
    if (!saved.loop.empty()) loop_->restore(saved.loop);
    if (built_with_ != saved.parameters) take(plant_with(saved.parameters), saved.parameters);
  }
  state_ = saved;
  forget();
}

}  // namespace hydrapod::fmu
