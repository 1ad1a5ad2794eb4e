#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "hydrapod/spatial/directions.hpp"
#include "sources.hpp"

namespace hydrapod::signals {

namespace {

/// Throws "WHAT is VALUE, expected EXPECTED" unless `sound`.
void require(bool sound, const std::string& what, double value, const std::string& expected) {
  if (!sound)
    throw std::invalid_argument(fmt::format("{} is {:.6g}, expected {}", what, value, expected));
}

void require_time(const std::string& what, double value) {
  require(std::isfinite(value) && value >= 0.0, what, value, "0 s or more");
}

void require_period(const std::string& what, double seconds, double rate) {
  const double samples = std::round(seconds * rate);
  require(samples >= 2.0 && samples <= static_cast<double>(longest_period), what, seconds,
          "two to ten million samples, in seconds");
}

void require_band(const std::string& signal, double from, double to, double rate) {
  if (!(from >= 0.0 && from <= to && to < rate / 2.0))
    throw std::invalid_argument(
        fmt::format("{}: the band is {:.6g} … {:.6g} Hz, expected 0 ≤ from ≤ to < {:.6g} Hz, half "
                    "the sample rate",
                    signal, from, to, rate / 2.0));
}

void require_frequency(const std::string& what, double frequency, double rate) {
  require(
      frequency > 0.0 && frequency < rate / 2.0, what, frequency,
      fmt::format("more than 0 and less than {:.6g} Hz, half the sample rate", rate / 2.0));
}

void require_slope(const std::string& what, double slope) {
  require(std::abs(slope) <= 24.0, what, slope, "−24 … 24 dB/octave");
}

void require_turns(const std::string& what, int turns) {
  require(turns >= 0, what, turns, "0 (all directions together) or more");
}

struct Check {
  double rate;

  void operator()(const Step& s) const {
    require_time("step: at", s.at);
    require_time("step: rise", s.rise);
  }
  void operator()(const Sine& s) const { require_frequency("sine: frequency", s.frequency, rate); }
  void operator()(const Sweep& s) const {
    require_frequency("sweep: from", s.from, rate);
    require_frequency("sweep: to", s.to, rate);
    require_period("sweep: duration", s.duration, rate);
    require_turns("sweep: turns", s.turns);
  }
  void operator()(const Chirp& s) const {
    require_band("chirp", s.from, s.to, rate);
    require_period("chirp: period", s.period, rate);
    require_turns("chirp: turns", s.turns);
  }
  void operator()(const Multisine& s) const {
    require_band("multisine", s.from, s.to, rate);
    require_period("multisine: period", s.period, rate);
    const auto [first, last] = line_range(s, rate);
    require(last >= first, "multisine: period", s.period,
            "one so long that a multiple of 1/period lies in the band");
    require_slope("multisine: slope", s.slope);
    const int experiment = s.experiment.value_or(1);
    require(experiment >= 1 && experiment <= 6, "multisine: experiment", experiment, "1 … 6");
  }
  void operator()(const White& /*anything goes*/) const {}
  void operator()(const Noise& s) const {
    require_band("noise", s.from, s.to, rate);
    require(s.from < s.to, "noise: from", s.from, "less than `to`");
    require_slope("noise: slope", s.slope);
  }
  void operator()(const Binary& s) const {
    require_frequency("binary sequence: to", s.to, rate);
    require_period("binary sequence: period", s.period, rate);
    require(sequence_shape(s, rate).length() <= longest_period, "binary sequence: period", s.period,
            "at most ten million samples, in seconds");
  }
  void operator()(const Trajectory& s) const {
    require(!s.times.empty() && s.times.size() == s.points.size(), "trajectory: points",
            static_cast<double>(s.points.size()), "one for every time, and at least one");
    for (std::size_t k = 1; k < s.times.size(); ++k)
      require(s.times[k] > s.times[k - 1], "trajectory: time", s.times[k],
              "more than the one before");
  }
};

}  // namespace

std::pair<long, long> line_range(const Multisine& multisine, double rate) {
  const long samples = whole_samples(multisine.period, rate);
  const double base = rate / static_cast<double>(samples);
  constexpr double slack = 1e-6;  // bands that end on a line include it
  const auto first = static_cast<long>(std::ceil(multisine.from / base - slack));
  const auto last = static_cast<long>(std::floor(multisine.to / base + slack));
  return {std::max(1L, first), std::min(last, (samples - 1) / 2)};
}

void require_sound(const Signal& signal, double rate) {
  require(rate > 0.0 && std::isfinite(rate), "sample rate", rate, "more than 0 Hz");
  for (int i = 0; i < 6; ++i)
    require(std::isfinite(signal.size[i]), fmt::format("size of {}", spatial::direction_name(i)),
            signal.size[i], "a finite number");
  require_time("fade", signal.fade);
  std::visit(Check{rate}, signal.form);
}

}  // namespace hydrapod::signals
