#include "hydrapod/modal/normal_modes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "hydrapod/base/error.hpp"

namespace hydrapod::modal {

namespace {

/// Number of modes from `first` on that repeat its ω².
int group_size(const ModelVector& omega2, int first) {
  const double rounding =
      64.0 * std::numeric_limits<double>::epsilon() * omega2.cwiseAbs().maxCoeff();
  const double tolerance = std::max(repeated_tolerance * std::abs(omega2[first]), rounding);
  int size = 1;
  while (first + size < omega2.size() &&
         omega2[first + size] - omega2[first + size - 1] < tolerance)
    ++size;
  return size;
}

/// Orthonormal columns q so that shapes·q is the canonical basis of the group.
ModelMatrix canonical_rotation(const ModelVector& mass_diagonal, const ModelMatrix& shapes) {
  constexpr double enough = 1e-6;  // share of a mode's energy that a coordinate must hold to lead
  const auto size = shapes.cols();
  ModelMatrix Q(size, size);
  int found = 0;
  for (int row = 0; row < shapes.rows() && found < size; ++row) {
    ModelVector v = shapes.row(row).transpose();
    for (int pass = 0; pass < 2; ++pass)
      v -= Q.leftCols(found) * (Q.leftCols(found).transpose() * v);
    if (v.squaredNorm() * mass_diagonal[row] < enough) continue;
    Q.col(found++) = v.normalized();
  }
  return found == size ? Q : ModelMatrix::Identity(size, size);
}

/// +1 or −1: sign that makes the leading component of `shape` positive.
double canonical_sign(const ModelVector& mass_diagonal,
                      const Eigen::Ref<const ModelVector>& shape) {
  constexpr double platform_moves = 1e-4;  // weighted amplitude; its square is an energy share
  constexpr double tie = 1.0 - 1e-6;
  double weighted[dynamics::max_dof];
  double largest_of_platform = 0.0, largest = 0.0;
  const auto size = static_cast<int>(shape.size());
  for (int i = 0; i < size; ++i) {
    weighted[i] = std::sqrt(mass_diagonal[i]) * shape[i];
    if (i == 6) largest_of_platform = largest;
    largest = std::max(largest, std::abs(weighted[i]));
  }
  if (size == 6) largest_of_platform = largest;
  const int end = largest_of_platform > platform_moves ? 6 : size;
  const double limit = tie * (end == 6 ? largest_of_platform : largest);
  for (int i = 0; i < end; ++i)
    if (std::abs(weighted[i]) >= limit) return weighted[i] < 0.0 ? -1.0 : 1.0;
  return 1.0;
}

}  // namespace

void make_canonical(const ModelVector& mass_diagonal, NormalModes& modes) {
  const int count = modes.size();
  modes.group.resize(count);
  int number = 0;
  for (int first = 0; first < count; ++number) {
    const int size = group_size(modes.omega2, first);
    if (size > 1) {
      const ModelMatrix basis = modes.shapes.middleCols(first, size);
      modes.shapes.middleCols(first, size) = basis * canonical_rotation(mass_diagonal, basis);
    }
    std::fill_n(modes.group.begin() + first, size, number);
    first += size;
  }
  for (int k = 0; k < count; ++k)
    modes.shapes.col(k) *= canonical_sign(mass_diagonal, modes.shapes.col(k));
}

NormalModes normal_modes(const LinearModel& model) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<ModelMatrix> solver(model.K, model.M);
  if (solver.info() != Eigen::Success || !(model.M.diagonal().minCoeff() > 0.0) ||
      !solver.eigenvectors().allFinite())
    throw base::ComputationError(
        "the mass matrix is not positive definite: do the platform and every leg have mass and "
        "inertia?");
  NormalModes modes{.omega2 = solver.eigenvalues(), .shapes = solver.eigenvectors()};
  make_canonical(model.M.diagonal(), modes);
  return modes;
}

}  // namespace hydrapod::modal
