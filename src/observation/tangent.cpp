#include "hydrapod/observation/observation.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <optional>
#include <tuple>
#include <vector>

#include "modal_form.hpp"

namespace hydrapod::observation {

namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Indices = std::vector<Index>;

/// Number of the conjugate of pole k; conjugates are neighbours, Im > 0 first.
Index conjugate(const Eigen::VectorXcd& poles, Index k) {
  return poles[k].imag() > 0.0 ? k + 1 : poles[k].imag() < 0.0 ? k - 1 : k;
}

/// W dA V. Rows of zeros in dA and columns of conjugate poles are left out of the products.
MatrixXcd in_modes(const Observation& center, const MatrixXd& dA) {
  const auto& poles = center.poles;
  Indices rows, half;
  for (Index k = 0; k < dA.rows(); ++k) {
    if (!dA.row(k).isZero(0.0)) rows.push_back(k);
    if (poles[k].imag() >= 0.0) half.push_back(k);
  }
  const MatrixXd changed = dA(rows, Eigen::all);
  const MatrixXcd V = center.right(Eigen::all, half), W = center.left(Eigen::all, rows);
  MatrixXcd dA_V(changed.rows(), V.cols());
  dA_V.real().noalias() = changed * MatrixXd(V.real());
  dA_V.imag().noalias() = changed * MatrixXd(V.imag());
  const MatrixXcd G_half = W * dA_V;
  MatrixXcd G(poles.size(), poles.size());
  for (std::size_t i = 0; i < half.size(); ++i) {
    const Index k = half[i], other = conjugate(poles, k);
    const auto column = G_half.col(static_cast<Index>(i));
    G.col(k) = column;
    if (other == k) continue;
    for (Index j = 0; j < G.rows(); ++j) G(j, other) = std::conj(column[conjugate(poles, j)]);
  }
  return G;
}

/// Poles that repeat, in groups of two or more.
std::vector<Indices> repeated_poles(const Eigen::VectorXcd& poles) {
  constexpr double repeated = 1e-5;  // of |λ|
  std::vector<Indices> groups;
  std::vector<bool> taken(static_cast<std::size_t>(poles.size()), false);
  for (Index k = 0; k < poles.size(); ++k) {
    if (taken[static_cast<std::size_t>(k)]) continue;
    Indices group{k};
    for (Index j = k + 1; j < poles.size(); ++j)
      if (!taken[static_cast<std::size_t>(j)] &&
          std::abs(poles[j] - poles[k]) <= repeated * std::abs(poles[k])) {
        group.push_back(j);
        taken[static_cast<std::size_t>(j)] = true;
      }
    if (group.size() > 1) groups.push_back(group);
  }
  return groups;
}

/// Basis of a repeated pole in which its block of G is diagonal.
struct Basis {
  MatrixXcd Q{}, inverse{};
};
std::optional<Basis> diagonal_basis(const MatrixXcd& block, double negligible) {
  constexpr double worst = 1e-6;  // vectors less apart than that are no basis
  const Complex mean = block.trace() / static_cast<double>(block.rows());
  const MatrixXcd rest = block - mean * MatrixXcd::Identity(block.rows(), block.cols());
  if (rest.cwiseAbs().maxCoeff() <= negligible) return std::nullopt;
  const Eigen::ComplexEigenSolver<MatrixXcd> solver(block);
  if (solver.info() != Eigen::Success) return std::nullopt;
  const Eigen::PartialPivLU<MatrixXcd> lu(solver.eigenvectors());
  if (!(lu.rcond() > worst)) return std::nullopt;
  return Basis{solver.eigenvectors(), lu.inverse()};
}

template <class Matrix>
void turn_columns(const Indices& group, const MatrixXcd& Q, Matrix& A) {
  if (A.size() > 0) A(Eigen::all, group) = (A(Eigen::all, group) * Q).eval();
}
template <class Matrix>
void turn_rows(const Indices& group, const MatrixXcd& Q, Matrix& A) {
  if (A.size() > 0) A(group, Eigen::all) = (Q * A(group, Eigen::all)).eval();
}

void turn(const Indices& group, const Basis& basis, Observation& seen) {
  turn_columns(group, basis.Q, seen.right);
  turn_columns(group, basis.Q, seen.to_base);
  turn_columns(group, basis.Q, seen.to_ground);
  turn_rows(group, basis.inverse, seen.left);
  turn_rows(group, basis.inverse, seen.command_speed);
  for (auto& input : seen.inputs) turn_rows(group, basis.inverse, input);
}

}  // namespace

Tangent::Tangent(const Observation& center, const ObservedSystem& below,
                 const ObservedSystem& above, double width)
    : center_(center) {
  const auto per_unit = [&](const auto& low, const auto& high) {
    return ((high - low) / width).eval();
  };
  MatrixXcd G = in_modes(center, per_unit(below.linear.A, above.linear.A));
  const auto groups = repeated_poles(center.poles);
  for (const auto& group : groups) {
    constexpr double rounding = 1e-9;
    const auto basis = diagonal_basis(G(group, group), rounding * G.cwiseAbs().maxCoeff());
    if (!basis) continue;
    turn(group, *basis, center_);
    turn_columns(group, basis->Q, G);
    turn_rows(group, basis->inverse, G);
    turned_ = true;
  }

  change_.poles = G.diagonal();
  MatrixXcd X(G.rows(), G.cols());
  for (Index k = 0; k < X.cols(); ++k)
    for (Index j = 0; j < X.rows(); ++j)
      X(j, k) = j == k ? 0.0 : G(j, k) / (center.poles[k] - center.poles[j]);
  for (const auto& group : groups) X(group, group).setZero();

  change_.mechanics.X_BP.p_BP = per_unit(below.X_BP.p_BP, above.X_BP.p_BP);
  change_.mechanics.X_BP.R_BP = per_unit(below.X_BP.R_BP, above.X_BP.R_BP);
  change_.mechanics.p_BC = per_unit(below.p_BC, above.p_BC);
  change_.mechanics.platform_mass = per_unit(below.platform_mass, above.platform_mass);
  change_.to_base = center_.to_base * X;
  change_.to_ground = center_.to_ground * X;
  const MatrixXd carried = per_unit(below.carried, above.carried);
  if (!carried.isZero(0.0)) change_.to_ground += carried.cast<Complex>() * center_.right;
  const auto entering = [&](const MatrixXd& low, const MatrixXd& high,
                            const MatrixXcd& input) -> MatrixXcd {
    if (input.size() == 0) return {};
    return center_.left * per_unit(low, high).template cast<Complex>() - X * input;
  };
  const auto& [a, b] = std::tie(below.linear, above.linear);
  auto& inputs = change_.inputs;
  for (const auto& [entry, B] : {std::pair{Entry::valves, &simulation::LinearSystem::B_valve},
                                 std::pair{Entry::commands, &simulation::LinearSystem::B_command},
                                 std::pair{Entry::forces, &simulation::LinearSystem::B_wrench}}) {
    const auto k = static_cast<std::size_t>(entry);
    inputs[k] = entering(a.*B, b.*B, center_.inputs[k]);
  }
  change_.command_speed = entering(a.B_velocity, b.B_velocity, center_.command_speed);
  center_.right.resize(0, 0);
  center_.left.resize(0, 0);
}

Observation Tangent::at(double step) const {
  Observation seen = center_;
  const auto move = [&](auto& value, const auto& change) { value += step * change; };
  move(seen.mechanics.X_BP.p_BP, change_.mechanics.X_BP.p_BP);
  move(seen.mechanics.X_BP.R_BP, change_.mechanics.X_BP.R_BP);
  move(seen.mechanics.p_BC, change_.mechanics.p_BC);
  move(seen.mechanics.platform_mass, change_.mechanics.platform_mass);
  move(seen.poles, change_.poles);
  move(seen.to_base, change_.to_base);
  move(seen.to_ground, change_.to_ground);
  move(seen.command_speed, change_.command_speed);
  for (std::size_t k = 0; k < seen.inputs.size(); ++k) move(seen.inputs[k], change_.inputs[k]);
  for (auto& mode : seen.modes) describe_mode(seen, mode);
  return seen;
}

}  // namespace hydrapod::observation
