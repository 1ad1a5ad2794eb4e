/// Maximum-length binary sequences.

#include <algorithm>
#include <array>
#include <cmath>

#include "sources.hpp"

namespace hydrapod::signals {

namespace {

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

}  // namespace

SequenceShape sequence_shape(const Binary& binary, double rate) {
  constexpr double half_power = 0.443;  // of the clock rate, sinc² = 1/2
  SequenceShape shape;
  shape.hold = std::max(1L, std::lround(half_power * rate / binary.to));
  constexpr double slack = 1.0 - 1e-9;  // a period of whole clocks is that long
  const double least = slack * binary.period * rate / static_cast<double>(shape.hold);
  shape.bits = 3;
  while (shape.bits < 20 && static_cast<double>((1L << shape.bits) - 1) < least) ++shape.bits;
  return shape;
}

Source make_source(const Binary& binary, const Context& context) {
  const SequenceShape shape = sequence_shape(binary, context.rate);
  return [size = context.size, shape,
          sequence = maximum_length_sequence(shape.bits, context.seed + context.stream)](long k) {
    Sample sample;
    const auto clocks = static_cast<long>(sequence.size());
    for (long i = 0; i < 6; ++i)
      sample.value[i] =
          size[i] * sequence[static_cast<std::size_t>((k / shape.hold + i * clocks / 6) % clocks)];
    return sample;
  };
}

}  // namespace hydrapod::signals
