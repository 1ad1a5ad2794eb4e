/// With a damping matrix that couples all coordinates: D = L diag(d) Lᵀ as a whole, the platform
/// last.

#include <cmath>

#include "elimination_kernel.hpp"

namespace hydrapod::response {

namespace {

/// D, and what becomes of it, for the frequencies in the lanes: the lower triangle by rows, in the
/// reverse order of the model, so that its six first coordinates are the last.
class WholeSystem {
 public:
  WholeSystem(const ResponseModel& model, const ModelMatrix& C)
      : model_(model), C_(C), n_(static_cast<int>(model.K.rows())), inner_(n_ - 6) {
    D_.resize(static_cast<std::size_t>(n_ * (n_ + 1) / 2));
    inverse_pivots_.resize(static_cast<std::size_t>(inner_));
    unscaled_.resize(static_cast<std::size_t>(inner_));
    for (int i = 0; i < n_ && model.loads_flexible; ++i)
      loads_.push_back(model.loads.row(n_ - 1 - i));
    for (const auto& arm : model.arms) {
      auto& places = places_.emplace_back();
      for (int i = 0; i < n_; ++i)
        if (arm.s_y[n_ - 1 - i] != 0.0) places.push_back(i);
    }
  }

  /// Platform motion per load. `is_sure`: false in lanes where a pivot came near zero.
  Block<6, 6> solve(const Frequencies& f, std::array<bool, lanes>& is_sure) {
    is_sure.fill(true);
    set(f);
    for (int i = 0; i < n_; ++i) {
      eliminate_row(i);
      if (i < inner_) take_pivot(i, f, is_sure);
    }
    Block<6, 6> S;
    for (int r = 0; r < 6; ++r)
      for (int c = 0; c <= r; ++c) S[r][c] = at(n_ - 1 - c, n_ - 1 - r);
    const Block<6, 6> G = inverse(S);
    return model_.loads_flexible ? times(G, loads()) : G;
  }

 private:
  Numbers& at(int i, int j) { return D_[static_cast<std::size_t>(i * (i + 1) / 2 + j)]; }

  void set(const Frequencies& f) {
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j <= i; ++j) {
        const int row = n_ - 1 - j, column = n_ - 1 - i;  // a column of Eigen is in one piece
        at(i, j) = {model_.K(row, column) - f.omega2 * model_.M(row, column),
                    f.omega * C_(row, column)};
      }
    for (std::size_t k = 0; k < places_.size(); ++k) {
      const auto& arm = model_.arms[k];
      const Reals damper = arm.stiffness * arm.rate / (f.omega2 + arm.rate * arm.rate);
      for (const int i : places_[k])
        for (const int j : places_[k]) {
          if (j > i) break;
          const double product = arm.s_y[n_ - 1 - i] * arm.s_y[n_ - 1 - j];
          at(i, j) -= {product * arm.rate * damper, -product * damper * f.omega};
        }
    }
  }

  /// Row i of L, or of what is left of D for the platform.
  void eliminate_row(int i) {
    const int columns = std::min(i, inner_);
    Numbers* row = &at(i, 0);
    for (int j = 0; j < columns; ++j) {
      const Numbers* above = &at(j, 0);
      Numbers sum = row[j];
      for (int k = 0; k < j; ++k) sum -= unscaled_[static_cast<std::size_t>(k)] * above[k];
      unscaled_[static_cast<std::size_t>(j)] = sum;
      row[j] = sum * inverse_pivots_[static_cast<std::size_t>(j)];
    }
    for (int j = columns; j <= i; ++j) {
      const Numbers* other = &at(j, 0);
      for (int k = 0; k < columns; ++k) row[j] -= unscaled_[static_cast<std::size_t>(k)] * other[k];
    }
  }

  void take_pivot(int i, const Frequencies& f, std::array<bool, lanes>& is_sure) {
    const Numbers& pivot = at(i, i);
    const int of = n_ - 1 - i;
    const Reals square = pivot.re.square() + pivot.im.square();
    const Reals parts = std::abs(model_.K(of, of)) + f.omega2 * model_.M(of, of);
    constexpr double near_zero = 1e-3;  // of what the diagonal is the difference of
    for (int lane = 0; lane < lanes; ++lane)
      if (!(std::sqrt(square[lane]) > near_zero * parts[lane]))
        is_sure[static_cast<std::size_t>(lane)] = false;
    inverse_pivots_[static_cast<std::size_t>(i)] = reciprocal(pivot);
  }

  /// B less what the inner coordinates pass on.
  Block<6, 6> loads() {
    std::vector<std::array<Numbers, 6>> Y(static_cast<std::size_t>(n_));
    for (int i = 0; i < n_; ++i)
      for (int c = 0; c < 6; ++c) {
        Numbers sum{Reals::Constant(loads_[static_cast<std::size_t>(i)][c]), Reals::Zero()};
        for (int k = 0; k < std::min(i, inner_); ++k)
          sum -= at(i, k) * Y[static_cast<std::size_t>(k)][static_cast<std::size_t>(c)];
        Y[static_cast<std::size_t>(i)][static_cast<std::size_t>(c)] = sum;
      }
    Block<6, 6> W;
    for (std::size_t r = 0; r < 6; ++r) W[r] = Y[static_cast<std::size_t>(n_ - 1) - r];
    return W;
  }

  const ResponseModel& model_;
  const ModelMatrix& C_;
  int n_, inner_;  ///< coordinates, and those that are not the platform's
  std::vector<Numbers> D_{}, inverse_pivots_{}, unscaled_{};
  std::vector<Eigen::Matrix<double, 1, 6>> loads_{};
  std::vector<std::vector<int>> places_{};  ///< of each arm, where it acts
};

}  // namespace

std::vector<std::size_t> eliminate_whole(const ResponseModel& model, const ModelMatrix& C,
                                         std::span<const double> omega, std::span<Matrix6c> out) {
  WholeSystem system(model, C);
  std::vector<std::size_t> unsure;
  for (std::size_t first = 0; first < omega.size(); first += lanes) {
    const auto count = std::min<std::size_t>(lanes, omega.size() - first);
    Frequencies f;
    for (std::size_t k = 0; k < lanes; ++k)
      f.omega[static_cast<Eigen::Index>(k)] = omega[first + std::min(k, count - 1)];
    f.omega2 = f.omega.square();
    std::array<bool, lanes> is_sure{};
    const Block<6, 6> H = system.solve(f, is_sure);
    for (std::size_t k = 0; k < count; ++k) {
      if (!is_sure[k]) unsure.push_back(first + k);
      for (int c = 0; c < 6; ++c)
        for (int r = 0; r < 6; ++r)
          out[first + k](r, c) = Complex(H[r][c].re[static_cast<Eigen::Index>(k)],
                                         H[r][c].im[static_cast<Eigen::Index>(k)]);
    }
  }
  return unsure;
}

}  // namespace hydrapod::response
