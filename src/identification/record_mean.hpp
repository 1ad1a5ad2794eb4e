#pragma once
/// The mean of a record in the lines of its blocks. Private to the module.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "hydrapod/numerics/fft.hpp"
#include "names.hpp"

namespace hydrapod::identification {

/// What the mean of a record, taken out in place of that of each block, adds to the sums of
/// products. With z a block's line less the block's mean b, and m the mean of b over the record,
///
///     Σ (z + W (b − m)) (z + W (b − m))ᴴ = Σ z zᴴ + W* C + W Cᴴ + |W|² Σ (b − m)(b − m)ᵀ,
///
/// C = Σ z (b − m)ᵀ, W = Σ w_t e^(−2πi k t/n), which is zero but for the first lines.
class RecordMean {
 public:
  RecordMean() = default;
  RecordMean(const VectorXd& window, Index channels, numerics::RealFft& fft);
  /// The first ones, that a mean shows in.
  [[nodiscard]] Index lines() const { return static_cast<Index>(window_.size()); }
  /// A block's means, and its lines from 0 on per channel, without these means.
  void add(const Eigen::RowVectorXd& mean, const numerics::EightLines* first_lines);
  void end_record();
  [[nodiscard]] const MatrixXcd& products(Index line) const {
    return products_[static_cast<std::size_t>(line)];
  }

 private:
  std::vector<Complex> window_{};        // W
  std::vector<MatrixXcd> products_{};    // of all records that have ended
  VectorXd reference_{}, sum_{};         // mean of the first block; Σ of those of others less it
  MatrixXd squares_{};                   // Σ b bᵀ, less the reference too
  std::vector<VectorXcd> line_sums_{};   // Σ z
  std::vector<MatrixXcd> line_means_{};  // Σ z bᵀ
  std::int64_t blocks_{};
};

}  // namespace hydrapod::identification
