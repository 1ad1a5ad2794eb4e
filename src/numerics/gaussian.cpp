#include "hydrapod/numerics/statistics.hpp"

#include <array>
#include <cmath>

namespace hydrapod::numerics {

namespace {

std::mt19937_64 seeded(std::uint64_t seed, std::uint64_t stream) {
  const std::array<std::uint32_t, 4> words{
      static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
      static_cast<std::uint32_t>(stream), static_cast<std::uint32_t>(stream >> 32)};
  std::seed_seq sequence(words.begin(), words.end());
  return std::mt19937_64(sequence);
}

}  // namespace

Gaussian::Gaussian(std::uint64_t seed, std::uint64_t stream) : engine_(seeded(seed, stream)) {}

double Gaussian::uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

double Gaussian::operator()() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  double u = 0.0, v = 0.0, square = 0.0;
  do {
    u = 2.0 * uniform() - 1.0;
    v = 2.0 * uniform() - 1.0;
    square = u * u + v * v;
  } while (square >= 1.0 || square == 0.0);
  const double factor = std::sqrt(-2.0 * std::log(square) / square);
  spare_ = v * factor;
  has_spare_ = true;
  return u * factor;
}

}  // namespace hydrapod::numerics
