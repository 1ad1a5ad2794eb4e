#include "signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hydrapod::simulation {

namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

/// A signal that is a function of time.
template <typename Function>
class TimeSignal final : public Signal {
 public:
  TimeSignal(Function function, double sample_time)
      : function_(std::move(function)), sample_time_(sample_time) {}
  void restart() override { sample_ = 0; }
  Displacement next() override { return function_(sample_time_ * static_cast<double>(sample_++)); }

 private:
  Function function_;
  double sample_time_;
  long sample_{};
};

template <typename Function>
std::unique_ptr<Signal> of_time(Function function, double sample_time) {
  return std::make_unique<TimeSignal<Function>>(std::move(function), sample_time);
}

void require_time(const char* name, double value) {
  require(std::isfinite(value) && value >= 0.0, name, value, "0 s or more");
}

/// Phase [cycles] and frequency [Hz] of a sweep at `time`.
struct SweepPhase {
  double cycles{}, frequency{};
};
SweepPhase sweep_phase(const Sweep& sweep, double time) {
  const double ratio = sweep.to / sweep.from;
  if (!sweep.logarithmic || std::abs(ratio - 1.0) < 1e-9) {
    const double slope = (sweep.to - sweep.from) / sweep.duration;
    return {time * (sweep.from + 0.5 * slope * time), sweep.from + slope * time};
  }
  const double rate = std::log(ratio) / sweep.duration;
  const double frequency = sweep.from * std::exp(rate * time);
  return {(frequency - sweep.from) / rate, frequency};
}

}  // namespace

std::unique_ptr<Signal> make_signal(const Step& spec, double sample_time) {
  require_time("step: at", spec.at);
  require_time("step: rise", spec.rise);
  // A step that is due at a sample is there at that sample, whatever rounding says.
  const double slack = 1e-6 * sample_time;
  return of_time(
      [spec, slack](double time) {
        return faded({spec.size, Vector6::Zero()}, fade_at(time - spec.at + slack, spec.rise));
      },
      sample_time);
}

std::unique_ptr<Signal> make_signal(const Sine& spec, double sample_time) {
  require(
      std::isfinite(spec.frequency) && spec.frequency > 0.0 && spec.frequency < 0.5 / sample_time,
      "sine: frequency", spec.frequency,
      fmt::format("more than 0 and less than {:.6g} Hz, half the controller's sample rate",
                  0.5 / sample_time));
  require_time("sine: fade", spec.fade);
  return of_time(
      [spec](double time) {
        const double omega = two_pi * spec.frequency;
        return faded({spec.amplitude * std::sin(omega * time),
                      spec.amplitude * (omega * std::cos(omega * time))},
                     fade_at(time, spec.fade));
      },
      sample_time);
}

std::unique_ptr<Signal> make_signal(const Sweep& spec, double sample_time) {
  require_band("sweep", spec.from, spec.to, sample_time, false);
  require_time("sweep: fade", spec.fade);
  require(std::isfinite(spec.duration) && spec.duration > 0.0, "sweep: duration", spec.duration,
          "more than 0 s");
  return of_time(
      [spec](double time) -> Displacement {
        if (time >= spec.duration) return {};
        const auto [cycles, frequency] = sweep_phase(spec, time);
        const double phase = two_pi * (cycles - std::floor(cycles));
        const Displacement sine{spec.amplitude * std::sin(phase),
                                spec.amplitude * (two_pi * frequency * std::cos(phase))};
        const Fade out = fade_at(spec.duration - time, spec.fade);
        return faded(faded(sine, fade_at(time, spec.fade)), {out.value, -out.rate});
      },
      sample_time);
}

std::unique_ptr<Signal> make_signal(const Trajectory& spec, double sample_time) {
  require(!spec.times.empty() && spec.times.size() == spec.points.size(), "trajectory: points",
          static_cast<double>(spec.points.size()), "one for every time, and at least one");
  for (size_t k = 1; k < spec.times.size(); ++k)
    require(spec.times[k] > spec.times[k - 1], "trajectory: time", spec.times[k],
            "more than the one before");
  const auto slope = [spec](size_t k) -> Vector6 {
    const size_t last = spec.times.size() - 1;
    const auto secant = [&](size_t i) -> Vector6 {
      return (spec.points[i + 1] - spec.points[i]) / (spec.times[i + 1] - spec.times[i]);
    };
    if (k == 0 || k == last) return Vector6::Zero();  // at rest before and after
    const double before = spec.times[k] - spec.times[k - 1];
    const double after = spec.times[k + 1] - spec.times[k];
    return (after * secant(k - 1) + before * secant(k)) / (before + after);
  };
  return of_time(
      [spec, slope](double time) -> Displacement {
        const auto& times = spec.times;
        if (time <= times.front()) return {spec.points.front(), Vector6::Zero()};
        if (time >= times.back()) return {spec.points.back(), Vector6::Zero()};
        const auto k = static_cast<size_t>(std::upper_bound(times.begin(), times.end(), time) -
                                           times.begin()) -
                       1;
        const double h = times[k + 1] - times[k];
        const double r = (time - times[k]) / h;
        const Vector6 rise = spec.points[k + 1] - spec.points[k];
        const Vector6 m_0 = h * slope(k), m_1 = h * slope(k + 1);
        const Vector6 b = 3.0 * rise - 2.0 * m_0 - m_1, c = m_0 + m_1 - 2.0 * rise;
        return {spec.points[k] + r * (m_0 + r * (b + r * c)),
                (m_0 + r * (2.0 * b + 3.0 * r * c)) / h};
      },
      sample_time);
}

}  // namespace hydrapod::simulation
