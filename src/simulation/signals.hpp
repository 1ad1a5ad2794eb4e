#pragma once
/// The signals behind CommandSpec. Private to the module.

#include "hydrapod/simulation/command.hpp"

namespace hydrapod::simulation {

/// w and dw/dt of a fade over `duration` that began `time` seconds ago.
struct Fade {
  double value{1.0}, rate{};
};
Fade fade_at(double time, double duration);

/// `signal` with the fade laid over it.
Displacement faded(const Displacement& signal, const Fade& fade);

std::unique_ptr<Signal> make_signal(const Step& spec, double sample_time);
std::unique_ptr<Signal> make_signal(const Sine& spec, double sample_time);
std::unique_ptr<Signal> make_signal(const Sweep& spec, double sample_time);
std::unique_ptr<Signal> make_signal(const Multisine& spec, double sample_time);
std::unique_ptr<Signal> make_signal(const Noise& spec, double sample_time);
std::unique_ptr<Signal> make_signal(const Trajectory& spec, double sample_time);

/// Throws std::invalid_argument `name is value, expected what` unless `sound`.
void require(bool sound, const char* name, double value, const std::string& expected);

/// Throws unless 0 ≤ from < to < half the sample rate (`from` > 0 where `from_zero` is false).
void require_band(const char* signal, double from, double to, double sample_time, bool from_zero);

}  // namespace hydrapod::simulation
