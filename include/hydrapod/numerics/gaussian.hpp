#pragma once
/// Normally distributed random numbers, the same on every machine with the same libm.
///
/// The standard fixes std::mt19937_64 to the bit but leaves its distributions open, so Marsaglia's
/// polar method is written out.

#include <cstdint>
#include <random>

namespace hydrapod::numerics {

class Gaussian {
 public:
  /// Different `stream`s of one seed are independent.
  explicit Gaussian(std::uint64_t seed, std::uint64_t stream = 0);
  /// Mean 0, variance 1.
  double operator()();
  /// In [0, 1), 53 random bits.
  double uniform();

 private:
  std::mt19937_64 engine_;
  double spare_{};
  bool has_spare_{};
};

}  // namespace hydrapod::numerics
