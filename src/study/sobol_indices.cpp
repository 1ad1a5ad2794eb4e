#include "sobol_indices.hpp"

#include <algorithm>
#include <cmath>

#include "random_bits.hpp"

namespace hydrapod::study {

namespace {

constexpr std::size_t groups = 256;
constexpr double tail = 0.025;

/// Sums over the samples of a group, for one output.
struct Sums {
  double count{}, sum{}, squares{};  ///< of f(A) and f(B)
  std::vector<double> first{}, total{};

  explicit Sums(std::size_t inputs) : first(inputs), total(inputs) {}
  void add(const Sums& other) {
    count += other.count;
    sum += other.sum;
    squares += other.squares;
    for (std::size_t k = 0; k < first.size(); ++k) {
      first[k] += other.first[k];
      total[k] += other.total[k];
    }
  }
  /// Of both matrices: 2 `count` values.
  [[nodiscard]] double variance() const {
    const double mean = sum / (2.0 * count);
    return squares / (2.0 * count) - mean * mean;
  }
  [[nodiscard]] double first_index(std::size_t k) const { return first[k] / count / variance(); }
  [[nodiscard]] double total_index(std::size_t k) const {
    return 0.5 * total[k] / count / variance();
  }
};

/// f: the values of one output for the rows of a sample, against its mean.
void add_sample(std::span<const double> f, Sums& sums) {
  sums.count += 1.0;
  sums.sum += f[0] + f[1];
  sums.squares += f[0] * f[0] + f[1] * f[1];
  for (std::size_t k = 0; k < sums.first.size(); ++k) {
    sums.first[k] += f[1] * (f[k + 2] - f[0]);
    sums.total[k] += std::pow(f[0] - f[k + 2], 2);
  }
}

Interval percentiles(std::vector<double> values) {
  std::ranges::sort(values);
  const auto at = [&](double p) {
    return values[static_cast<std::size_t>(p * static_cast<double>(values.size() - 1) + 0.5)];
  };
  return {at(tail), at(1.0 - tail)};
}

Sums drawn_again(const std::vector<Sums>& filled, std::uint64_t seed, int replicate) {
  Sums sum(filled.front().first.size());
  constexpr std::uint32_t stream = 0xB007;
  for (std::size_t k = 0; k < filled.size(); ++k) {
    const auto word =
        philox({static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(replicate), 0, stream},
               {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U)})[0];
    sum.add(
        filled[static_cast<std::size_t>(static_cast<std::uint64_t>(word) * filled.size() >> 32U)]);
  }
  return sum;
}

Indices indices_of(const std::vector<Sums>& all, std::uint64_t seed, int replicates) {
  Indices result;
  std::vector<Sums> filled;
  for (const auto& one : all)
    if (one.count > 0.0) filled.push_back(one);
  if (filled.size() < 2) return result;
  const std::size_t inputs = filled.front().first.size();
  Sums whole(inputs);
  for (const auto& one : filled) whole.add(one);
  result.used = static_cast<std::uint64_t>(whole.count);
  if (!(whole.variance() > 0.0)) return result;
  std::vector<std::vector<double>> first(inputs), total(inputs);
  for (int replicate = 0; replicate < replicates; ++replicate) {
    const Sums sums = drawn_again(filled, seed, replicate);
    if (!(sums.variance() > 0.0)) continue;
    for (std::size_t k = 0; k < inputs; ++k) {
      first[k].push_back(sums.first_index(k));
      total[k].push_back(sums.total_index(k));
    }
  }
  for (std::size_t k = 0; k < inputs && !first[k].empty(); ++k) {
    result.first.push_back({whole.first_index(k), percentiles(first[k])});
    result.total.push_back({whole.total_index(k), percentiles(total[k])});
  }
  return result;
}

}  // namespace

std::vector<Indices> sobol_indices(const Spool& spool, const Problem& problem, const Plan& plan,
                                   const Summary& summary, int replicates) {
  const std::size_t inputs = problem.inputs.size(), outputs = problem.outputs.size();
  const std::size_t together = inputs + 2, width = spool.width();
  std::vector<std::vector<Sums>> sums(outputs, std::vector<Sums>(groups, Sums(inputs)));
  std::vector<std::vector<double>> f(outputs, std::vector<double>(together));
  spool.each_chunk([&](std::uint64_t chunk, std::span<const double> numbers) {
    for (std::size_t at = 0; at < numbers.size(); at += width) {
      const std::uint64_t row = chunk + at / width;
      for (std::size_t k = 0; k < outputs; ++k)
        f[k][row % together] = numbers[at + inputs + k] - summary.outputs[k].mean;
      if (row % together + 1 < together) continue;
      for (std::size_t k = 0; k < outputs; ++k)
        if (std::ranges::all_of(f[k], [](double value) { return std::isfinite(value); }))
          add_sample(f[k], sums[k][row / together % groups]);
    }
  });
  std::vector<Indices> result;
  for (const auto& of_output : sums) result.push_back(indices_of(of_output, plan.seed, replicates));
  return result;
}

}  // namespace hydrapod::study
