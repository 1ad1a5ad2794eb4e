/// A payload of a Universal File as a superelement: docs/theory/payload.md, "Universal Files".

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <set>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/exchange/exchange.hpp"

namespace hydrapod::exchange {

namespace {

using data::MatrixDataset;
using Eigen::Index;
using Eigen::MatrixXd;
namespace identifier = data::matrix_identifier;

/// Of the lowest frequency of a free structure, over that with its node held. The error of the
/// latter is then below 1 % even with one elastic mode.
constexpr double most_shift = 2.0;

[[noreturn]] void refuse(const std::string& path, unsigned line, const std::string& message) {
  throw base::InputError({{.file = path, .line = line, .message = message}});
}

class Matrices {
 public:
  Matrices(const std::string& path, std::vector<MatrixDataset> all)
      : path_(path), all_(std::move(all)) {}

  [[nodiscard]] PayloadElement element() const {
    if (find(identifier::interface_mass) == nullptr &&
        find(identifier::interface_stiffness) == nullptr)
      return whole();
    return in_parts();
  }

 private:
  [[nodiscard]] const MatrixDataset* find(int id) const {
    const auto at = std::ranges::find(all_, id, &MatrixDataset::identifier);
    return at == all_.end() ? nullptr : &*at;
  }

  [[nodiscard]] const MatrixDataset& get(int id, const char* what) const {
    const auto* matrix = find(id);
    if (matrix == nullptr)
      refuse(path_, 0,
             fmt::format("has no matrix {} ({}), expected it in a dataset 252 or 2453", id, what));
    return *matrix;
  }

  /// With `rows` and `columns`, of an interface of six coordinates in SI.
  [[nodiscard]] MatrixXd sized(int id, const char* what, Index rows, Index columns) const {
    const auto& matrix = get(id, what);
    if (matrix.values.rows() != rows || matrix.values.cols() != columns)
      refuse(path_, matrix.line,
             fmt::format("matrix {} ({}) has {} rows and {} columns, expected {} and {}", id, what,
                         matrix.values.rows(), matrix.values.cols(), rows, columns));
    return matrix.values;
  }

  /// M or K: energies of motions in m and rad. Inner coordinates keep their own scale.
  [[nodiscard]] static MatrixXd in_si(MatrixXd A, const MatrixDataset& of) {
    const Index lengths = std::min<Index>(3, A.rows());
    A.topRows(lengths) *= of.length;
    A.leftCols(lengths) *= of.length;
    return A / (of.length * of.force);
  }

  [[nodiscard]] PayloadElement whole() const {
    const auto &mass = get(identifier::mass, "mass"),
               &stiffness = get(identifier::stiffness, "stiffness");
    const Index n = stiffness.values.rows();
    return {in_si(sized(identifier::mass, "mass", n, n), mass),
            in_si(sized(identifier::stiffness, "stiffness", n, n), stiffness),
            {}};
  }

  [[nodiscard]] PayloadElement in_parts() const {
    const auto& mass = get(identifier::mass, "mass of the modes");
    const Index modes = mass.values.rows();
    PayloadElement element{
        MatrixXd::Zero(6 + modes, 6 + modes), MatrixXd::Zero(6 + modes, 6 + modes), {}};
    element.M.topLeftCorner<6, 6>() =
        sized(identifier::interface_mass, "mass of the interface", 6, 6);
    element.M.bottomLeftCorner(modes, 6) =
        sized(identifier::coupling_mass, "mass between modes and interface", modes, 6);
    element.M.topRightCorner(6, modes) = element.M.bottomLeftCorner(modes, 6).transpose();
    element.M.bottomRightCorner(modes, modes) =
        sized(identifier::mass, "mass of the modes", modes, modes);
    element.K.topLeftCorner<6, 6>() =
        sized(identifier::interface_stiffness, "stiffness of the interface", 6, 6);
    element.K.bottomRightCorner(modes, modes) =
        sized(identifier::stiffness, "stiffness of the modes", modes, modes);
    element.M = in_si(element.M, mass);
    element.K = in_si(element.K, get(identifier::stiffness, "stiffness of the modes"));
    return element;
  }

  const std::string& path_;
  std::vector<MatrixDataset> all_;
};

/// Rows x … rz of the shapes at the node.
MatrixXd shapes_at(const std::string& path, const data::ModalResults& results, int node) {
  MatrixXd shapes = MatrixXd::Zero(6, static_cast<Index>(results.modes.size()));
  std::set<int> nodes;
  for (std::size_t o = 0; o < results.outputs.size(); ++o) {
    const auto& output = results.outputs[o];
    const int direction = static_cast<int>(output.direction);
    nodes.insert(output.point);
    if (output.point != node || direction < 1 || direction > 6) continue;
    for (std::size_t k = 0; k < results.modes.size(); ++k) {
      const auto value = results.modes[k].shape[static_cast<Index>(o)];
      if (value.imag() != 0.0)
        refuse(path, 0,
               fmt::format("mode {} has a complex shape, expected normal modes (analysis type 2) "
                           "with real ones (data type 2)",
                           k + 1));
      shapes(direction - 1, static_cast<Index>(k)) = value.real();
    }
  }
  if (!nodes.contains(node)) {
    constexpr std::ptrdiff_t most = 8;
    const auto end = std::next(nodes.begin(), std::min(most, std::ssize(nodes)));
    refuse(path, 0,
           fmt::format("no mode moves node {}, expected the node that is the platform, one of {}{}",
                       node, fmt::join(nodes.begin(), end, ", "), end == nodes.end() ? "" : ", …"));
  }
  return shapes;
}

/// `held`: motions of the modes with the node held.
void require_heavy_node(const std::string& path, Eigen::VectorXd omega2, const MatrixXd& held,
                        int node) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(
      held.transpose() * omega2.asDiagonal() * held, Eigen::EigenvaluesOnly);
  std::ranges::sort(omega2);
  const double free = std::sqrt(omega2[6]), lowest = std::sqrt(solver.eigenvalues()[0]);
  if (free < most_shift * lowest) return;
  refuse(
      path, 0,
      fmt::format("node {} has too little mass: the lowest frequency is {:.4g} Hz free and {:.4g} "
                  "Hz with the node held, expected a factor below {}. Modes that are left out "
                  "count too much then; compute them with the platform's mass and inertia at "
                  "the node",
                  node, free / base::two_pi, lowest / base::two_pi, most_shift));
}

/// Modes of the free structure: η = P q_c + N p with Φ_c P = 1 and Φ_c N = 0, so that the interface
/// moves by q_c.
PayloadElement of_free_modes(const std::string& path, const data::ModalResults& results, int node) {
  const auto n = static_cast<Index>(results.modes.size());
  MatrixXd shapes = shapes_at(path, results, node);
  Eigen::VectorXd omega2(n), damping(n);
  for (Index k = 0; k < n; ++k) {
    const auto& mode = results.modes[static_cast<std::size_t>(k)];
    if (!(mode.modal_mass > 0.0))
      refuse(path, 0,
             fmt::format("mode {} ({:.4g} Hz) has no modal mass, expected normal modes (dataset "
                         "55 or 2414, analysis type 2) of displacements with their modal masses",
                         k + 1, mode.omega() / base::two_pi));
    shapes.col(k) /= std::sqrt(mode.modal_mass);
    omega2[k] = std::norm(mode.pole);
    damping[k] = -2.0 * mode.pole.real();
  }
  constexpr double independent = 1e-5;  // of the largest: shapes have six digits
  Eigen::ColPivHouseholderQR<MatrixXd> by_rank(shapes.transpose());
  by_rank.setThreshold(independent);
  if (n <= 6 || by_rank.rank() < 6)
    refuse(path, 0,
           fmt::format("its {} modes move node {} in {} independent ways, expected the modes of "
                       "the free structure: the six rigid ones and at least one more, with "
                       "rotations at this node",
                       n, node, by_rank.rank()));
  const Eigen::HouseholderQR<MatrixXd> factors(shapes.transpose());
  const MatrixXd Q = factors.householderQ();
  const MatrixXd R = factors.matrixQR().topRows(6).triangularView<Eigen::Upper>();
  MatrixXd T(n, n);
  T.leftCols(6) =
      Q.leftCols(6) * R.transpose().triangularView<Eigen::Lower>().solve(MatrixXd::Identity(6, 6));
  T.rightCols(n - 6) = Q.rightCols(n - 6);
  require_heavy_node(path, omega2, T.rightCols(n - 6), node);
  PayloadElement element{T.transpose() * T, T.transpose() * omega2.asDiagonal() * T, {}};
  if (damping.maxCoeff() > 0.0) element.C = T.transpose() * damping.asDiagonal() * T;
  return element;
}

}  // namespace

PayloadElement read_universal_element(const std::string& path, int node) {
  auto matrices = data::read_matrix_datasets(path);
  if (!matrices.empty()) return Matrices(path, std::move(matrices)).element();
  return of_free_modes(path, data::read_modal_results(path).results, node);
}

}  // namespace hydrapod::exchange
