/// Binary sequences, swept sines and chirps.

#include <array>
#include <cmath>
#include <numbers>

#include "sources.hpp"

namespace hydrapod::rig {

namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

/// Feedback taps of shift registers of 2 … 20 bits with the longest period (XOR of these bits, from
/// 1): primitive polynomials over GF(2).
constexpr std::array<std::array<int, 4>, 21> taps{{{},
                                                   {},
                                                   {2, 1},
                                                   {3, 2},
                                                   {4, 3},
                                                   {5, 3},
                                                   {6, 5},
                                                   {7, 6},
                                                   {8, 6, 5, 4},
                                                   {9, 5},
                                                   {10, 7},
                                                   {11, 9},
                                                   {12, 11, 10, 4},
                                                   {13, 12, 11, 8},
                                                   {14, 13, 12, 2},
                                                   {15, 14},
                                                   {16, 15, 13, 4},
                                                   {17, 14},
                                                   {18, 11},
                                                   {19, 18, 17, 14},
                                                   {20, 17}}};

std::vector<double> maximum_length_sequence(int bits, std::uint64_t seed) {
  const std::uint32_t all = (1U << bits) - 1U;
  std::uint32_t state = static_cast<std::uint32_t>(seed * 2654435761U) & all;
  if (state == 0) state = 1;
  std::vector<double> sequence(all);
  for (double& value : sequence) {
    std::uint32_t feedback = 0;
    for (const int tap : taps[static_cast<std::size_t>(bits)])
      if (tap > 0) feedback ^= state >> (tap - 1);
    value = (state & 1U) != 0 ? 1.0 : -1.0;
    state = ((state << 1U) | (feedback & 1U)) & all;
  }
  return sequence;
}

std::vector<int> active_directions(const Vector6& rms) {
  std::vector<int> list;
  for (int i = 0; i < 6; ++i)
    if (rms[i] != 0.0) list.push_back(i);
  return list;
}

/// One wave form that the directions have in turn, `turns` times each.
class TurnSource final : public SignalSource {
 public:
  TurnSource(const Vector6& rms, std::vector<double> wave, int turns)
      : rms_(rms), wave_(std::move(wave)), turns_(turns), directions_(active_directions(rms)) {
    double squares = 0.0;
    for (const double value : wave_) squares += value * value;
    const double scale = std::sqrt(static_cast<double>(wave_.size()) / squares);
    for (double& value : wave_) value *= scale;
  }
  void restart() override { at_ = 0; }
  void add_next(Vector6& sample) override {
    if (directions_.empty()) return;
    const std::size_t length = wave_.size();
    const std::size_t turn = at_ / length / static_cast<std::size_t>(turns_);
    const int direction = directions_[turn % directions_.size()];
    sample[direction] += rms_[direction] * wave_[at_ % length];
    ++at_;
  }

 private:
  Vector6 rms_;
  std::vector<double> wave_;
  int turns_;
  std::vector<int> directions_;
  std::size_t at_{};
};

/// Rises from 0 to 1 at both ends of `length` samples, over a twentieth of it.
double taper(long at, long length) {
  const double edge = 0.05 * static_cast<double>(length);
  const double from_end =
      std::min(static_cast<double>(at) + 0.5, static_cast<double>(length - at) - 0.5);
  if (from_end >= edge) return 1.0;
  return 0.5 - 0.5 * std::cos(std::numbers::pi * from_end / edge);
}

std::vector<double> sweep(const SweptSine& spec, long length, double rate) {
  std::vector<double> wave;
  const double duration = static_cast<double>(length) / rate;
  const double ratio = std::log(spec.to / spec.from);
  for (long k = 0; k < length; ++k) {
    const double t = static_cast<double>(k) / rate;
    const double cycles = spec.logarithmic && spec.to > spec.from
                              ? spec.from * duration / ratio * std::expm1(ratio * t / duration)
                              : spec.from * t + 0.5 * (spec.to - spec.from) * t * t / duration;
    wave.push_back(taper(k, length) * std::sin(two_pi * cycles));
  }
  return wave;
}

}  // namespace

SequenceShape sequence_shape(const BinarySequence& spec, double rate) {
  constexpr double half_power = 0.443;  // of the clock rate, sinc² = 1/2
  SequenceShape shape;
  shape.hold = std::max(1L, std::lround(half_power * rate / spec.to));
  constexpr double slack = 1.0 - 1e-9;  // a period of whole clocks is that long
  const double least = slack * spec.period * rate / static_cast<double>(shape.hold);
  shape.bits = 3;
  while (shape.bits < 20 && static_cast<double>((1L << shape.bits) - 1) < least) ++shape.bits;
  return shape;
}

std::unique_ptr<SignalSource> make_source(const BinarySequence& spec,
                                          const SourceContext& context) {
  require_levels("binary sequence", spec.rms);
  require_band("binary sequence", 0.0, spec.to, context.rate, true);
  require(spec.to > 0.0, "binary sequence: to", spec.to, "more than 0 Hz");
  whole_samples("binary sequence: period", spec.period, context.rate);
  const SequenceShape shape = sequence_shape(spec, context.rate);
  const auto sequence = maximum_length_sequence(shape.bits, context.seed + context.stream);
  const auto clocks = static_cast<long>(sequence.size());
  require(clocks * shape.hold <= longest_period, "binary sequence: period", spec.period,
          "at most ten million samples, in seconds");
  Eigen::Matrix<double, 6, Eigen::Dynamic> period(6, clocks * shape.hold);
  for (long k = 0; k < period.cols(); ++k)
    for (long i = 0; i < 6; ++i)
      period(i, k) = spec.rms[static_cast<int>(i)] *
                     sequence[static_cast<std::size_t>((k / shape.hold + i * clocks / 6) % clocks)];
  return std::make_unique<PeriodicSource>(std::move(period));
}

std::unique_ptr<SignalSource> make_source(const SweptSine& spec, const SourceContext& context) {
  require_levels("swept sine", spec.rms);
  require_band("swept sine", spec.from, spec.to, context.rate, false);
  const long length = whole_samples("swept sine: duration", spec.duration, context.rate);
  return std::make_unique<TurnSource>(spec.rms, sweep(spec, length, context.rate), 1);
}

std::unique_ptr<SignalSource> make_source(const Chirp& spec, const SourceContext& context) {
  require_levels("chirp", spec.rms);
  require_band("chirp", spec.from, spec.to, context.rate, true);
  require(spec.turns >= 1, "chirp: turns", spec.turns, "1 or more");
  const long length = whole_samples("chirp: period", spec.period, context.rate);
  const double period = static_cast<double>(length) / context.rate;
  // whole cycles per period, so that it repeats without a break
  const double cycles = std::max(1.0, std::round(0.5 * (spec.from + spec.to) * period));
  const double rise = 2.0 * (cycles / period - spec.from);
  std::vector<double> wave;
  for (long k = 0; k < length; ++k) {
    const double t = static_cast<double>(k) / context.rate;
    wave.push_back(std::sin(two_pi * (spec.from * t + 0.5 * rise * t * t / period)));
  }
  return std::make_unique<TurnSource>(spec.rms, std::move(wave), spec.turns);
}

}  // namespace hydrapod::rig
