/// Steps of co-simulation, and the instants of the controller.

#include <algorithm>
#include <cmath>

#include "instance.hpp"

namespace hydrapod::fmu {

namespace {

/// Two times that mean the same, relative to their size.
constexpr double time_tolerance = 1e-9;
double slack(double time) { return time_tolerance * std::max(1.0, std::abs(time)); }

/// Between two calls for intermediate values [s].
constexpr double part = 1e-3;

}  // namespace

void Instance::pass_loop() {
  if (!loop_ || !loop_->is_due(state_.time)) return;
  const auto wrench = input().wrench;
  loop_->pass(state_.time, *plant_, state_.x.data(), state_.inputs.data(), wrench);
  forget();
}

std::optional<double> Instance::update_discrete_states(bool of_exchange) {
  prepare_if_needed();
  if (!loop_ || !of_exchange) return std::nullopt;
  pass_loop();
  return loop_->next();
}

bool Instance::has_happened(const simulation::EventRecord& event, const double* x) const {
  std::vector<double> values(static_cast<std::size_t>(plant_->event_count()));
  plant_->events(x, values.data());
  const auto k = event.leg * simulation::Plant::events_per_leg + static_cast<int>(event.event);
  return (values[static_cast<std::size_t>(k)] < 0.0) == event.begins;
}

/// Halves the interval in which the event happens; the state after it is kept.
void Instance::stop_at(const simulation::EventRecord& event, double from,
                       const std::vector<double>& x) {
  double low = from, high = event.time;
  Eigen::VectorXd x_low = Eigen::Map<const Eigen::VectorXd>(x.data(), states_), x_high;
  const auto reach = [&](double time) {
    integrator_->start(low, x_low);
    integrator_->advance(time, input());
    return integrator_->state();
  };
  x_high = reach(high);
  while (high - low > slack(high)) {
    const double middle = 0.5 * (low + high);
    const Eigen::VectorXd between = reach(middle);
    const bool happened = has_happened(event, between.data());
    (happened ? high : low) = middle;
    (happened ? x_high : x_low) = between;
  }
  state_.x.assign(x_high.begin(), x_high.end());
  state_.time = high;
}

/// The integrator starts anew, so that what comes depends on nothing but the saved state.
void Instance::advance(double to, bool stops_at_events, StepResult& result) {
  const double from = state_.time;
  const auto x_before = state_.x;
  integrator_->start(from, Eigen::Map<const Eigen::VectorXd>(state_.x.data(), states_));
  try {
    integrator_->advance(to, input());
  } catch (const std::exception& error) {
    result.message = error.what();
    result.whole = false;
  }
  const auto& x = integrator_->state();
  state_.x.assign(x.begin(), x.end());
  state_.time = integrator_->time();
  forget();
  if (!stops_at_events) return;
  for (const auto& event : integrator_->events()) {
    const int k = event.leg * simulation::Plant::events_per_leg + static_cast<int>(event.event);
    if (std::ranges::count(interface_.indicators, k) == 0 ||
        event.event == simulation::Plant::Event::unguided)
      continue;
    const auto first = event;
    result = {.event = true};
    return stop_at(first, from, x_before);
  }
}

StepResult Instance::step(double from, double size, const StepOptions& options) {
  if (!(std::isfinite(from) && std::isfinite(size)) || size <= 0.0)
    throw Misuse("a step must be a time above 0 s");
  if (std::abs(from - state_.time) > slack(from))
    throw Misuse("the step begins at " + std::to_string(from) + " s, but the FMU is at " +
                 std::to_string(state_.time) + " s");
  double to = from + size;
  if (state_.has_stop && to > state_.stop + slack(state_.stop))
    throw Misuse("the step ends after the stop time");
  if (!integrator_ || integrator_tolerance_ != state_.tolerance) {
    integrator_ = std::make_unique<simulation::Integrator>(
        *plant_, simulation::IntegratorOptions{.relative_tolerance = state_.tolerance,
                                               .absolute_tolerance = state_.tolerance});
    integrator_tolerance_ = state_.tolerance;
  }
  state_.time = from;
  const double wanted = to;
  StepResult result;
  for (int parts = 1; state_.time < to; ++parts) {
    pass_loop();
    double next = options.between ? std::min(to, from + part * parts) : to;
    if (options.between && to - next < slack(to)) next = to;
    if (loop_ && loop_->next() < next - slack(next)) next = loop_->next();
    if (next <= state_.time) continue;
    advance(next, options.stops_at_events, result);
    if (!result.whole || result.event) break;
    if (!options.between) continue;
    if (const auto end = options.between(state_.time)) to = std::clamp(*end, state_.time, wanted);
  }
  result.early = state_.time < wanted - slack(wanted);
  return result;
}

}  // namespace hydrapod::fmu
