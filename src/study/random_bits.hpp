#pragma once
/// Random numbers by counter: they depend on the seed and on the place alone.

#include <array>
#include <cstddef>
#include <cstdint>

namespace hydrapod::study {

/// Sixteen bytes of Philox4x32-10 of a counter and a key.
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                    std::array<std::uint32_t, 2> key);

/// Streams of one seed.
enum class Stream : std::uint32_t { uniform, shift, permutation };

std::uint64_t bits(std::uint64_t seed, Stream stream, std::uint64_t index, std::size_t dimension);

/// u of one input of Design::random.
double uniform(std::uint64_t seed, std::uint64_t sample, std::size_t input);

/// The middle of one of 2⁵² equal parts of (0, 1): neither 0 nor 1.
double open_unit(std::uint64_t random);

}  // namespace hydrapod::study
