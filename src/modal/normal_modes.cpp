#include "hydrapod/modal/normal_modes.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "hydrapod/base/error.hpp"
#include "symmetric_eigen.hpp"

namespace hydrapod::modal {

namespace {

using spatial::Matrix6;

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
  if (llt.info() != Eigen::Success)
    throw base::ComputationError(
        "the mass matrix is not positive definite: do the platform and every leg have mass and "
        "inertia?");
  return llt.matrixU().solve(Matrix::Identity());
}

/// The rows and columns of the platform and, behind all legs, of the base.
template <int flexible, int of_base>
decltype(auto) outer_part(const ModelMatrix& A) {
  if constexpr (of_base == 0) {
    return A.topLeftCorner<6, 6>();
  } else {
    constexpr int behind = 6 + model::leg_count * flexible;
    Eigen::Matrix<double, 6 + of_base, 6 + of_base> part;
    part.template topLeftCorner<6, 6>() = A.topLeftCorner<6, 6>();
    part.template topRightCorner<6, of_base>() = A.block<6, of_base>(0, behind);
    part.template bottomLeftCorner<of_base, 6>() = A.block<of_base, 6>(behind, 0);
    part.template bottomRightCorner<of_base, of_base>() = A.block<of_base, of_base>(behind, behind);
    return part;
  }
}

/// Rows of a leg, columns of the platform and the base.
template <int flexible, int of_base>
Eigen::Matrix<double, flexible, 6 + of_base> border(const ModelMatrix& A, int at) {
  Eigen::Matrix<double, flexible, 6 + of_base> part;
  part.template leftCols<6>() = A.block<flexible, 6>(at, 0);
  if constexpr (of_base > 0)
    part.template rightCols<of_base>() =
        A.block<flexible, of_base>(at, 6 + model::leg_count * flexible);
  return part;
}

/// `part`, whose columns are those of platform and base, into the rows from `at` on.
template <int flexible, int of_base, class Part, class Columns>
void place(const Part& part, int at, Columns& X) {
  constexpr int rows = Part::RowsAtCompileTime;
  X.template block<rows, 6>(at, 0) = part.template leftCols<6>();
  if constexpr (of_base > 0)
    X.template block<rows, of_base>(at, 6 + model::leg_count * flexible) =
        part.template rightCols<of_base>();
}

/// The same of a matrix between platform and base.
template <int flexible, int of_base, class Part, class Columns>
void place_outer(const Part& part, Columns& X) {
  place<flexible, of_base>(Eigen::Matrix<double, 6, 6 + of_base>(part.template topRows<6>()), 0, X);
  if constexpr (of_base > 0)
    place<flexible, of_base>(
        Eigen::Matrix<double, of_base, 6 + of_base>(part.template bottomRows<of_base>()),
        6 + model::leg_count * flexible, X);
}

/// X with Xᵀ M X = I, and A = Xᵀ K X. Legs touch each other only through platform and base, so
/// every leg's own small block of M is factored first; then come the columns of platform and base
/// (r), in which the legs follow freely:
///
///     X = [ T      0  ]    P_i = L_i⁻ᵀ,  M_ff,i = L_i L_iᵀ
///         [ −G_i T P_i ]   G_i = M_ff,i⁻¹ M_fr,i,  T = L⁻ᵀ,  L Lᵀ = M_rr − Σ M_rf,i G_i
///
/// The base's columns are the last, where the eigensolver wants what is stiff.
template <int flexible, int of_base>
void reduce(const LinearModel& model, Pencil<6 + model::leg_count * flexible + of_base>& pencil) {
  constexpr int outer = 6 + of_base;
  using Outer = Eigen::Matrix<double, outer, outer>;
  using Block = Eigen::Matrix<double, flexible, flexible>;
  using Border = Eigen::Matrix<double, flexible, outer>;
  auto& [A, X, diagonal, subdiagonal] = pencil;
  std::array<Border, model::leg_count> G;
  Outer M_outer = outer_part<flexible, of_base>(model.M);
  for (int i = 0; i < model::leg_count; ++i) {
    const int at = 6 + flexible * i;
    const Border M_fr = border<flexible, of_base>(model.M, at);
    const Block P = inverse_root<flexible>(model.M.block<flexible, flexible>(at, at));
    G[i] = P * (P.transpose() * M_fr);
    M_outer -= M_fr.transpose() * G[i];
    X.template block<flexible, flexible>(at, at) = P;
  }
  const Outer T = inverse_root<outer>(M_outer);
  place_outer<flexible, of_base>(T, X);
  Outer forces = outer_part<flexible, of_base>(model.K) * T;  // K X, its platform rows and columns
  Outer A_outer = Outer::Zero();
  for (int i = 0; i < model::leg_count; ++i) {
    const int at = 6 + flexible * i;
    const Block P = X.template block<flexible, flexible>(at, at);
    const Block K_ff = model.K.block<flexible, flexible>(at, at);
    const Border K_fr = border<flexible, of_base>(model.K, at);
    const Border follow = -G[i] * T;
    const Border leg_forces = K_fr * T + K_ff * follow;
    const Border A_fr = P.transpose() * leg_forces;
    place<flexible, of_base>(follow, at, X);
    A.template block<flexible, flexible>(at, at) = P.transpose() * K_ff * P;
    place<flexible, of_base>(A_fr, at, A);
    A.template middleCols<flexible>(at).template topRows<6>() =
        A_fr.template leftCols<6>().transpose();
    if constexpr (of_base > 0)
      A.template block<of_base, flexible>(6 + model::leg_count * flexible, at) =
          A_fr.template rightCols<of_base>().transpose();
    A_outer += follow.transpose() * leg_forces;
    forces += K_fr.transpose() * follow;
  }
  A_outer += T.transpose() * forces;
  place_outer<flexible, of_base>(A_outer, A);
}

/// The same without flexible coordinates.
template <int of_base>
void reduce_rigid(const LinearModel& model, Pencil<6 + of_base>& pencil) {
  constexpr int size = 6 + of_base;
  const auto T = inverse_root<size>(model.M);
  pencil.X.template topRows<size>() = T;
  pencil.A.template topRows<size>() = T.transpose() * model.K * T;
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

template <int flexible, int of_base>
NormalModes solve(const LinearModel& model) {
  constexpr int size = 6 + model::leg_count * flexible + of_base;
  Pencil<size> pencil;
  if constexpr (flexible == 0)
    reduce_rigid<of_base>(model, pencil);
  else
    reduce<flexible, of_base>(model, pencil);
  if (!diagonalize(pencil))
    throw base::ComputationError("the modes did not converge: is every stiffness finite?");
  refine(model, pencil);
  std::array<int, size> order;
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return pencil.diagonal[a] < pencil.diagonal[b]; });
  NormalModes modes{.omega2 = ModelVector(size), .shapes = ModelMatrix(size, size)};
  for (int k = 0; k < size; ++k) {
    modes.omega2[k] = pencil.diagonal[order[k]];
    modes.shapes.col(k) = pencil.X.col(order[k]).template head<size>();
  }
  return modes;
}

template <int flexible, int... of_base>
NormalModes solve(const LinearModel& model, std::integer_sequence<int, of_base...>) {
  using Solver = NormalModes (*)(const LinearModel&);
  static constexpr std::array<Solver, sizeof...(of_base)> solvers{&solve<flexible, of_base>...};
  return solvers.at(model.base_directions.size())(model);
}

NormalModes solve(const LinearModel& model) {
  constexpr auto base_counts = std::make_integer_sequence<int, 7>();
  switch (model.kind) {
    case dynamics::ModelKind::guide:
      return solve<2>(model, base_counts);
    case dynamics::ModelKind::full:
      return solve<4>(model, base_counts);
    case dynamics::ModelKind::rigid:
      break;
  }
  return solve<0>(model, base_counts);
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
