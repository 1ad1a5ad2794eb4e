#include "hydrapod/modal/damped_modes.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "hydrapod/base/error.hpp"

namespace hydrapod::modal {

namespace {

using Complex = std::complex<double>;
using ComplexVector = Eigen::Matrix<Complex, Eigen::Dynamic, 1>;
using ComplexMatrix = Eigen::MatrixXcd;

bool has_viscous_damper(const model::Machine& machine) {
  if (machine.damping.rayleigh_mass != 0.0 || machine.damping.rayleigh_stiffness != 0.0)
    return true;
  return std::any_of(machine.legs.begin(), machine.legs.end(), [](const model::Leg& leg) {
    return leg.guide_sleeve.damping != 0.0 || leg.oil_spring.damping != 0.0 ||
           (leg.piston_ring && leg.piston_ring->damping != 0.0);
  });
}

bool is_diagonal(const ModelMatrix& A) {
  constexpr double negligible = 1e-12;
  const ModelVector d = A.diagonal().cwiseAbs().cwiseSqrt();
  for (int i = 0; i < A.rows(); ++i)
    for (int j = 0; j < A.cols(); ++j)
      if (i != j && std::abs(A(i, j)) > negligible * (d[i] * d[j] + A.diagonal().maxCoeff() * 1e-3))
        return false;
  return true;
}

DampedMode real_mode(const NormalModes& modes, int k, double gamma) {
  DampedMode mode{.omega = modes.omega(k), .real = modes.shapes.col(k), .group = modes.group[k]};
  mode.imaginary = ModelVector::Zero(mode.real.size());
  const double half = 0.5 * gamma;
  const Complex root = std::sqrt(Complex(half * half - modes.omega2[k], 0.0));
  mode.pole = -half + (root.imag() < 0.0 ? -root : root);
  mode.stable = modes.omega2[k] > 0.0 && half >= 0.0;
  mode.damping_ratio = mode.omega > 0.0 ? half / mode.omega : 0.0;
  return mode;
}

/// Poles and shapes of [0 I; −Ω² −Γ], the upper half of the spectrum and the real poles.
struct Poles {
  std::vector<Complex> values;
  std::vector<ComplexVector> shapes;  ///< in y, φᴴ M φ = 1
  std::vector<bool> used;
};

Poles solve_poles(const NormalModes& modes, const ModelMatrix& Gamma) {
  const int n = modes.size();
  const double scale = std::sqrt(std::max(modes.omega2.cwiseAbs().maxCoeff(), 1e-300));
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n).diagonal() = -modes.omega2 / (scale * scale);
  A.bottomRightCorner(n, n) = -Gamma / scale;
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(A);
  if (solver.info() != Eigen::Success)
    throw base::ComputationError("the damped modes did not converge");
  Poles poles;
  for (int k = 0; k < 2 * n; ++k) {
    const Complex value = solver.eigenvalues()[k];
    if (value.imag() < 0.0) continue;
    const ComplexVector z = solver.eigenvectors().col(k).head(n);
    poles.values.push_back(scale * value);
    poles.shapes.push_back(modes.shapes.cast<Complex>() * (z / z.norm()));
  }
  poles.used.assign(poles.values.size(), false);
  return poles;
}

/// |aᴴ M b|: 1 for equal shapes, both normalised.
double likeness(const ModelMatrix& M, const ComplexVector& a, const ComplexVector& b) {
  return std::abs(a.dot(M.cast<Complex>() * b));
}

/// The unused real pole whose shape is most like that of pole `k`; −1 if there is none.
int partner(const Poles& poles, const ModelMatrix& M, int k) {
  int best = -1;
  double most_alike = -1.0;
  for (int j = 0; j < static_cast<int>(poles.values.size()); ++j) {
    if (j == k || poles.used[j] || poles.values[j].imag() != 0.0) continue;
    const double now = likeness(M, poles.shapes[k], poles.shapes[j]);
    if (now > most_alike) {
      most_alike = now;
      best = j;
    }
  }
  return best;
}

DampedMode from_shape(const ComplexVector& shape) {
  DampedMode mode;
  mode.real = shape.real();
  mode.imaginary = shape.imag();
  return mode;
}

/// Two real poles as one overdamped (or, with opposite signs, unstable) mode.
DampedMode overdamped(const Poles& poles, int k, int j) {
  double slow = poles.values[k].real(), fast = poles.values[j].real();
  int of_slow = k;
  if (std::abs(fast) < std::abs(slow)) {
    std::swap(slow, fast);
    of_slow = j;
  }
  DampedMode mode = from_shape(poles.shapes[of_slow]);
  mode.pole = slow;
  mode.stable = slow < 0.0 && fast < 0.0;
  mode.omega = slow * fast > 0.0 ? std::sqrt(slow * fast) : 0.0;
  mode.damping_ratio = mode.omega > 0.0 ? -(slow + fast) / (2.0 * mode.omega) : 0.0;
  return mode;
}

std::vector<DampedMode> collect(Poles& poles, const ModelMatrix& M) {
  std::vector<DampedMode> list;
  for (int k = 0; k < static_cast<int>(poles.values.size()); ++k) {
    if (poles.used[k]) continue;
    poles.used[k] = true;
    const Complex value = poles.values[k];
    if (value.imag() > 0.0) {
      DampedMode mode = from_shape(poles.shapes[k]);
      mode.pole = value;
      mode.omega = std::abs(value);
      mode.damping_ratio = -value.real() / mode.omega;
      mode.stable = value.real() <= 1e-12 * mode.omega;
      list.push_back(mode);
    } else if (const int j = partner(poles, M, k); j >= 0) {
      poles.used[j] = true;
      list.push_back(overdamped(poles, k, j));
    }
  }
  return list;
}

/// Inside a group of equal poles: the first mode takes all motion in x, the next all that is left
/// in y, …; then every mode's leading component is made real and positive.
void make_canonical(const ModelMatrix& M, std::vector<DampedMode>& modes, size_t first,
                    size_t size) {
  const ModelVector mass_diagonal = M.diagonal();
  const auto rows = modes[first].real.size();
  ComplexMatrix B(rows, static_cast<Eigen::Index>(size));
  for (size_t k = 0; k < size; ++k)
    B.col(static_cast<Eigen::Index>(k)) =
        modes[first + k].real.cast<Complex>() +
        Complex(0, 1) * modes[first + k].imaginary.cast<Complex>();
  const ComplexMatrix gram =
      B.adjoint() * M.cast<Complex>() * B;  // poles that repeat leave any basis
  const ComplexMatrix upper = Eigen::LLT<ComplexMatrix>(gram).matrixU();
  B = upper.triangularView<Eigen::Upper>().solve<Eigen::OnTheRight>(B).eval();
  ComplexMatrix Q(size, size);
  Eigen::Index found = 0;
  for (Eigen::Index row = 0; row < rows && found < B.cols(); ++row) {
    ComplexVector v = B.row(row).adjoint();
    for (int pass = 0; pass < 2; ++pass) v -= Q.leftCols(found) * (Q.leftCols(found).adjoint() * v);
    if (v.squaredNorm() * mass_diagonal[row] < 1e-6) continue;
    Q.col(found++) = v.normalized();
  }
  if (found == B.cols()) B = (B * Q).eval();
  const ModelVector weight = mass_diagonal.cwiseSqrt();
  for (size_t k = 0; k < size; ++k) {
    ComplexVector shape = B.col(static_cast<Eigen::Index>(k));
    const Eigen::VectorXd amplitude = weight.cwiseProduct(shape.cwiseAbs());
    const bool platform = amplitude.head<6>().maxCoeff() > 1e-4;
    const double limit =
        (1.0 - 1e-6) * (platform ? amplitude.head<6>().maxCoeff() : amplitude.maxCoeff());
    Eigen::Index lead = 0;
    while (amplitude[lead] < limit) ++lead;
    shape *= std::conj(shape[lead]) / std::abs(shape[lead]) / std::sqrt(likeness(M, shape, shape));
    modes[first + k].real = shape.real();
    modes[first + k].imaginary = shape.imag();
  }
}

bool same_pole(const DampedMode& a, const DampedMode& b, double largest) {
  return std::abs(a.pole - b.pole) <
         std::max(1e-9 * std::abs(a.pole), 1e3 * std::numeric_limits<double>::epsilon() * largest);
}

}  // namespace

ModalRatio modal_ratio(const model::Machine& machine) {
  if (machine.damping.modal_ratio) return {*machine.damping.modal_ratio, false};
  if (has_viscous_damper(machine)) return {0.0, false};
  return {default_modal_ratio, true};
}

ModelMatrix modal_damping_matrix(const LinearModel& model, const NormalModes& modes, double ratio) {
  const int n = modes.size();
  ModelMatrix Gamma = ModelMatrix::Zero(n, n);
  if (!model.C.isZero(0.0)) Gamma = modes.shapes.transpose() * model.C * modes.shapes;
  for (int k = 0; k < n; ++k) Gamma(k, k) += 2.0 * ratio * modes.omega(k);
  return Gamma;
}

std::vector<DampedMode> damped_modes(const LinearModel& model, const NormalModes& modes,
                                     double ratio) {
  const ModelMatrix Gamma = modal_damping_matrix(model, modes, ratio);
  std::vector<DampedMode> list;
  if (is_diagonal(Gamma)) {
    for (int k = 0; k < modes.size(); ++k) list.push_back(real_mode(modes, k, Gamma(k, k)));
    return list;
  }
  Poles poles = solve_poles(modes, Gamma);
  list = collect(poles, model.M);
  std::stable_sort(list.begin(), list.end(),
                   [](const DampedMode& a, const DampedMode& b) { return a.omega < b.omega; });
  int group = 0;
  for (size_t first = 0; first < list.size(); ++group) {
    size_t size = 1;
    while (first + size < list.size() &&
           same_pole(list[first], list[first + size], list.back().omega))
      ++size;
    make_canonical(model.M, list, first, size);
    for (size_t k = first; k < first + size; ++k) list[k].group = group;
    first += size;
  }
  return list;
}

}  // namespace hydrapod::modal
