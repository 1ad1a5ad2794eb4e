#include "loop.hpp"

#include <algorithm>

#include "hydrapod/base/error.hpp"
#include "hydrapod/simulation/closed_loop.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "simulation/true_measurement.hpp"

namespace hydrapod::fmu {

namespace {

constexpr double coincidence = 1e-6;  // of a sample time, as in simulation::ClosedLoop

/// Numbers in a fixed order: written by a sink that appends, read by one that takes.
template <class State, class Sink>
void visit(State& state, const Sink& sink) {
  for (int i = 0; i < 9; ++i) sink(state.X_BP.R_BP(i / 3, i % 3));
  for (int i = 0; i < 3; ++i) sink(state.X_BP.p_BP[i]);
  for (auto* six : {&state.error, &state.integral, &state.slow_force, &state.slow_acceleration,
                    &state.wanted_speed})
    for (int i = 0; i < 6; ++i) sink((*six)[i]);
}

}  // namespace

Loop::Loop(const simulation::Plant& plant, const spatial::Pose& operating)
    : operating_(operating),
      controller_(plant.machine(),
                  simulation::tune_controller(plant.machine(), operating).parameters),
      slack_(coincidence * controller_.parameters().sample_time) {}

void Loop::start(double time, const simulation::Plant& plant, const simulation::Plant::Rest& rest) {
  start_ = time;
  ticks_ = 0.0;
  pending_.clear();
  applied_ = rest.input.command;
  controller_.reset(operating_, simulation::true_measurement(plant, rest.x.data(), rest.input,
                                                             controller_.parameters().feedback));
  controller_.take_over(rest.input.command);
}

double Loop::next() const {
  return pending_.empty() ? tick_time() : std::min(tick_time(), pending_.front().time);
}

void Loop::apply_due(double time) {
  while (!pending_.empty() && pending_.front().time <= time + slack_) {
    applied_ = pending_.front().drives;
    pending_.pop_front();
  }
}

void Loop::pass(double time, const simulation::Plant& plant, const double* x,
                const double* commands, const Vector6& wrench) {
  apply_due(time);
  if (tick_time() > time + slack_) return;
  const auto& parameters = controller_.parameters();
  const signals::Sample wanted{.value = Eigen::Map<const Vector6>(commands),
                               .rate = Eigen::Map<const Vector6>(commands + 6)};
  const auto measured = simulation::true_measurement(
      plant, x, {.command = applied_, .wrench = wrench}, parameters.feedback);
  const Vector6 asked = controller_.step(measured, simulation::command_at(operating_, wanted));
  if (controller_.state().forward != kinematics::ForwardStatus::converged)
    throw base::ComputationError(
        "the controller finds no pose for the leg lengths: the platform has reached a singular "
        "pose");
  const double limit = parameters.output.limit;
  pending_.push_back(
      {tick_time() + parameters.delay * sample_time(), asked.cwiseMax(-limit).cwiseMin(limit)});
  ticks_ += 1.0;
  apply_due(time);
}

namespace {

constexpr std::size_t of_pending = 7;
/// start, ticks, drives, the controller's pose, its five lists of six, limits, status.
constexpr std::size_t of_fixed_place = 2 + 6 + 12 + 30 + 6 + 1;

}  // namespace

bool Loop::fits(std::size_t count) {
  return count >= of_fixed_place && (count - of_fixed_place) % of_pending == 0;
}

std::vector<double> Loop::save() const {
  std::vector<double> numbers{start_, ticks_};
  const auto append = [&](double number) { numbers.push_back(number); };
  std::ranges::for_each(applied_, append);
  visit(controller_.state(), append);
  for (const bool limited : controller_.state().limited) append(limited ? 1.0 : 0.0);
  append(static_cast<double>(controller_.state().forward));
  for (const auto& one : pending_) {
    append(one.time);
    std::ranges::for_each(one.drives, append);
  }
  return numbers;
}

void Loop::restore(const std::vector<double>& numbers) {
  std::size_t at = 0;
  const auto take = [&](double& number) { number = numbers.at(at++); };
  take(start_);
  take(ticks_);
  std::ranges::for_each(applied_, take);
  control::ControllerState state;
  visit(state, take);
  for (bool& limited : state.limited) limited = numbers.at(at++) != 0.0;
  state.forward = static_cast<kinematics::ForwardStatus>(static_cast<int>(numbers.at(at++)));
  // A controller does not take a state from outside; this object is not const.
  const_cast<control::ControllerState&>(controller_.state()) = state;
  pending_.clear();
  while (at < numbers.size()) {
    Pending one;
    take(one.time);
    std::ranges::for_each(one.drives, take);
    pending_.push_back(one);
  }
}

}  // namespace hydrapod::fmu
