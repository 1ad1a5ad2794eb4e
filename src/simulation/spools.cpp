#include "spools.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace hydrapod::simulation {

namespace {

using numerics::gather;
using numerics::Lanes;

struct ValueAndSlope {
  double value{}, slope{};
};

/// Where `function` passes from below zero at 0 to above zero at `high`, to rounding: Newton's
/// method, halving the bracket where that leaves it.
template <class Function>
double passing(double high, Function function) {
  constexpr int most_steps = 100;  // halvings alone need 53
  constexpr double rounding = 4.0 * std::numeric_limits<double>::epsilon();
  double below = 0.0, above = high, at = high;
  for (int k = 0; k < most_steps; ++k) {
    const auto [value, slope] = function(at);
    (value > 0.0 ? above : below) = at;
    double next = at - value / slope;
    if (!(next > below && next < above)) next = 0.5 * (below + above);
    const double step = std::abs(next - at);
    at = next;
    if (step <= rounding * high) break;
  }
  return at;
}

}  // namespace

SpoolLaw::SpoolLaw(const hydraulics::Valve& valve)
    : omega_(valve.natural_frequency),
      zeta_(valve.damping_ratio),
      limit_(valve.rate_limit),
      e_limit_(2.0 * zeta_ * limit_ / omega_) {}

SpoolTransition<double> SpoolLaw::transition(double time) const {
  const double decay = zeta_ * omega_;
  const double beta = omega_ * std::sqrt(std::abs(1.0 - zeta_ * zeta_));
  double C = 0.0, S = 0.0;  // times exp(−ζωt)
  if (zeta_ < 1.0) {
    const double falling = std::exp(-decay * time);
    C = falling * std::cos(beta * time);
    S = falling * std::sin(beta * time) / beta;
  } else {
    const double slow = std::exp((beta - decay) * time);
    const double less = -std::expm1(-2.0 * beta * time);  // of the slow part than of the fast one
    C = slow * (1.0 - 0.5 * less);
    S = slow * (beta > 0.0 ? 0.5 * less / beta : time);
  }
  return {C + decay * S, S, -omega_ * omega_ * S, C - decay * S};
}

SpoolMotion SpoolLaw::within(SpoolMotion from, double u, double time) const {
  const auto by = transition(time);
  const double e = from.x - u;
  return {u + by.e_e * e + by.e_rate * from.rate, by.rate_e * e + by.rate_rate * from.rate};
}

/// `toward`: the rate that it tends to, ±L.
SpoolMotion SpoolLaw::limited(SpoolMotion from, double toward, double time) const {
  const double decay = 2.0 * zeta_ * omega_, excess = from.rate - toward;
  const double lost = -std::expm1(-decay * time);
  return {from.x + toward * time + excess * lost / decay, from.rate - excess * lost};
}

/// When the rate of a spool within the limit is zero for the first time after now; infinite where
/// it never is. With q = ζω ẋ + ω² e the rate is proportional to C ẋ − S q.
double SpoolLaw::turning(double e, double rate) const {
  constexpr double never = std::numeric_limits<double>::infinity();
  const double q = omega_ * (zeta_ * rate + omega_ * e);
  const double beta = omega_ * std::sqrt(std::abs(1.0 - zeta_ * zeta_));
  if (zeta_ < 1.0) {
    const double angle = std::atan2(beta * std::abs(rate), rate < 0.0 ? -q : q);
    return (angle > 0.0 ? angle : M_PI) / beta;
  }
  const double ratio = rate / q;
  if (!(ratio > 0.0 && beta * ratio < 1.0)) return never;
  return beta > 0.0 ? std::atanh(beta * ratio) / beta : ratio;
}

/// (ω e)² + ẋ² never grows within the limit.
bool SpoolLaw::may_be_limited(double e, double rate) const {
  const double pull = omega_ * e, limit = omega_ * e_limit_;
  return !(pull * pull + rate * rate <= limit * limit);
}

/// How long the spool stays within the limit, at most `time`. e is monotone up to the first
/// turning; where it is within the limit there, it stays so.
double SpoolLaw::lasts_within(SpoolMotion from, double u, double time) const {
  if (!may_be_limited(from.x - u, from.rate)) return time;
  const double end = std::min(time, turning(from.x - u, from.rate));
  const double e = within(from, u, end).x - u;
  if (!(std::abs(e) > e_limit_)) return time;
  const double side = e > 0.0 ? 1.0 : -1.0;
  return passing(end, [&](double t) -> ValueAndSlope {
    const auto at = within(from, u, t);
    return {side * (at.x - u) - e_limit_, side * at.rate};
  });
}

/// How long the rate is limited, at most `time`.
double SpoolLaw::lasts_limited(SpoolMotion from, double u, double time) const {
  const double side = from.x > u ? 1.0 : -1.0;
  const auto inside = [&](double t) -> ValueAndSlope {
    const auto at = limited(from, -side * limit_, t);
    return {e_limit_ - side * (at.x - u), -side * at.rate};
  };
  return inside(time).value > 0.0 ? passing(time, inside) : time;
}

SpoolMotion SpoolLaw::after(SpoolMotion from, double u, double time) const {
  constexpr double shortest = 1e-13;  // of the time: pieces that are lost in rounding
  const double least = shortest * time;
  bool beyond = std::abs(from.x - u) > e_limit_;
  while (time > 0.0) {
    const double found = beyond ? lasts_limited(from, u, time) : lasts_within(from, u, time);
    const double lasts = std::min(time, std::max(found, least));
    from = beyond ? limited(from, from.x > u ? -limit_ : limit_, lasts) : within(from, u, lasts);
    time -= lasts;
    beyond = !beyond;
  }
  return from;
}

Spools::Spools(const Plant& plant, std::vector<double> shares)
    : first_(plant.layout().spools), shares_(std::move(shares)) {
  if (shares_.size() > most_shares) throw std::invalid_argument("Spools: too many shares");
  for (int i = 0; i < model::leg_count; ++i) laws_.emplace_back(plant.axis(i).valve);
  const auto omega = gather([&](int i) { return plant.axis(i).valve.natural_frequency; });
  stiffness_ = omega * omega;
  damping_ = 2.0 * omega * gather([&](int i) { return plant.axis(i).valve.damping_ratio; });
}

void Spools::set_transitions(double step) {
  step_ = step;
  for (std::size_t k = 0; k < shares_.size(); ++k) {
    if (k > 0 && shares_[k] == shares_[k - 1]) {
      transitions_[k] = transitions_[k - 1];
      continue;
    }
    const double time = step * shares_[k];
    const auto first = laws_.front().transition(time);
    transitions_[k] = {first.e_e, first.e_rate, first.rate_e, first.rate_rate};
    for (int i = 1; i < model::leg_count; ++i) {
      const auto& law = laws_[static_cast<std::size_t>(i)];
      if (law == laws_.front()) continue;  // most machines have one kind of valve
      const auto one = law.transition(time);
      transitions_[k].e_e.set(i, one.e_e);
      transitions_[k].e_rate.set(i, one.e_rate);
      transitions_[k].rate_e.set(i, one.rate_e);
      transitions_[k].rate_rate.set(i, one.rate_rate);
    }
  }
}

void Spools::begin(const double* x, const Vector6& command, double step) {
  if (first_ < 0) return;
  // Steps that are meant to be equal differ by the rounding of the time, which is small to the
  // second order.
  constexpr double nearly = 1e-8;
  if (!(std::abs(step - step_) <= nearly * step)) set_transitions(step);
  const double beyond = step - step_;
  const Lanes u = gather([&](int i) { return std::clamp(command[i], -1.0, 1.0); });
  const Lanes e = gather([&](int i) { return x[first_ + 2 * i]; }) - u;
  const Lanes rate = gather([&](int i) { return x[first_ + 2 * i + 1]; });
  for (std::size_t k = 0; k < shares_.size(); ++k) {
    const auto& by = transitions_[k];
    const Lanes e_there = by.e_e * e + by.e_rate * rate;
    const Lanes rate_there = by.rate_e * e + by.rate_rate * rate;
    const Lanes later = beyond * shares_[k];
    position_[k] = u + e_there + later * rate_there;
    rate_[k] = rate_there - later * (stiffness_ * e_there + damping_ * rate_there);
  }
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& law = laws_[static_cast<std::size_t>(i)];
    if (!law.may_be_limited(e[i], rate[i])) continue;
    SpoolMotion at{u[i] + e[i], rate[i]};
    double before = 0.0;
    for (std::size_t k = 0; k < shares_.size(); ++k) {
      at = law.after(at, u[i], step * (shares_[k] - before));
      before = shares_[k];
      position_[k].set(i, at.x);
      rate_[k].set(i, at.rate);
    }
  }
}

void Spools::place(std::size_t k, double* x) const {
  if (first_ < 0) return;
  for (int i = 0; i < model::leg_count; ++i) {
    x[first_ + 2 * i] = position_[k][i];
    x[first_ + 2 * i + 1] = rate_[k][i];
  }
}

}  // namespace hydrapod::simulation
