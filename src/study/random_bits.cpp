#include "random_bits.hpp"

#include <array>

#include "hydrapod/study/study.hpp"

namespace hydrapod::study {

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                    std::array<std::uint32_t, 2> key) {
  constexpr std::uint64_t multiplier_0 = 0xD2511F53, multiplier_1 = 0xCD9E8D57;
  constexpr std::uint32_t step_0 = 0x9E3779B9, step_1 = 0xBB67AE85;
  constexpr int rounds = 10;
  for (int round = 0; round < rounds; ++round) {
    const std::uint64_t a = multiplier_0 * counter[0], b = multiplier_1 * counter[2];
    counter = {
        static_cast<std::uint32_t>(b >> 32U) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
        static_cast<std::uint32_t>(a >> 32U) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
    key = {key[0] + step_0, key[1] + step_1};
  }
  return counter;
}

std::uint64_t bits(std::uint64_t seed, Stream stream, std::uint64_t index, std::size_t dimension) {
  const std::array<std::uint32_t, 2> key{static_cast<std::uint32_t>(seed),
                                         static_cast<std::uint32_t>(seed >> 32U)};
  const auto words =
      philox({static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32U),
              static_cast<std::uint32_t>(dimension), static_cast<std::uint32_t>(stream)},
             key);
  return static_cast<std::uint64_t>(words[1]) << 32U | words[0];
}

double open_unit(std::uint64_t random) {
  return (static_cast<double>(random >> 12U) + 0.5) * 0x1p-52;
}

double uniform(std::uint64_t seed, std::uint64_t sample, std::size_t input) {
  return open_unit(bits(seed, Stream::uniform, sample, input));
}

}  // namespace hydrapod::study
