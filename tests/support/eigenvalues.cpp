#include "support/eigenvalues.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace hydrapod::test {

Eigen::VectorXd omega_squared(const Eigen::Ref<const Eigen::MatrixXd>& M,
                              const Eigen::Ref<const Eigen::MatrixXd>& K) {
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const Matrix M_long = M.cast<long double>(), K_long = K.cast<long double>();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(K_long, M_long,
                                                                Eigen::EigenvaluesOnly);
  return solver.eigenvalues().cast<double>();
}

double worst_frequency_error(const Eigen::VectorXd& omega_squared,
                             const Eigen::VectorXd& expected_omega_squared, double at_least) {
  double worst = omega_squared.size() == expected_omega_squared.size() ? 0.0 : INFINITY;
  for (Eigen::Index i = 0; i < omega_squared.size() && std::isfinite(worst); ++i) {
    const double found = omega_squared[i], expected = expected_omega_squared[i];
    const double scale = std::max(std::abs(expected), at_least);
    const bool oscillates = found > 0.0 && expected > 0.0 && expected >= at_least;
    const double error = oscillates ? std::abs(std::sqrt(found / expected) - 1.0)
                                    : std::abs(found - expected) / scale;
    worst = error <= worst ? worst : error;  // keeps NaN
  }
  return worst;
}

}  // namespace hydrapod::test
