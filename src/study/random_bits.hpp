#pragma once
/// Random numbers by counter: they depend on the seed and on the place alone.

#include <cstddef>
#include <cstdint>

namespace hydrapod::study {

/// Streams of one seed.
enum class Stream : std::uint32_t { uniform, shift, permutation };

std::uint64_t bits(std::uint64_t seed, Stream stream, std::uint64_t index, std::size_t dimension);

/// The middle of one of 2⁵² equal parts of (0, 1): neither 0 nor 1.
double open_unit(std::uint64_t random);

}  // namespace hydrapod::study
