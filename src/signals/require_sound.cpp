#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "hydrapod/spatial/pose.hpp"
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

/// Judges the parameters of one signal.
struct Check {
  std::string_view name;
  double rate;

  template <typename T>
  void operator()(const T& s) const {
    if constexpr (requires { s.at; }) require_time(of("at"), s.at);
    if constexpr (requires { s.rise; }) require_time(of("rise"), s.rise);
    if constexpr (requires { s.frequency; }) frequency("frequency", s.frequency);
    if constexpr (std::is_same_v<T, Sweep>) frequency("from", s.from);
    if constexpr (std::is_same_v<T, Sweep> || std::is_same_v<T, Binary>) frequency("to", s.to);
    if constexpr (requires { s.from; } && !std::is_same_v<T, Sweep>) band(s.from, s.to);
    if constexpr (requires { s.duration; }) period("duration", s.duration);
    if constexpr (requires { s.period; }) period("period", s.period);
    if constexpr (requires { s.slope; })
      require(std::abs(s.slope) <= 24.0, of("slope"), s.slope, "−24 … 24 dB/octave");
    if constexpr (requires { s.turns; })
      require(s.turns >= 0, of("turns"), s.turns, "0 (all directions together) or more");
    more(s);
  }

 private:
  [[nodiscard]] std::string of(const char* key) const { return fmt::format("{}: {}", name, key); }

  void frequency(const char* key, double value) const {
    require(value > 0.0 && value < rate / 2.0, of(key), value,
            fmt::format("more than 0 and less than {:.6g} Hz, half the sample rate", rate / 2.0));
  }
  /// [s] not much shorter.
  [[nodiscard]] double smooth_period(long samples) const {
    constexpr long small = 100;
    while (largest_prime_factor(samples) > small) --samples;
    return static_cast<double>(samples) / rate;
  }
  void band(double from, double to) const {
    if (!(from >= 0.0 && from <= to && to < rate / 2.0))
      throw std::invalid_argument(
          fmt::format("{}: the band is {:.6g} … {:.6g} Hz, expected 0 ≤ from ≤ to < {:.6g} Hz, "
                      "half the sample rate",
                      name, from, to, rate / 2.0));
  }
  void period(const char* key, double seconds) const {
    const double samples = std::round(seconds * rate);
    require(samples >= 2.0 && samples <= static_cast<double>(longest_period), of(key), seconds,
            "two to ten million samples, in seconds");
  }

  template <typename T>
  void more(const T& /*no more*/) const {}
  void more(const Multisine& s) const {
    constexpr long longest = 2'000'000;  // 192 MB for a period in six directions
    const long samples = whole_samples(s.period, rate);
    require(samples <= longest, of("period"), s.period, "at most two million samples, in seconds");
    const auto [first, last] = line_range(s, rate);
    require(last >= first, of("period"), s.period,
            "one so long that a multiple of 1/period lies in the band");
    const long lines = last - first + 1;
    // the search for phases transforms eight samples per cycle of the last line, 3600 times
    constexpr long most_cycles = 10'000;
    if (s.low_crest && last > most_cycles)
      throw std::invalid_argument(
          fmt::format("{}: crest=low of {} lines up to the {}th, expected none above the {}th: "
                      "take a shorter period, a lower band or crest=random",
                      name, lines, last, most_cycles));
    // such a period is not transformed but summed up, see Synthesis
    constexpr long most_products = 4'000'000'000;
    if (largest_prime_factor(samples) >= std::max(1000L, lines) && lines > most_products / samples)
      throw std::invalid_argument(fmt::format(
          "{}: the period has {} samples, a multiple of the prime number {}, and {} lines, which "
          "takes too long: expected a multiple of small prime numbers, for instance {:.9g} s",
          name, samples, largest_prime_factor(samples), lines, smooth_period(samples)));
    const int experiment = s.experiment.value_or(1);
    require(experiment >= 1 && experiment <= 6, of("experiment"), experiment, "1 … 6");
  }
  void more(const Noise& s) const { require(s.from < s.to, of("from"), s.from, "less than `to`"); }
  void more(const Binary& s) const {
    require(sequence_shape(s, rate).length() <= longest_period, of("period"), s.period,
            "at most ten million samples, in seconds");
  }
  void more(const Trajectory& s) const {
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
  std::visit(Check{kinds[signal.form.index()], rate}, signal.form);
}

}  // namespace hydrapod::signals
