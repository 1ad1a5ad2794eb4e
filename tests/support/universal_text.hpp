#pragma once
/// Universal Files as finite-element programs write them, card by card.

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace hydrapod::test {

/// Dataset 252 in double precision, by columns, as Code_Aster writes it.
inline std::string matrix_dataset(int identifier, const Eigen::MatrixXd& A) {
  std::string text = fmt::format("    -1\n   252\n{:10}\n{:10}{:10}{:10}{:10}{:10}\n", identifier,
                                 4, 1, A.rows(), A.cols(), 2);
  for (Eigen::Index k = 0; k < A.size(); ++k) {
    std::string number = fmt::format("{:20.12E}", A.data()[k]);
    std::ranges::replace(number, 'E', 'D');
    text += number + (k % 4 == 3 || k + 1 == A.size() ? "\n" : "");
  }
  return text + "    -1\n";
}

/// A dataset 55: a normal mode with six values at one node.
inline std::string mode_dataset(int number, double frequency, double modal_mass,
                                double damping_ratio, int node,
                                const Eigen::Matrix<double, 6, 1>& shape) {
  std::string text = "    -1\n    55\nfree structure\nNONE\nNONE\nNONE\nNONE\n";
  text += fmt::format("{:10}{:10}{:10}{:10}{:10}{:10}\n{:10}{:10}{:10}{:10}\n", 1, 2, 3, 8, 2, 6, 2,
                      4, 1, number);
  text += fmt::format("{:13.5E}{:13.5E}{:13.5E}{:13.5E}\n{:10}\n", frequency, modal_mass,
                      damping_ratio, 0.0, node);
  for (const double value : shape) text += fmt::format("{:13.5E}", value);
  return text + "\n    -1\n";
}

/// The lowest `count` modes of the free structure M, K at its first six coordinates, node 11. Mode
/// k has the modal mass 1 + 0.7 k kg.
inline std::string free_modes_text(const Eigen::MatrixXd& M, const Eigen::MatrixXd& K,
                                   Eigen::Index count, double damping_ratio) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(K, M);
  std::string text;
  for (Eigen::Index k = 0; k < count; ++k) {
    const double omega = k < 6 ? 0.0 : std::sqrt(solver.eigenvalues()[k]);
    const double modal_mass = 1.0 + 0.7 * static_cast<double>(k);
    text += mode_dataset(static_cast<int>(k) + 1, omega / (2.0 * std::numbers::pi), modal_mass,
                         k < 6 ? 0.0 : damping_ratio, 11,
                         std::sqrt(modal_mass) * solver.eigenvectors().col(k).head<6>());
  }
  return text;
}

}  // namespace hydrapod::test
