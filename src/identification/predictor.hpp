#pragma once
/// Linear prediction of channels from their past and from other channels, and missing samples from
/// it. Private to the module.
///
/// Channels stand in rows of time, z_t = (u_t, y_t): u is given, y is predicted,
///
///     y_t = Σ_(k = 1 … p) A_k y_(t−k) + Σ_(k = 0 … p) B_k u_(t−k) + e_t,   cov e = W⁻¹ W⁻ᵀ.
///
/// Missing samples of y are those with the least Σ_t |W e_t|²: of normal signals the mean under the
/// condition of all that was measured, before and after. The errors of that mean are uncorrelated
/// with u and with all that was measured.
///
/// Unknowns within p samples of each other are coupled: taken in pieces of p samples, the normal
/// equations are block tridiagonal, and their Cholesky factors cost time in proportion to the
/// length of the record.
///
/// Sources: A. J. E. M. Janssen, R. N. J. Veldhuis, L. B. Vries, IEEE Trans. Acoust. Speech Signal
/// Process. 34 (1986) 317 (one channel); R. J. A. Little, D. B. Rubin, Statistical Analysis with
/// Missing Data, 2nd ed. (2002), ch. 8 and 11.

#include <vector>

#include "hydrapod/numerics/statistics.hpp"
#include "names.hpp"

namespace hydrapod::identification {

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
/// 1 where a sample is missing.
using Mask = Eigen::Matrix<unsigned char, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct PredictorOptions {
  /// p = most_coefficients / channels, at most highest_order: the fit takes time with the square of
  /// the number of coefficients per channel.
  Index most_coefficients{360}, highest_order{64};
  /// That are fitted, those with the fewest missing samples: 40 per coefficient or more, and
  /// prediction is then a percent worse than with the true coefficients.
  Index most_rows{Index{1} << 14};
  /// Fits, each followed by filling, where rows with missing samples must be fitted.
  int rounds{3};
  /// Added to the squares of channels of variance 1: less than any sensor's noise.
  double ridge{1e-10};
};

class Predictor {
 public:
  Predictor() = default;
  /// Of the columns of `z` from `given` on, from those before; their means are 0 and their
  /// variances 1 or so. Missing samples of the columns from `given` on are filled.
  Predictor(Rows& z, const Mask& missing, Index given, const PredictorOptions& options = {});

  [[nodiscard]] Index order() const { return order_; }
  /// Fills what is missing of the columns from `given` on, in rows from `first` on. What is before
  /// the first row and after the last is 0. With `random` not the mean, but the mean and a draw
  /// from its errors: second moments of z are then those of the signals.
  void fill(Rows& z, const Mask& missing, Index first = 0,
            numerics::Gaussian* random = nullptr) const;

 private:
  /// A missing sample; columns count from the first that is predicted.
  struct Unknown {
    Index row{}, column{};
  };
  /// The unknowns of p rows.
  struct Piece {
    std::vector<Unknown> unknowns{};
    MatrixXd L{}, C{};  // Cholesky factors of the normal equations: of itself, with the one before
    VectorXd v{};       // right side, then solution
  };
  void fit(const Rows& z, const std::vector<Index>& rows, double ridge);
  [[nodiscard]] MatrixXd errors(const Rows& z, Index first, Index last) const;
  /// Unknowns become 0 in z.
  [[nodiscard]] std::vector<Piece> pieces_of(Rows& z, const Mask& missing, Index first) const;
  [[nodiscard]] MatrixXd products(const std::vector<Unknown>& a,
                                  const std::vector<Unknown>& b) const;
  [[nodiscard]] VectorXd right_side(const Rows& z, const std::vector<Unknown>& unknowns) const;
  void eliminate(const Rows& z, const Piece& before, Piece& own) const;

  Index given_{}, targets_{}, order_{};
  MatrixXd G_{};                      // W e_t = G_ (z_(t−p), …, z_t)
  std::vector<MatrixXd> coupling_{};  // Σ_k G_(k+d)ᵀ G_k by lags k, for unknowns d samples apart
};

}  // namespace hydrapod::identification
