#pragma once
/// Exact order statistics of columns that are too long for the memory: the k-th smallest value is
/// found eleven bits at a time. The last bits of few values are not counted but sorted: a million
/// rows take two passes, and memory does not grow with the rows.

#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "hydrapod/study/study.hpp"

namespace hydrapod::study {

/// The value of that rank, from 0, among the finite values of output `output`.
struct RankWanted {
  std::size_t output{};
  std::uint64_t rank{};
};

/// Where most finite values of an output are.
struct Range {
  double least{std::numeric_limits<double>::infinity()}, most{-least};
};

/// Parts into which outputs are divided for threads: each goes through the rows for its own.
std::size_t parts_of(int threads, std::size_t outputs);

/// The rows of a chunk that count, column by column: what is kept of an output is in the nearest
/// cache then.
class RowsOfChunk {
 public:
  explicit RowsOfChunk(std::size_t width) : width_(width) {}
  /// `numbers`, from row `first` on, must live as long.
  void take(std::uint64_t first, std::span<const double> numbers,
            const std::function<bool(std::uint64_t)>& counts);
  /// The finite values of a column, until the next call.
  std::span<const double> finite(std::size_t column);

 private:
  std::size_t width_;
  std::span<const double> numbers_{};
  std::vector<std::size_t> rows_{};
  std::vector<double> values_{};
};

/// Of some outputs: first every value is counted, then ranks are looked for.
class OrderSearch {
 public:
  /// `ranges`: of every output. Counts are finest there; values may lie beyond.
  explicit OrderSearch(std::span<const Range> ranges);
  ~OrderSearch();
  OrderSearch(OrderSearch&&) noexcept;

  /// Finite values, in the pass over the rows that comes first.
  void count(std::size_t output, std::span<const double> values);
  /// One value for each one wanted, of outputs that were counted, in further passes over the rows
  /// that `counts` says: the same ones.
  [[nodiscard]] std::vector<double> find(const Spool& spool, std::size_t inputs,
                                         const std::vector<RankWanted>& wanted,
                                         const std::function<bool(std::uint64_t)>& counts);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hydrapod::study
