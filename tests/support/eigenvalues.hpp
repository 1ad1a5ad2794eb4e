#pragma once
/// Eigenvalues of K v = ω² M v, computed in extended precision so that what a comparison shows is
/// the matrices, not the solver: a double precision solver alone loses ε (ω_max / ω)² of ω².

#include <Eigen/Core>

namespace hydrapod::test {

/// ω² in ascending order; negative beyond buckling.
Eigen::VectorXd omega_squared(const Eigen::Ref<const Eigen::MatrixXd>& M,
                              const Eigen::Ref<const Eigen::MatrixXd>& K);

/// Largest |ω_i − ω'_i| / ω'_i, where negative eigenvalues are compared as ω². `at_least`: smallest
/// |ω²| in the denominator.
double worst_frequency_error(const Eigen::VectorXd& omega_squared,
                             const Eigen::VectorXd& expected_omega_squared, double at_least = 0.0);

}  // namespace hydrapod::test
