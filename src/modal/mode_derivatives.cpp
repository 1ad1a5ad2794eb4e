#include "hydrapod/modal/damped_modes.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace hydrapod::modal {

namespace {

/// (dK − λ dM) φ
ModelVector force(const ModelDerivative& d, double lambda, const ModelVector& phi) {
  return d.K * phi - lambda * (d.M * phi);
}

/// Modes from `first` on that are of one group.
int group_end(const NormalModes& modes, int first) {
  int end = first + 1;
  while (end < modes.size() && modes.group[end] == modes.group[first]) ++end;
  return end;
}

double splitting(const ModelMatrix& G) {
  const double mean = G.trace() / static_cast<double>(G.rows());
  return (G - mean * ModelMatrix::Identity(G.rows(), G.cols())).norm();
}

}  // namespace

ModelMatrix group_derivative(const NormalModes& modes, int first, int size,
                             const ModelDerivative& derivative) {
  const ModelMatrix basis = modes.shapes.middleCols(first, size);
  const double lambda = modes.omega2[first];
  const ModelMatrix forces = derivative.K * basis - lambda * (derivative.M * basis);
  const ModelMatrix G = basis.transpose() * forces;
  return 0.5 * (G + G.transpose());
}

void turn_repeated(NormalModes& modes, std::span<const ModelDerivative> derivatives,
                   const Eigen::VectorXd& scales) {
  constexpr double worth_turning = 1e-9;  // of ω², per scale of the parameter
  for (int first = 0; first < modes.size();) {
    const int size = group_end(modes, first) - first;
    double most = worth_turning * std::abs(modes.omega2[first]);
    ModelMatrix chosen;
    for (std::size_t j = 0; size > 1 && j < derivatives.size(); ++j) {
      const ModelMatrix G = group_derivative(modes, first, size, derivatives[j]) *
                            scales[static_cast<Eigen::Index>(j)];
      if (splitting(G) <= most) continue;
      most = splitting(G);
      chosen = G;
    }
    if (chosen.size() > 0) {
      const Eigen::SelfAdjointEigenSolver<ModelMatrix> eigen(chosen);
      const ModelMatrix basis = modes.shapes.middleCols(first, size);
      modes.shapes.middleCols(first, size) = basis * eigen.eigenvectors();
    }
    first += size;
  }
}

Eigen::MatrixXd omega2_derivatives(const NormalModes& modes,
                                   std::span<const ModelDerivative> derivatives) {
  Eigen::MatrixXd result(modes.size(), derivatives.size());
  for (std::size_t j = 0; j < derivatives.size(); ++j) {
    const auto& d = derivatives[j];
    const ModelMatrix K_phi = d.K * modes.shapes, M_phi = d.M * modes.shapes;
    for (int k = 0; k < modes.size(); ++k)
      result(k, static_cast<Eigen::Index>(j)) =
          modes.shapes.col(k).dot(K_phi.col(k) - modes.omega2[k] * M_phi.col(k));
  }
  return result;
}

std::vector<int> neighbours(const NormalModes& modes, int k, double together) {
  std::vector<int> near;
  for (int i = 0; i < modes.size(); ++i)
    if (modes.group[i] == modes.group[k] ||
        std::abs(modes.omega2[i] - modes.omega2[k]) <= together * std::abs(modes.omega2[k]))
      near.push_back(i);
  return near;
}

Eigen::MatrixXd shape_derivatives(const NormalModes& modes, int k,
                                  std::span<const ModelDerivative> derivatives, double together) {
  const ModelVector phi = modes.shapes.col(k);
  const double lambda = modes.omega2[k];
  ModelVector factor = (lambda - modes.omega2.array()).matrix();
  for (int i = 0; i < modes.size(); ++i) factor[i] = 1.0 / factor[i];
  for (const int i : neighbours(modes, k, together)) factor[i] = 0.0;
  Eigen::MatrixXd result(phi.size(), derivatives.size());
  for (std::size_t j = 0; j < derivatives.size(); ++j) {
    const ModelVector forces = modes.shapes.transpose() * force(derivatives[j], lambda, phi);
    ModelVector amount = forces.cwiseProduct(factor);
    amount[k] = -0.5 * phi.dot(derivatives[j].M * phi);
    result.col(static_cast<Eigen::Index>(j)) = modes.shapes * amount;
  }
  return result;
}

}  // namespace hydrapod::modal
