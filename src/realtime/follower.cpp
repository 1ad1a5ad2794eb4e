#include "follower.hpp"

#include <algorithm>

namespace hydrapod::realtime {

Share smooth_share(double tau) {
  const double t = std::clamp(tau, 0.0, 1.0), back = 1.0 - t;
  return {t * t * t * (10.0 + t * (6.0 * t - 15.0)), 30.0 * t * t * back * back};
}

signals::Sample Ramp::at(double time) const {
  const Share share = smooth_share((time - begin) / duration);
  return {.value = from + share.value * (to - from), .rate = share.rate / duration * (to - from)};
}

void Follower::follow(const Command& command, double time) {
  command_ = command;
  taken_ = time;
  state_ = State::following;
}

void Follower::ramp_down(double time, const Vector6& actual) {
  if (!followed()) return;
  ramp_ = {valves() ? actual : command_.displacement, rest_, time, times_.ramp};
  state_ = State::ramping;
}

void Follower::go_on(double time, const Vector6& actual, Counters& counters) {
  constexpr double rounding = 1e-9;  // [s]
  if (followed()) {
    ++counters.missed;
    state_ = State::holding;
    if (age(time) > times_.hold + rounding) {
      ++counters.trips;
      ramp_down(time, actual);
    }
  } else if (state_ == State::ramping && ramp_.over(time)) {
    state_ = State::parked;
  }
}

void Follower::fill(double time, simulation::Excitation& excitation) const {
  if (state_ == State::waiting) return;
  if (!followed()) {
    excitation.command = ramp_.at(time);
    return;
  }
  if (valves()) {
    excitation.outside = command_.drive;
  } else {
    excitation.command.value = command_.displacement;
    if (state_ == State::following) excitation.command.rate = command_.rate;
    excitation.drive = command_.drive;
  }
  excitation.wrench = command_.wrench;
  if ((command_.flags & next_wrench_given) != 0)
    excitation.next_wrench = state_ == State::following ? command_.next_wrench : command_.wrench;
}

}  // namespace hydrapod::realtime
