/// Sweeps and chirps.

#include <algorithm>
#include <cmath>

#include "hydrapod/base/units.hpp"
#include "sources.hpp"

namespace hydrapod::signals {

namespace {

using base::two_pi;

/// A wave and its derivative.
struct Wave {
  double value{}, rate{};
};

Wave sine_wave(double cycles, double frequency) {
  const double phase = two_pi * cycles;
  return {std::sin(phase), two_pi * frequency * std::cos(phase)};
}

/// How the directions share passes of one wave.
struct Passes {
  long length{};  ///< [samples]
  int turns{};    ///< of one direction before the next; 0: all together
  bool once{};    ///< together: rests after the first pass
};

/// Passes of `wave`, a function of the sample's number within the pass.
template <typename Function>
Source passes_source(Vector6 size, bool rms, const Passes& passes, const Function& wave) {
  if (rms) {
    double squares = 0.0;
    for (long k = 0; k < passes.length; ++k) squares += wave(k).value * wave(k).value;
    size *= std::sqrt(static_cast<double>(passes.length) / squares);
  }
  std::vector<int> directions;
  for (int i = 0; i < 6; ++i)
    if (size[i] != 0.0) directions.push_back(i);
  return [=](long k) -> Sample {
    const long pass = k / passes.length;
    if (directions.empty() || (passes.once && pass > 0)) return {};
    const Wave now = wave(k % passes.length);
    if (passes.turns == 0) return {now.value * size, now.rate * size};
    const int i = directions[static_cast<std::size_t>(pass / passes.turns) % directions.size()];
    return {size[i] * now.value * Vector6::Unit(i), size[i] * now.rate * Vector6::Unit(i)};
  };
}

}  // namespace

Source make_source(const Sweep& sweep, const Context& context) {
  const long length = whole_samples(sweep.duration, context.rate);
  const double duration = static_cast<double>(length) / context.rate;
  const double ratio = std::log(sweep.to / sweep.from);
  const auto wave = [=, rate = context.rate, fade = context.fade](long k) -> Wave {
    const double t = static_cast<double>(k) / rate;
    Wave sine;
    if (sweep.logarithmic && std::abs(ratio) > 1e-9) {
      const double octaves = ratio * t / duration;  // natural
      sine = sine_wave(sweep.from * duration / ratio * std::expm1(octaves),
                       sweep.from * std::exp(octaves));
    } else {
      const double slope = (sweep.to - sweep.from) / duration;
      sine = sine_wave(t * (sweep.from + 0.5 * slope * t), sweep.from + slope * t);
    }
    const Fade in = fade_at(t, fade), out = fade_at(duration - t, fade);
    const double envelope = in.value * out.value;
    return {envelope * sine.value,
            envelope * sine.rate + (in.rate * out.value - in.value * out.rate) * sine.value};
  };
  return passes_source(context.size, sweep.rms, {length, sweep.turns, sweep.turns == 0}, wave);
}

Source make_source(const Chirp& chirp, const Context& context) {
  const long length = whole_samples(chirp.period, context.rate);
  const double period = static_cast<double>(length) / context.rate;
  // whole cycles per period, so that it repeats without a break
  const double cycles = std::max(1.0, std::round(0.5 * (chirp.from + chirp.to) * period));
  const double rise = 2.0 * (cycles / period - chirp.from);
  const auto wave = [=, rate = context.rate](long k) {
    const double t = static_cast<double>(k) / rate;
    return sine_wave(chirp.from * t + 0.5 * rise * t * t / period, chirp.from + rise * t / period);
  };
  return passes_source(context.size, chirp.rms, {length, chirp.turns}, wave);
}

}  // namespace hydrapod::signals
