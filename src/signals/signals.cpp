#include "hydrapod/signals/signals.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hydrapod/base/units.hpp"
#include "sources.hpp"

namespace hydrapod::signals {

namespace {

using base::two_pi;

template <typename T>
constexpr bool fades_itself =
    std::is_same_v<T, Step> || std::is_same_v<T, Sweep> || std::is_same_v<T, Trajectory>;

Source source_of(const Signal& signal, const Context& context) {
  return std::visit(
      [&]<typename T>(const T& form) -> Source {
        Source source = make_source(form, context);
        if (fades_itself<T>) return source;
        return [source = std::move(source), fade = context.fade, rate = context.rate](long k) {
          return faded(source(k), fade_at(static_cast<double>(k) / rate, fade));
        };
      },
      signal.form);
}

/// Samples after which one signal repeats.
struct Period {
  const Signal& signal;
  double rate;

  [[nodiscard]] int active() const { return std::max(active_directions(signal.size), 1); }

  std::optional<long> operator()(const Sine& s) const {
    for (long cycles = 1; cycles <= 1000; ++cycles) {
      const double samples = static_cast<double>(cycles) * rate / s.frequency;
      if (std::abs(samples - std::round(samples)) < 1e-9 * samples) return std::lround(samples);
    }
    return {};
  }
  std::optional<long> operator()(const Sweep& s) const {
    if (s.turns == 0) return {};
    return whole_samples(s.duration, rate) * s.turns * active();
  }
  std::optional<long> operator()(const Chirp& s) const {
    return whole_samples(s.period, rate) * (s.turns == 0 ? 1 : s.turns * active());
  }
  std::optional<long> operator()(const Multisine& s) const { return whole_samples(s.period, rate); }
  std::optional<long> operator()(const Binary& s) const { return sequence_shape(s, rate).length(); }
  template <typename T>
  std::optional<long> operator()(const T& /*does not repeat*/) const {
    return {};
  }
};

struct Duration {
  const Signal& signal;

  [[nodiscard]] double passes(int turns) const { return turns * active_directions(signal.size); }

  double operator()(const Step& s) const { return s.at + s.rise + 4.0; }
  double operator()(const Sine& s) const { return std::max(signal.fade + 5.0 / s.frequency, 5.0); }
  double operator()(const Sweep& s) const {
    return s.duration * std::max(passes(s.turns), 1.0) + 1.0;
  }
  double operator()(const Chirp& s) const {
    return signal.fade + s.period * std::max(passes(s.turns), 2.0);
  }
  double operator()(const Multisine& s) const { return signal.fade + 2.0 * s.period; }
  double operator()(const White& /*endless*/) const { return 10.0; }
  double operator()(const Noise& /*endless*/) const { return 10.0; }
  double operator()(const Binary& s) const { return signal.fade + 2.0 * s.period; }
  double operator()(const Trajectory& s) const { return s.times.back() + 1.0; }
};

}  // namespace

Generator::Generator(const std::vector<Signal>& signals, double rate, std::uint64_t seed) {
  std::uint64_t stream = 0;
  for (const Signal& signal : signals) {
    require_sound(signal, rate);
    // With a seed of its own a signal is the same at every place of the list.
    sources_.push_back(source_of(signal, {signal.size, signal.fade, rate,
                                          signal.seed.value_or(seed), signal.seed ? 0 : stream}));
    stream += 16;  // more than there are directions
  }
}

Sample Generator::next() {
  Sample sum;
  for (const auto& source : sources_) {
    const Sample one = source(at_);
    sum.value += one.value;
    sum.rate += one.rate;
  }
  ++at_;
  return sum;
}

std::optional<long> period_samples(const std::vector<Signal>& signals, double rate) {
  long common = 1;
  for (const Signal& signal : signals) {
    if (active_directions(signal.size) == 0 && !std::holds_alternative<Trajectory>(signal.form))
      continue;
    const auto period = std::visit(Period{signal, rate}, signal.form);
    if (!period) return {};
    const long factor = *period / std::gcd(common, *period);
    if (common > longest_period / factor) return {};
    common *= factor;
  }
  return common;
}

double natural_duration(const std::vector<Signal>& signals) {
  double longest = 2.0;
  for (const Signal& signal : signals)
    longest = std::max(longest, std::visit(Duration{signal}, signal.form));
  return longest;
}

Fade fade_at(double time, double duration) {
  if (duration <= 0.0 || time >= duration) return {time >= 0.0 ? 1.0 : 0.0, 0.0};
  if (time <= 0.0) return {0.0, 0.0};
  const double r = time / duration;
  return {r * r * r * (10.0 - 15.0 * r + 6.0 * r * r),
          30.0 * r * r * (1.0 - r) * (1.0 - r) / duration};
}

Sample faded(const Sample& sample, const Fade& fade) {
  return {fade.value * sample.value, fade.value * sample.rate + fade.rate * sample.value};
}

long whole_samples(double seconds, double rate) { return std::lround(seconds * rate); }

int active_directions(const Vector6& size) {
  return static_cast<int>((size.array() != 0.0).count());
}

Source make_source(const Step& step, const Context& context) {
  // A step that is due at a sample is there at that sample, whatever rounding says.
  const double slack = 1e-6 / context.rate;
  return [step, context, slack](long k) {
    const double time = static_cast<double>(k) / context.rate;
    return faded({context.size, Vector6::Zero()}, fade_at(time - step.at + slack, step.rise));
  };
}

Source make_source(const Sine& sine, const Context& context) {
  const Vector6 amplitude = (sine.rms ? std::sqrt(2.0) : 1.0) * context.size;
  const double omega = two_pi * sine.frequency;
  return [amplitude, omega, rate = context.rate](long k) -> Sample {
    const double phase = omega * static_cast<double>(k) / rate;
    return {amplitude * std::sin(phase), amplitude * (omega * std::cos(phase))};
  };
}

}  // namespace hydrapod::signals
