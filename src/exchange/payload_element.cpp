/// A payload of another program as modes: docs/theory/payload.md, "Superelements".

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/exchange/exchange.hpp"

namespace hydrapod::exchange {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using spatial::Matrix6;
using spatial::Vector6;

constexpr const char* place = "superelement";
constexpr double least_part = 1e-6;  // share of the structure's inertia that a mode must hold
/// Square of a frequency against rigid motion over that of the lowest mode: 3 % of its frequency.
constexpr double most_resistance = 1e-3;

void check_matrix(const char* name, const MatrixXd& A, Index size) {
  if (A.rows() != size || A.cols() != size)
    base::refuse(place, fmt::format("{} has {} rows and {} columns, expected {} of each as K has",
                                    name, A.rows(), A.cols(), size));
  if (!A.allFinite()) base::refuse(place, fmt::format("{} has numbers that are not finite", name));
  constexpr double asymmetry = 1e-6;  // of the largest entry: files of six digits
  if ((A - A.transpose()).cwiseAbs().maxCoeff() > asymmetry * A.cwiseAbs().maxCoeff())
    base::refuse(place, fmt::format("{} is not symmetric", name));
}

void check(const PayloadElement& element) {
  const Index n = element.K.rows();
  constexpr Index interface = 6;
  if (n <= interface)
    base::refuse(place, fmt::format("K has {} rows, expected 6 of the interface (x, y, z, rx, ry, "
                                    "rz) and at least one more",
                                    n));
  check_matrix("K", element.K, n);
  check_matrix("M", element.M, n);
  if (element.C.size() > 0) check_matrix("C", element.C, n);
}

/// Motion of the inner coordinates per rigid motion of the interface.
MatrixXd rigid_motion(const MatrixXd& K, Index inner) {
  const Eigen::LLT<MatrixXd> factors(K.bottomRightCorner(inner, inner));
  if (factors.info() != Eigen::Success)
    base::refuse(
        place,
        "its inner coordinates are not held by the interface: K without the first six rows "
        "and columns is not positive definite");
  return -factors.solve(K.bottomLeftCorner(inner, 6));
}

/// Of both signs of a shape, the one whose largest number is positive: equal structures of
/// different files get equal modes.
Vector6 with_sign(const Vector6& L) {
  Index largest = 0;
  L.cwiseAbs().maxCoeff(&largest);
  return L[largest] < 0.0 ? Vector6(-L) : L;
}

/// Of the dampers `C` between modes.
PayloadFromElement::Coupling largest_coupling(const Eigen::VectorXd& omega2, const MatrixXd& C) {
  PayloadFromElement::Coupling largest;
  for (Index j = 0; j < C.rows(); ++j)
    for (Index k = 0; k < C.cols(); ++k) {
      if (j == k || C(j, k) == 0.0) continue;
      const double apart = std::abs(omega2[j] - omega2[k]), omega = std::sqrt(omega2[k]);
      // at equal frequencies a damper makes two modes of both, whatever they were
      const double share = std::min(1.0, std::abs(C(j, k)) * omega / std::max(apart, 1e-300));
      if (share > largest.share) largest = {share, omega, std::sqrt(omega2[j])};
    }
  return largest;
}

}  // namespace

PayloadFromElement payload_modes(const PayloadElement& element,
                                 const PayloadElementOptions& options) {
  check(element);
  const Index inner = element.K.rows() - 6;
  const MatrixXd K = 0.5 * (element.K + element.K.transpose()),
                 M = 0.5 * (element.M + element.M.transpose());
  const MatrixXd psi = rigid_motion(K, inner);
  const MatrixXd K_ii = K.bottomRightCorner(inner, inner), M_ii = M.bottomRightCorner(inner, inner);
  if (Eigen::LLT<MatrixXd>(M_ii).info() != Eigen::Success)
    base::refuse(place,
                 "M of its inner coordinates is not positive definite: every one needs mass");
  const MatrixXd M_ci = M.topRightCorner(6, inner) + psi.transpose() * M_ii;
  const Matrix6 mass = M.topLeftCorner<6, 6>() + M.topRightCorner(6, inner) * psi +
                       psi.transpose() * M.topRightCorner(6, inner).transpose() +
                       psi.transpose() * M_ii * psi;
  const Matrix6 resistance = K.topLeftCorner<6, 6>() + K.topRightCorner(6, inner) * psi;
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(K_ii, M_ii);
  const Eigen::LLT<Matrix6> mass_factors(mass);
  if (mass_factors.info() != Eigen::Success)
    base::refuse(place,
                 "its mass matrix for rigid motions is not positive definite: is M the mass, "
                 "and are the first six coordinates those of the interface?");
  PayloadFromElement result{.mass = mass};
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6> stands(
      0.5 * (resistance + resistance.transpose()), mass, Eigen::EigenvaluesOnly);
  result.rigid_stiffness = stands.eigenvalues().cwiseAbs().maxCoeff() / solver.eigenvalues()[0];
  if (!(result.rigid_stiffness < most_resistance))
    base::refuse(
        place, fmt::format("resists a rigid motion of the platform with {:.3g} times the "
                           "stiffness of its lowest mode, expected less than {}: it must stand on "
                           "the platform alone, as one rigid interface at the stated point",
                           result.rigid_stiffness, most_resistance));
  std::vector<Index> kept;
  for (Index k = 0; k < inner; ++k) {
    const Eigen::VectorXd phi = solver.eigenvectors().col(k);
    const Vector6 L = with_sign(M_ci * phi);
    if (L.dot(mass_factors.solve(L)) < least_part) continue;
    const double omega = std::sqrt(solver.eigenvalues()[k]);
    if (static_cast<int>(result.modes.size()) == options.modes) {
      result.first_left_out = omega;
      break;
    }
    model::PayloadMode mode{.frequency = omega / base::two_pi,
                            .damping_ratio = options.damping_ratio};
    if (element.C.size() > 0)
      mode.damping_ratio = phi.dot(element.C.bottomRightCorner(inner, inner) * phi) / (2.0 * omega);
    const Vector3 l = L.head<3>();
    mode.participation = l;
    mode.participation_moment = L.tail<3>() + options.p_PI.cross(l);
    result.modes.push_back(mode);
    kept.push_back(k);
  }
  if (element.C.size() > 0)
    result.coupling = largest_coupling(solver.eigenvalues()(kept),
                                       solver.eigenvectors()(Eigen::all, kept).transpose() *
                                           element.C.bottomRightCorner(inner, inner) *
                                           solver.eigenvectors()(Eigen::all, kept));
  if (result.modes.empty())
    base::refuse(
        place,
        "has no mode that is coupled to the platform: its inner coordinates have no mass in "
        "motions that the platform shares");
  return result;
}

}  // namespace hydrapod::exchange
