#pragma once
/// Sums Σ z_i z_j* over blocks, for all pairs of channels. Private to the module.

#include <Eigen/Core>
#include <vector>

#include "hydrapod/numerics/fft.hpp"

namespace hydrapod::identification {

/// Lines stand in groups of eight. The sums of a group are one after the other for squares of two
/// by two pairs, (i, j), (i, j + 1), (i + 1, j), (i + 1, j + 1) with i ≥ j both even: a square
/// needs four numbers per line and block for four products.
class CrossProducts {
 public:
  CrossProducts() = default;
  CrossProducts(Eigen::Index channels, Eigen::Index groups);

  /// Adds `factor` × the products of `blocks` blocks at the lines of one group. `lines`: `width()`
  /// channels of the first block, those beyond the last being zero; the next block is `apart` on.
  void add(Eigen::Index group, const numerics::EightLines* lines, Eigen::Index blocks,
           Eigen::Index apart, double factor = 1.0);
  [[nodiscard]] Eigen::Index width() const { return channels_ + channels_ % 2; }

  /// Times `scale` per line: lines × pairs, (i, j) with i ≥ j in column i (i + 1)/2 + j.
  void unpack(const Eigen::VectorXd& scale, Eigen::MatrixXd& re, Eigen::MatrixXd& im) const;

 private:
  Eigen::Index channels_{}, squares_{};
  std::vector<numerics::EightLines> sums_{};  // groups × squares × 4
};

}  // namespace hydrapod::identification
