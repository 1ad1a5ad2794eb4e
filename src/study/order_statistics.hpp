#pragma once
/// Exact order statistics of columns that are too long for the memory: the k-th smallest value is
/// found eleven bits at a time. The last bits of few values are not counted but sorted: a million
/// rows take two passes, and memory does not grow with the rows.

#include "hydrapod/study/study.hpp"

namespace hydrapod::study {

/// The value of that rank, from 0, among the finite values of output `output`.
struct RankWanted {
  std::size_t output{};
  std::uint64_t rank{};
};

/// The least and the largest finite value of an output.
struct Range {
  double least{}, most{};
};

/// Parts into which outputs are divided for threads: each goes through the rows for its own.
std::size_t parts_of(int threads, std::size_t outputs);

/// One value for each one wanted; of the rows that `counts` says. `ranges`: of every output, over
/// the same rows.
std::vector<double> order_statistics(const Spool& spool, std::size_t inputs,
                                     std::span<const Range> ranges,
                                     const std::vector<RankWanted>& wanted,
                                     const std::function<bool(std::uint64_t)>& counts, int threads);

}  // namespace hydrapod::study
