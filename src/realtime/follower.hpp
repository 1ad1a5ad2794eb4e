#pragma once
/// What the machine does with commands, and without: hold, ramp down, rest. Private to the module.

#include "hydrapod/realtime/realtime.hpp"

namespace hydrapod::realtime {

/// A displacement that goes smoothly from one place to another: 10 τ³ − 15 τ⁴ + 6 τ⁵.
struct Ramp {
  Vector6 from{Vector6::Zero()}, to{Vector6::Zero()};
  double begin{}, duration{1.0};
  [[nodiscard]] signals::Sample at(double time) const;
  [[nodiscard]] bool over(double time) const { return time >= begin + duration; }
};
/// Its share of the way at τ in [0, 1], and dτ of it.
struct Share {
  double value{}, rate{};
};
Share smooth_share(double tau);

class Follower {
 public:
  struct Times {
    double hold{}, ramp{};
  };
  Follower(const Times& times, const Vector6& rest) : times_(times), rest_(rest) {}

  /// A new command at this sample.
  void follow(const Command& command, double time);
  /// A sample without a new one; `actual` is the platform's displacement. Counts `missed` and
  /// `trips`.
  void go_on(double time, const Vector6& actual, Counters& counters);
  /// The client has gone, whatever the time.
  void ramp_down(double time, const Vector6& actual);

  /// The excitation of this sample.
  void fill(double time, simulation::Excitation& excitation) const;
  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] bool followed() const {
    return state_ == State::following || state_ == State::holding;
  }
  /// Of the command that acts [s].
  [[nodiscard]] double age(double time) const { return time - taken_; }

 private:
  [[nodiscard]] bool valves() const {
    return command_.mode == static_cast<std::uint64_t>(Mode::valves);
  }

  Times times_;
  Vector6 rest_;
  State state_{State::waiting};
  Command command_{};
  double taken_{};
  Ramp ramp_{};
};

}  // namespace hydrapod::realtime
