#include "hydrapod/modal/damped_modes.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "hydrapod/base/error.hpp"
#include "hydrapod/numerics/dense.hpp"

namespace hydrapod::modal {

namespace {

using Complex = std::complex<double>;
using ComplexVector = Eigen::Matrix<Complex, Eigen::Dynamic, 1>;
using ComplexMatrix = Eigen::MatrixXcd;

bool is_diagonal(const ModelMatrix& A) {
  constexpr double negligible = 1e-12;
  const ModelVector d = A.diagonal().cwiseAbs().cwiseSqrt();
  for (int i = 0; i < A.rows(); ++i)
    for (int j = 0; j < A.cols(); ++j)
      if (i != j && std::abs(A(i, j)) > negligible * (d[i] * d[j] + A.diagonal().maxCoeff() * 1e-3))
        return false;
  return true;
}

/// A z; a complex A would take twice the work.
ComplexVector times(const ModelMatrix& A, const ComplexVector& z) {
  ComplexVector product(A.rows());
  product.real() = A * z.real();
  product.imag() = A * z.imag();
  return product;
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

/// An eigenvalue λ of [0 I; −Ω² −Γ] with its shape.
struct Pole {
  Complex value{};
  ComplexVector shape{};  ///< in y, φᴴ M φ = 1
  /// Of a real pole: the sign of φᵀ (2λM + C) φ, positive for the slower one of an overdamped mode,
  /// negative for the faster one; the other way round where chambers that relax damp it. Both kinds
  /// are equally many.
  bool slow{};
  /// Share of the chambers' arms in it, 0…1: near 1 where the pole is one of pressures that even
  /// out, or of a platform that drifts while the valve leaks.
  double of_arms{};
  bool used{};
  [[nodiscard]] bool is_real() const { return value.imag() == 0.0; }
};

double same_pole_tolerance(const Complex& pole, double largest) {
  return std::max(1e-9 * std::abs(pole), 1e3 * std::numeric_limits<double>::epsilon() * largest);
}

/// Turns z so that its real and imaginary part are orthogonal, the longer one real.
ComplexVector with_orthogonal_parts(const ComplexVector& z) {
  const Complex sum = (z.array() * z.array()).sum();
  return z * std::polar(1.0, -0.5 * std::arg(sum));
}

/// Arms that relax, in the coordinates of the modes: z̈ = −Ω² z − Γ ż + Σ g ξ, ξ̇ = λ (g·z − ξ).
struct ModalArms {
  Eigen::MatrixXd g{};  ///< √κ Φᵀ s_y, a column per arm
  Eigen::VectorXd rates{};

  ModalArms(const LinearModel& model, const NormalModes& modes) {
    std::vector<const dynamics::RelaxingArm*> relaxing;  // without a rate an arm is a spring alone
    for (const auto& arm : model.arms)
      if (arm.rate > 0.0 && arm.stiffness > 0.0) relaxing.push_back(&arm);
    g.resize(modes.size(), static_cast<Eigen::Index>(relaxing.size()));
    rates.resize(g.cols());
    for (Eigen::Index j = 0; j < g.cols(); ++j) {
      const auto& arm = *relaxing[static_cast<std::size_t>(j)];
      g.col(j) = std::sqrt(arm.stiffness) * (modes.shapes.transpose() * arm.s_y);
      rates[j] = arm.rate;
    }
  }
  [[nodiscard]] Eigen::Index count() const { return rates.size(); }
};

/// The real poles and the upper half of the others.
class PoleSolver {
 public:
  PoleSolver(const NormalModes& modes, const ModelMatrix& Gamma, const ModalArms& arms)
      : modes_(modes), Gamma_(Gamma), arms_(arms) {}

  std::vector<Pole> solve() {
    const Eigen::Index n = modes_.size(), all = 2 * n + arms_.count();
    const double scale = std::sqrt(std::max(modes_.omega2.cwiseAbs().maxCoeff(), 1e-300));
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(all, all);
    A.block(0, n, n, n).setIdentity();
    A.block(n, 0, n, n).diagonal() = -modes_.omega2 / (scale * scale);
    A.block(n, n, n, n) = -Gamma_ / scale;
    A.block(n, 2 * n, n, arms_.count()) = arms_.g / scale;
    for (Eigen::Index j = 0; j < arms_.count(); ++j) {
      A.row(2 * n + j).head(n) = arms_.rates[j] / (scale * scale) * arms_.g.col(j).transpose();
      A(2 * n + j, 2 * n + j) = -arms_.rates[j] / scale;
    }
    const auto [values, vectors, converged] = numerics::eigen_pairs(A);
    if (!converged) throw base::ComputationError("the damped modes did not converge");
    const double largest = values.cwiseAbs().maxCoeff();
    for (Eigen::Index k = 0; k < all; ++k) {
      const Complex value = values[k];
      if (value.imag() < 0.0) continue;
      const auto before = poles_.size();
      add(value, vectors.col(k).head(n), scale, nearly_real(value, largest));
      const double share = share_of_arms(value, vectors.col(k), scale);
      for (auto j = before; j < poles_.size(); ++j) poles_[j].of_arms = share;
    }
    drop_arms();
    return poles_;
  }

 private:
  const NormalModes& modes_;
  const ModelMatrix& Gamma_;
  const ModalArms& arms_;
  std::vector<Pole> poles_;

  /// Imaginary parts below it are rounding. Equal seals of six legs have many equal poles, of which
  /// it makes more.
  [[nodiscard]] double nearly_real(const Complex& value, double largest) const {
    constexpr double of_equal_arms = 1e-6;
    const double same = same_pole_tolerance(value, largest);
    return arms_.count() == 0 ? same : std::max(same, of_equal_arms * std::abs(value));
  }

  /// What arms add to zᵀ (2λ + Γ) z, the derivative of the dynamic stiffness.
  [[nodiscard]] double by_arms(double value, const Eigen::VectorXd& z) const {
    double sum = 0.0;
    for (Eigen::Index j = 0; j < arms_.count(); ++j) {
      const double part = arms_.g.col(j).dot(z) / (value + arms_.rates[j]);
      sum += arms_.rates[j] * part * part;
    }
    return sum;
  }

  /// By the products of right and left vector, which is (…, z, ξ/λ): of the arms and of z and ż.
  [[nodiscard]] double share_of_arms(const Complex& value, const ComplexVector& x,
                                     double scale) const {
    if (arms_.count() == 0) return 0.0;
    const Eigen::Index n = modes_.size();
    const ComplexVector z = x.head(n);
    double of_arms = 0.0;
    for (Eigen::Index j = 0; j < arms_.count(); ++j)
      of_arms += std::norm(x[2 * n + j]) / (arms_.rates[j] / scale);
    const ComplexVector damped = value * z + Gamma_ * z / scale;
    const double of_motion = std::abs(z.dot(damped)) + std::abs(value) * z.squaredNorm();
    return of_arms / (of_arms + of_motion);
  }

  /// Every arm has a pole that is no mode: the real ones of which arms have the largest share.
  /// Rounding can make a pair of several that are zero.
  void drop_arms() {
    constexpr double arms_alone = 0.9;
    auto left = arms_.count();
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < poles_.size(); ++k)
      if (poles_[k].is_real() || poles_[k].of_arms > arms_alone) order.push_back(k);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return poles_[a].of_arms > poles_[b].of_arms;
    });
    for (const auto k : order) {
      const int count = poles_[k].is_real() ? 1 : 2;
      if (left < count) break;
      left -= count;
      poles_[k].used = true;
    }
    std::erase_if(poles_, [](const Pole& pole) { return pole.used; });
  }

  /// Two equal real poles come out of the eigensolver as a pair a hair off the real axis: its real
  /// and imaginary part are then two shapes of one real pole.
  void add(const Complex& value, const ComplexVector& z, double scale, double same) {
    if (value.imag() == 0.0) return add_real(scale * value.real(), z.real());
    if (value.imag() < same) {
      constexpr double apart = 1e-6;  // else the pole has one shape only: critical damping
      const ComplexVector split = with_orthogonal_parts(z);
      const bool two_shapes = split.imag().norm() > apart * split.norm();
      if (two_shapes || arms_.count() > 0) {  // or one shape of two poles of arms
        add_real(scale * value.real(), split.real());
        add_real(scale * value.real(),
                 two_shapes ? Eigen::VectorXd(split.imag()) : Eigen::VectorXd(split.real()));
        return;
      }
    }
    poles_.push_back({.value = scale * value, .shape = times(modes_.shapes, z / z.norm())});
  }

  void add_real(double value, const Eigen::VectorXd& z) {
    const Eigen::VectorXd unit = z.normalized();
    const Eigen::VectorXd shape = modes_.shapes * unit;
    poles_.push_back({.value = value,
                      .shape = shape.cast<Complex>(),
                      .slow = 2.0 * value + unit.dot(Gamma_ * unit) + by_arms(value, unit) > 0.0});
  }
};

/// |aᴴ M b|: 1 for equal shapes, both normalised.
double likeness(const ModelMatrix& M, const ComplexVector& a, const ComplexVector& b) {
  return std::abs(a.dot(times(M, b)));
}

/// The unused real pole of the other kind whose shape is most like that of pole `k`; −1 if there is
/// none of the other kind, and then any real one.
int partner(const std::vector<Pole>& poles, const ModelMatrix& M, int k) {
  int best = -1;
  double most_alike = -1.0;
  for (int j = 0; j < static_cast<int>(poles.size()); ++j) {
    if (j == k || poles[j].used || !poles[j].is_real()) continue;
    const double other_kind = poles[j].slow != poles[k].slow ? 1.0 : 0.0;
    const double now = other_kind + likeness(M, poles[k].shape, poles[j].shape);
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

DampedMode oscillating(const Pole& pole) {
  DampedMode mode = from_shape(pole.shape);
  mode.pole = pole.value;
  mode.omega = std::abs(pole.value);
  mode.damping_ratio = -pole.value.real() / mode.omega;
  mode.stable = pole.value.real() <= 1e-12 * mode.omega;
  return mode;
}

/// Two real poles as one overdamped (or, with opposite signs, unstable) mode.
DampedMode overdamped(const Pole& a, const Pole& b) {
  const bool a_is_slower = std::abs(a.value) <= std::abs(b.value);
  const double slow = (a_is_slower ? a : b).value.real();
  const double fast = (a_is_slower ? b : a).value.real();
  DampedMode mode = from_shape((a_is_slower ? a : b).shape);
  mode.pole = slow;
  mode.stable = slow < 0.0 && fast < 0.0;
  mode.omega = slow * fast > 0.0 ? std::sqrt(slow * fast) : 0.0;
  mode.damping_ratio = mode.omega > 0.0 ? -(slow + fast) / (2.0 * mode.omega) : 0.0;
  return mode;
}

std::vector<DampedMode> collect(std::vector<Pole>& poles, const ModelMatrix& M) {
  std::vector<DampedMode> list;
  for (int k = 0; k < static_cast<int>(poles.size()); ++k) {
    if (poles[k].used) continue;
    poles[k].used = true;
    if (!poles[k].is_real()) {
      list.push_back(oscillating(poles[k]));
    } else if (const int j = partner(poles, M, k); j >= 0) {
      poles[j].used = true;
      list.push_back(overdamped(poles[k], poles[j]));
    }
  }
  return list;
}

/// Unitary Q so that B Q is the canonical basis of a group with the M-orthonormal shapes B: the
/// first takes all motion in x, the next all that is left in y, ….
ComplexMatrix canonical_rotation(const ModelVector& mass_diagonal, const ComplexMatrix& B) {
  constexpr double enough = 1e-6;  // share of a mode's energy that a coordinate must hold to lead
  ComplexMatrix Q(B.cols(), B.cols());
  Eigen::Index found = 0;
  for (Eigen::Index row = 0; row < B.rows() && found < B.cols(); ++row) {
    ComplexVector v = B.row(row).adjoint();
    for (int pass = 0; pass < 2; ++pass) v -= Q.leftCols(found) * (Q.leftCols(found).adjoint() * v);
    if (v.squaredNorm() * mass_diagonal[row] < enough) continue;
    Q.col(found++) = v.normalized();
  }
  return found == B.cols() ? Q : ComplexMatrix::Identity(B.cols(), B.cols());
}

/// `shape` turned so that its leading component is real and positive, φᴴ M φ = 1.
ComplexVector with_canonical_phase(const ModelMatrix& M, const ComplexVector& shape) {
  const Eigen::VectorXd amplitude =
      M.diagonal().cwiseSqrt().cwiseProduct(shape.cwiseAbs().eval()).eval();
  constexpr double platform_moves = 1e-4;
  constexpr double tie = 1.0 - 1e-6;
  const double of_platform = amplitude.head<6>().maxCoeff();
  const double limit = tie * (of_platform > platform_moves ? of_platform : amplitude.maxCoeff());
  Eigen::Index lead = 0;
  while (amplitude[lead] < limit) ++lead;
  const Complex phase = std::conj(shape[lead]) / std::abs(shape[lead]);
  return shape * (phase / std::sqrt(likeness(M, shape, shape)));
}

void make_canonical(const ModelMatrix& M, std::vector<DampedMode>& modes, size_t first,
                    size_t size) {
  ComplexMatrix B(modes[first].real.size(), static_cast<Eigen::Index>(size));
  for (size_t k = 0; k < size; ++k)
    B.col(static_cast<Eigen::Index>(k)) =
        modes[first + k].real.cast<Complex>() +
        Complex(0, 1) * modes[first + k].imaginary.cast<Complex>();
  ComplexMatrix M_B(B.rows(), B.cols());
  for (Eigen::Index k = 0; k < B.cols(); ++k) M_B.col(k) = times(M, B.col(k));
  const ComplexMatrix gram = B.adjoint() * M_B;  // equal poles leave any basis
  const ComplexMatrix upper = Eigen::LLT<ComplexMatrix>(gram).matrixU();
  B = upper.triangularView<Eigen::Upper>().solve<Eigen::OnTheRight>(B).eval();
  B = (B * canonical_rotation(M.diagonal(), B)).eval();
  for (size_t k = 0; k < size; ++k) {
    const ComplexVector shape = with_canonical_phase(M, B.col(static_cast<Eigen::Index>(k)));
    modes[first + k].real = shape.real();
    modes[first + k].imaginary = shape.imag();
  }
}

bool same_pole(const DampedMode& a, const DampedMode& b, double largest) {
  return std::abs(a.pole - b.pole) < same_pole_tolerance(a.pole, largest);
}

}  // namespace

double relaxed_damping(std::span<const dynamics::RelaxingArm> arms, const ModelVector& phi,
                       double omega) {
  double damping = 0.0;
  for (const auto& arm : arms)
    if (arm.rate > 0.0) damping += damper_at(arm, omega) * std::pow(arm.s_y.dot(phi), 2);
  return damping;
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
  const ModalArms arms(model, modes);
  std::vector<DampedMode> list;
  if (arms.count() == 0 && is_diagonal(Gamma)) {
    for (int k = 0; k < modes.size(); ++k) list.push_back(real_mode(modes, k, Gamma(k, k)));
    return list;
  }
  auto poles = PoleSolver(modes, Gamma, arms).solve();
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

std::vector<int> damped_counterparts(const LinearModel& model, const NormalModes& modes,
                                     const std::vector<DampedMode>& damped) {
  const ModelMatrix momenta = model.M * modes.shapes;
  const auto found = static_cast<Eigen::Index>(damped.size());
  Eigen::MatrixXd alike = Eigen::MatrixXd::Zero(modes.size(), found + modes.size());
  for (Eigen::Index j = 0; j < found; ++j) {
    const auto& mode = damped[static_cast<std::size_t>(j)];
    alike.col(j) = (momenta.transpose() * mode.real).cwiseAbs2() +
                   (momenta.transpose() * mode.imaginary).cwiseAbs2();
  }
  auto counterparts = numerics::assign((alike.maxCoeff() - alike.array()).matrix());
  for (int& number : counterparts)
    if (number >= found) number = -1;
  return counterparts;
}

NormalModes modes_with_elastomers(const model::Machine& machine, const LinearModel& model) {
  const auto modes = normal_modes(model);
  if (model.kind == dynamics::ModelKind::rigid || !model::has_elastomers(machine)) return modes;
  const auto damped = damped_modes(model, modes, modal_ratio(machine).value);
  const auto counterparts = damped_counterparts(model, modes, damped);
  ModelVector squares = modes.omega2;
  for (int k = 0; k < modes.size(); ++k) {
    const int number = counterparts[static_cast<std::size_t>(k)];
    if (number < 0 || !(modes.omega2[k] > 0.0)) continue;
    const auto& mode = damped[static_cast<std::size_t>(number)];
    if (mode.pole.imag() > 0.0) squares[k] = mode.omega * mode.omega;
  }
  std::vector<int> order(static_cast<std::size_t>(modes.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return squares[a] < squares[b]; });
  NormalModes result = modes;
  for (int k = 0, group = 0; k < modes.size(); ++k) {
    const int from = order[static_cast<std::size_t>(k)];
    result.omega2[k] = squares[from];
    result.shapes.col(k) = modes.shapes.col(from);
    if (k > 0 && result.omega2[k] - result.omega2[k - 1] > repeated_tolerance * result.omega2[k])
      ++group;
    result.group[k] = group;
  }
  return result;
}

}  // namespace hydrapod::modal
