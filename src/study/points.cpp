#include <bit>
#include <boost/random/sobol.hpp>
#include <cmath>
#include <optional>
#include <utility>

#include "hydrapod/study/study.hpp"
#include "random_bits.hpp"

namespace hydrapod::study {

namespace {

/// A permutation of [0, count): four rounds of a balanced Feistel network on the next even power of
/// two, gone through again while the result is not below `count` (J. Black & P. Rogaway, CT-RSA
/// 2002).
std::uint64_t permuted(std::uint64_t seed, std::size_t dimension, std::uint64_t value,
                       std::uint64_t count) {
  const auto half = static_cast<unsigned>((std::bit_width(count - 1) + 1) / 2);
  if (half == 0) return 0;
  const std::uint64_t mask = (std::uint64_t{1} << half) - 1;
  constexpr unsigned rounds = 4;
  do {
    std::uint64_t left = value >> half, right = value & mask;
    for (unsigned round = 0; round < rounds; ++round) {
      const std::uint64_t mixed =
          bits(seed, Stream::permutation, right, dimension * rounds + round);
      left = std::exchange(right, left ^ (mixed & mask));
    }
    value = left << half | right;
  } while (value >= count);
  return value;
}

/// The element `index` of the Sobol sequence, shifted.
void sobol_point(std::uint64_t seed, std::uint64_t index, std::span<double> u) {
  thread_local std::optional<boost::random::sobol> sequence;
  if (!sequence || sequence->dimension() != u.size()) sequence.emplace(u.size());
  sequence->seed(index);
  for (std::size_t k = 0; k < u.size(); ++k)
    u[k] = open_unit((*sequence)() ^ bits(seed, Stream::shift, 0, k));
}

void all_points(const Plan& plan, std::uint64_t sample, std::span<double> u) {
  if (plan.design == Design::sobol) return sobol_point(plan.seed, sample, u);
  for (std::size_t k = 0; k < u.size(); ++k) {
    u[k] = uniform(plan.seed, sample, k);
    if (plan.design == Design::latin)
      u[k] = (static_cast<double>(permuted(plan.seed, k, sample, plan.samples)) + u[k]) /
             static_cast<double>(plan.samples);
  }
}

void grid_point(const Plan& plan, std::uint64_t row, std::span<double> u) {
  for (std::size_t k = u.size(); k-- > 0;) {
    const auto count = static_cast<std::uint64_t>(plan.counts[k]);
    u[k] = (static_cast<double>(row % count) + 0.5) / static_cast<double>(count);
    row /= count;
  }
}

}  // namespace

std::uint64_t rows_of(const Plan& plan, std::size_t inputs) {
  constexpr std::uint64_t most = std::uint64_t{1} << 62U;
  const std::uint64_t each = plan.indices ? inputs + 2 : 1;
  return plan.samples > most / each ? most : plan.samples * each;
}

void place(const Plan& plan, std::uint64_t row, std::span<double> u) {
  if (plan.design == Design::grid) return grid_point(plan, row, u);
  if (!plan.indices) return all_points(plan, row, u);
  // Rows of a sample: A, B, then A with column k of B.
  const std::size_t inputs = u.size();
  const std::uint64_t sample = row / (inputs + 2), which = row % (inputs + 2);
  std::vector<double> both(2 * inputs);
  all_points(plan, sample, both);
  for (std::size_t k = 0; k < inputs; ++k)
    u[k] = both[which == 1 || which == k + 2 ? inputs + k : k];
}

}  // namespace hydrapod::study
