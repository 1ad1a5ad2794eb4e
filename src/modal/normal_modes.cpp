#include "hydrapod/modal/normal_modes.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "hydrapod/base/error.hpp"
#include "hydrapod/numerics/dense.hpp"
#include "symmetric_eigen.hpp"

namespace hydrapod::modal {

namespace {

using spatial::Matrix6;

constexpr auto no_mass =
    "the mass matrix is not positive definite: do the platform and every leg have mass and "
    "inertia?";
constexpr auto not_converged = "the modes did not converge: is every stiffness finite?";

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

/// +1 or −1: sign that makes the leading component of `shape` positive. `weights`: roots of the
/// masses.
double canonical_sign(const ModelVector& weights, const Eigen::Ref<const ModelVector>& shape) {
  constexpr double platform_moves = 1e-4;  // weighted amplitude; its square is an energy share
  constexpr double tie = 1.0 - 1e-6;
  const ModelVector weighted = weights.cwiseProduct(shape);
  const double largest_of_platform = weighted.head<6>().lpNorm<Eigen::Infinity>();
  const bool platform = largest_of_platform > platform_moves;
  const double limit = tie * (platform ? largest_of_platform : weighted.lpNorm<Eigen::Infinity>());
  for (const double component : weighted)
    if (std::abs(component) >= limit) return component < 0.0 ? -1.0 : 1.0;
  return 1.0;
}

/// L⁻ᵀ of M = L Lᵀ.
template <int size>
Eigen::Matrix<double, size, size> inverse_root(const Eigen::Matrix<double, size, size>& M) {
  using Matrix = Eigen::Matrix<double, size, size>;
  const Eigen::LLT<Matrix> llt(M);
  if (llt.info() != Eigen::Success) throw base::ComputationError(no_mass);
  return llt.matrixU().solve(Matrix::Identity());
}

/// X with Xᵀ M X = I, and A = Xᵀ K X. Legs touch each other only through the platform, so every
/// leg's own small block of M is factored first; then come the platform's six columns, in which the
/// legs follow freely:
///
///     X = [ T      0  ]    P_i = L_i⁻ᵀ,  M_ff,i = L_i L_iᵀ
///         [ −G_i T P_i ]   G_i = M_ff,i⁻¹ M_fr,i,  T = L⁻ᵀ,  L Lᵀ = M_rr − Σ M_rf,i G_i
template <int flexible>
void reduce(const LinearModel& model, Pencil<6 + model::leg_count * flexible>& pencil) {
  using Block = Eigen::Matrix<double, flexible, flexible>;
  using Border = Eigen::Matrix<double, flexible, 6>;
  auto& [A, X, diagonal, subdiagonal] = pencil;
  std::array<Border, model::leg_count> G;
  Matrix6 M_platform = model.M.topLeftCorner<6, 6>();
  for (int i = 0; i < model::leg_count; ++i) {
    const int at = 6 + flexible * i;
    const Border M_fr = model.M.block<flexible, 6>(at, 0);
    const Block P = inverse_root<flexible>(model.M.block<flexible, flexible>(at, at));
    G[i] = P * (P.transpose() * M_fr);
    M_platform -= M_fr.transpose() * G[i];
    X.template block<flexible, flexible>(at, at) = P;
  }
  const Matrix6 T = inverse_root<6>(M_platform);
  X.template topLeftCorner<6, 6>() = T;
  Matrix6 forces = model.K.topLeftCorner<6, 6>() * T;  // K X, its platform rows and columns
  for (int i = 0; i < model::leg_count; ++i) {
    const int at = 6 + flexible * i;
    const Block P = X.template block<flexible, flexible>(at, at);
    const Block K_ff = model.K.block<flexible, flexible>(at, at);
    const Border K_fr = model.K.block<flexible, 6>(at, 0);
    const Border follow = -G[i] * T;
    const Border leg_forces = K_fr * T + K_ff * follow;
    const Border A_fr = P.transpose() * leg_forces;
    X.template block<flexible, 6>(at, 0) = follow;
    A.template block<flexible, flexible>(at, at) = P.transpose() * K_ff * P;
    A.template block<flexible, 6>(at, 0) = A_fr;
    A.template block<6, flexible>(0, at) = A_fr.transpose();
    A.template topLeftCorner<6, 6>() += follow.transpose() * leg_forces;
    forces += K_fr.transpose() * follow;
  }
  A.template topLeftCorner<6, 6>() += T.transpose() * forces;
}

template <>
void reduce<0>(const LinearModel& model, Pencil<6>& pencil) {
  const Matrix6 T = inverse_root<6>(model.M);
  pencil.X.topRows<6>() = T;
  pencil.A.topRows<6>() = T.transpose() * model.K * T;
}

/// φᵀ K φ of every shape. Its error is the square of the shape's: low modes keep their digits next
/// to very stiff seals, where the eigensolver's own ω² are only good to some epsilons of the
/// largest.
template <int size>
void refine(const LinearModel& model, Pencil<size>& pencil) {
  auto& K = pencil.A;  // no longer needed
  K.template topRows<size>() = model.K;
  for (int k = 0; k < size; ++k) {
    PaddedColumn<size> force = pencil.X(0, k) * K.col(0);
    for (int j = 1; j < size; ++j) force += pencil.X(j, k) * K.col(j);
    pencil.diagonal[k] = dot<padded(size)>(pencil.X.col(k), force);
  }
}

/// The modes sorted by ω².
NormalModes ascending(const Eigen::Ref<const Eigen::VectorXd>& omega2,
                      const Eigen::Ref<const Eigen::MatrixXd>& shapes) {
  const auto size = omega2.size();
  std::array<int, dynamics::max_dof> order;
  std::iota(order.begin(), order.begin() + size, 0);
  std::sort(order.begin(), order.begin() + size,
            [&](int a, int b) { return omega2[a] < omega2[b]; });
  NormalModes modes;
  modes.omega2.resize(size);
  modes.shapes.resize(size, size);
  for (int k = 0; k < size; ++k) {
    modes.omega2[k] = omega2[order[k]];
    modes.shapes.col(k) = shapes.col(order[k]);
  }
  return modes;
}

template <int flexible>
NormalModes solve(const LinearModel& model) {
  constexpr int size = 6 + model::leg_count * flexible;
  Pencil<size> pencil;
  reduce<flexible>(model, pencil);
  if (!diagonalize(pencil)) throw base::ComputationError(not_converged);
  refine(model, pencil);
  return ascending(pencil.diagonal.template head<size>(), pencil.X.template topRows<size>());
}

/// Shapes next to those of K φ = ω² M φ, improved. The solver's errors are some epsilons of the
/// largest ω² over the distance of two modes: too much for low modes beside a stiff mount. With
/// S = Xᵀ K X, R = 1 − Xᵀ M X, whose entries are good to epsilons of their own modes,
///
///     X ← X + X E,   E_ij = (S_ij + ω²_j R_ij) / (ω²_j − ω²_i),   E_ij = R_ij / 2 of equal modes
///
/// (Ogita & Aishima, Japan J. Indust. Appl. Math. 35 (2018) 1007, for M = 1).
Eigen::MatrixXd refined_shapes(const Eigen::MatrixXd& K, const Eigen::MatrixXd& M,
                               const Eigen::MatrixXd& X) {
  const Eigen::MatrixXd S = numerics::times(X.transpose(), numerics::times(K, X)),
                        G = numerics::times(X.transpose(), numerics::times(M, X));
  const auto size = X.cols();
  Eigen::MatrixXd E(size, size);
  constexpr double apart = 1e-6;  // of ω²: nearer, any mix of the two is as good as rounding allows
  for (Eigen::Index j = 0; j < size; ++j)
    for (Eigen::Index i = 0; i < size; ++i) {
      const double at_i = S(i, i) / G(i, i), at_j = S(j, j) / G(j, j);
      const double R = (i == j ? 1.0 : 0.0) - G(i, j);
      const bool equal =
          i == j || std::abs(at_i - at_j) <= apart * std::max(std::abs(at_i), std::abs(at_j));
      E(i, j) = equal ? 0.5 * R : (S(i, j) + at_j * R) / (at_j - at_i);
    }
  return X + numerics::times(X, E);
}

/// Xᵀ M X = 1 again, where nearly equal modes, which rounding mixes, left the square of the mixing.
Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& M, const Eigen::MatrixXd& X) {
  const Eigen::MatrixXd G = numerics::times(X.transpose(), numerics::times(M, X));
  return X + 0.5 * numerics::times(X, Eigen::MatrixXd::Identity(G.rows(), G.cols()) - G);
}

/// With coordinates of base or payload: 36 sizes from 7 to 42, of which each would take 10 to 20 s
/// to compile as those of fixed size do.
NormalModes solve_whole(const LinearModel& model) {
  const Eigen::MatrixXd K = model.K, M = model.M;
  if (Eigen::LLT<Eigen::MatrixXd>(M).info() != Eigen::Success)
    throw base::ComputationError(no_mass);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(K, M);
  if (solver.info() != Eigen::Success || !solver.eigenvectors().allFinite())
    throw base::ComputationError(not_converged);
  // the second time, what the first left of the square of the error
  const Eigen::MatrixXd X =
      orthonormal(M, refined_shapes(K, M, refined_shapes(K, M, solver.eigenvectors())));
  const Eigen::VectorXd refined = X.cwiseProduct(numerics::times(K, X)).colwise().sum();
  return ascending(refined, X);
}

NormalModes solve(const LinearModel& model) {
  if (model.beyond_legs() > 0) return solve_whole(model);
  switch (model.kind) {
    case dynamics::ModelKind::guide:
      return solve<2>(model);
    case dynamics::ModelKind::full:
      return solve<4>(model);
    case dynamics::ModelKind::rigid:
      break;
  }
  return solve<0>(model);
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
  const ModelVector weights = mass_diagonal.cwiseSqrt();
  for (int k = 0; k < count; ++k)
    modes.shapes.col(k) *= canonical_sign(weights, modes.shapes.col(k));
}

NormalModes normal_modes(const LinearModel& model) {
  NormalModes modes = solve(model);
  make_canonical(model.M.diagonal(), modes);
  return modes;
}

}  // namespace hydrapod::modal
