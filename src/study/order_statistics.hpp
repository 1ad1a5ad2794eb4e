#pragma once
/// Exact order statistics of columns that are too long for the memory: the k-th smallest value is
/// found eleven bits at a time, in six passes over the rows.

#include "hydrapod/study/study.hpp"

namespace hydrapod::study {

/// The value of that rank, from 0, among the finite values of output `output`.
struct RankWanted {
  std::size_t output{};
  std::uint64_t rank{};
};

/// One value for each one wanted; of the rows that `counts` says.
std::vector<double> order_statistics(const Spool& spool, std::size_t inputs,
                                     const std::vector<RankWanted>& wanted,
                                     const std::function<bool(std::uint64_t)>& counts);

}  // namespace hydrapod::study
