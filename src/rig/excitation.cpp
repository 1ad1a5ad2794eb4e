#include "hydrapod/rig/excitation.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "sources.hpp"

namespace hydrapod::rig {

namespace {

constexpr std::array<const char*, 6> directions{"x", "y", "z", "rx", "ry", "rz"};

std::string levels(const Vector6& rms) {
  std::string text;
  for (int i = 0; i < 6; ++i)
    if (rms[i] != 0.0)
      text += fmt::format("{}{} {:.6g}", text.empty() ? "" : ", ", directions[i], rms[i]);
  return text.empty() ? "at rest" : "RMS " + text;
}

std::string words(const WhiteNoise& s) { return "white noise, " + levels(s.rms); }
std::string words(const ShapedNoise& s) {
  return fmt::format("noise {:.6g} … {:.6g} Hz{}, {}", s.from, s.to,
                     s.slope == 0.0 ? "" : fmt::format(", {:+.3g} dB/octave", s.slope),
                     levels(s.rms));
}
std::string words(const Multisine& s) {
  return fmt::format("multisine {:.6g} … {:.6g} Hz, period {:.6g} s{}{}{}, {}", s.from, s.to,
                     s.period, s.slope == 0.0 ? "" : fmt::format(", {:+.3g} dB/octave", s.slope),
                     s.low_crest ? ", low crest factor" : "",
                     s.experiment ? fmt::format(", experiment {} of 6", *s.experiment + 1) : "",
                     levels(s.rms));
}
std::string words(const BinarySequence& s) {
  return fmt::format("binary sequence to {:.6g} Hz, {}", s.to, levels(s.rms));
}
std::string words(const SweptSine& s) {
  return fmt::format("swept sine {:.6g} … {:.6g} Hz, {:.6g} s per direction, {}", s.from, s.to,
                     s.duration, levels(s.rms));
}
std::string words(const Chirp& s) {
  return fmt::format("chirp {:.6g} … {:.6g} Hz, period {:.6g} s, {} turns, {}", s.from, s.to,
                     s.period, s.turns, levels(s.rms));
}

int active(const Vector6& rms) { return static_cast<int>((rms.array() != 0.0).count()); }

std::optional<long> period_of(const WhiteNoise& s, double) {
  if (active(s.rms) == 0) return 1;
  return {};
}
std::optional<long> period_of(const ShapedNoise& s, double) {
  if (active(s.rms) == 0) return 1;
  return {};
}
std::optional<long> period_of(const Multisine& s, double rate) {
  return whole_samples("multisine: period", s.period, rate);
}
std::optional<long> period_of(const BinarySequence& s, double rate) {
  return sequence_shape(s, rate).length();
}
std::optional<long> period_of(const SweptSine& s, double rate) {
  return whole_samples("swept sine: duration", s.duration, rate) * std::max(active(s.rms), 1);
}
std::optional<long> period_of(const Chirp& s, double rate) {
  return whole_samples("chirp: period", s.period, rate) * s.turns * std::max(active(s.rms), 1);
}

}  // namespace

std::string description(const SignalSpec& spec) {
  return std::visit([](const auto& s) { return words(s); }, spec);
}

std::optional<long> period_samples(const std::vector<SignalSpec>& specs, double rate) {
  long common = 1;
  for (const SignalSpec& spec : specs) {
    const auto period = std::visit([&](const auto& s) { return period_of(s, rate); }, spec);
    if (!period) return {};
    const long factor = *period / std::gcd(common, *period);
    if (common > longest_period / factor) return {};
    common *= factor;
  }
  return common;
}

Excitation::Excitation(const std::vector<SignalSpec>& specs, double rate, std::uint64_t seed)
    : rate_(rate) {
  require(rate > 0.0 && std::isfinite(rate), "excitation: sample rate", rate, "more than 0 Hz");
  std::uint64_t stream = 0;
  for (const SignalSpec& spec : specs) {
    sources_.push_back(std::visit(
        [&](const auto& s) {
          return make_source(s, {rate, seed, stream});
        },
        spec));
    stream += 16;  // more than there are directions
  }
}

void Excitation::restart() {
  for (const auto& source : sources_) source->restart();
}

Vector6 Excitation::next() {
  Vector6 sample = Vector6::Zero();
  for (const auto& source : sources_) source->add_next(sample);
  return sample;
}

void require(bool sound, const char* what, double value, const char* expected) {
  if (!sound)
    throw std::invalid_argument(fmt::format("{} is {:.6g}, expected {}", what, value, expected));
}

void require_levels(const char* signal, const Vector6& rms) {
  for (int i = 0; i < 6; ++i)
    if (!(rms[i] >= 0.0) || !std::isfinite(rms[i]))
      throw std::invalid_argument(fmt::format("{}: the level of {} is {}, expected 0 or more",
                                              signal, directions[i], rms[i]));
}

void require_band(const char* signal, double from, double to, double rate, bool from_zero) {
  const bool sound = (from_zero ? from >= 0.0 : from > 0.0) && from <= to && to < rate / 2.0;
  if (!sound)
    throw std::invalid_argument(fmt::format(
        "{}: the band is {:.6g} … {:.6g} Hz, expected {} from ≤ to < {:.6g} Hz, half the "
        "sample rate",
        signal, from, to, from_zero ? "0 ≤" : "0 <", rate / 2.0));
}

long whole_samples(const char* what, double seconds, double rate) {
  const double samples = std::round(seconds * rate);
  require(samples >= 2.0 && samples <= static_cast<double>(longest_period), what, seconds,
          "two to ten million samples, in seconds");
  return static_cast<long>(samples);
}

PeriodicSource::PeriodicSource(Eigen::Matrix<double, 6, Eigen::Dynamic> period)
    : period_(std::move(period)) {}

void PeriodicSource::add_next(Vector6& sample) {
  sample += period_.col(at_);
  at_ = (at_ + 1) % period_.cols();
}

}  // namespace hydrapod::rig
