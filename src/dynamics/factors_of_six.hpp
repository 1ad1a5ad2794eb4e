#pragma once
/// The platform's six equations of motion, solved. Private to NonlinearModel.

#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::dynamics {

using spatial::Matrix6;
using spatial::Vector6;

/// L D Lᵀ of a symmetric positive matrix, of which the lower half is read. Eigen's takes a
/// tenth of the time of a right-hand side longer: it does not unroll its loops.
class FactorsOfSix {
 public:
  explicit FactorsOfSix(const Matrix6& A) : L_(A) {
#pragma GCC unroll 6
    for (int k = 0; k < 6; ++k) {
      per_d_[k] = 1.0 / L_(k, k);
#pragma GCC unroll 6
      for (int j = k + 1; j < 6; ++j) {
        const double l = L_(j, k) * per_d_[k];
#pragma GCC unroll 6
        for (int i = j; i < 6; ++i) L_(i, j) -= L_(i, k) * l;
      }
#pragma GCC unroll 6
      for (int i = k + 1; i < 6; ++i) L_(i, k) *= per_d_[k];
    }
  }

  [[nodiscard]] Vector6 solve(Vector6 x) const {
#pragma GCC unroll 6
    for (int k = 0; k < 6; ++k)
#pragma GCC unroll 6
      for (int i = k + 1; i < 6; ++i) x[i] -= L_(i, k) * x[k];
    x.array() *= per_d_.array();
#pragma GCC unroll 6
    for (int k = 5; k >= 0; --k)
#pragma GCC unroll 6
      for (int i = 0; i < k; ++i) x[i] -= L_(k, i) * x[k];
    return x;
  }

 private:
  Matrix6 L_;
  Vector6 per_d_;
};

}  // namespace hydrapod::dynamics
