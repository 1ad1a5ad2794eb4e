#include "poles.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>


namespace hydrapod::calibration {

namespace {

using Complex = std::complex<double>;

/// D(s) of a point.
class DynamicStiffness {
 public:
  /// `point` must outlive it.
  DynamicStiffness(const ModePoint& point, double modal_ratio)
      : point_(point),
        modal_ratio_(modal_ratio),
        omega_(point.modes.omega2.cwiseMax(0.0).cwiseSqrt()),
        momenta_(point.model.M * point.modes.shapes),
        C_(point.model.C) {
    if (modal_ratio != 0.0)
      C_ += 2.0 * modal_ratio * momenta_ * omega_.asDiagonal() * momenta_.transpose();
  }

  /// The damped mode that the undamped mode `mode` is, with the undamped shape; none where the
  /// iteration leads to another one, or to none that oscillates.
  [[nodiscard]] std::optional<modal::DampedMode> damped(int mode) const;
  /// A damped mode, and what its derivatives by all parameters take.
  struct Mode {
    int number{};
    Complex pole{}, by_pole{};
    Eigen::VectorXcd y{}, parts{};  ///< Φᵀ M y
  };
  [[nodiscard]] Mode known(int number) const;
  /// Change of the damping by the modal ratio per change of a parameter, of undamped modes.
  [[nodiscard]] Eigen::MatrixXd ratio_damping(Eigen::Index parameter) const;
  /// dλ per change of it; `damping`: its ratio_damping().
  [[nodiscard]] Complex change(const Mode& mode, Eigen::Index parameter,
                               const Eigen::MatrixXd& damping) const;

 private:
  [[nodiscard]] Eigen::MatrixXcd at(Complex s) const {
    const auto& model = point_.model;
    Eigen::MatrixXcd D = s * s * model.M + s * C_ + model.K;
    for (const auto& arm : model.arms) {
      const Eigen::MatrixXd pressed = arm.stiffness * arm.rate * arm.s_y * arm.s_y.transpose();
      D -= pressed / (s + arm.rate);
    }
    return D;
  }
  /// D'(s).
  [[nodiscard]] Eigen::MatrixXcd slope(Complex s) const {
    const auto& model = point_.model;
    Eigen::MatrixXcd slope = 2.0 * s * model.M + C_;
    for (const auto& arm : model.arms) {
      const Eigen::MatrixXd pressed = arm.stiffness * arm.rate * arm.s_y * arm.s_y.transpose();
      slope += pressed / ((s + arm.rate) * (s + arm.rate));
    }
    return slope;
  }
  [[nodiscard]] Complex root(const Eigen::VectorXcd& y, Complex near) const;
  [[nodiscard]] Eigen::VectorXcd shape(int mode, Complex pole) const;

  const ModePoint& point_;
  double modal_ratio_;
  Eigen::VectorXd omega_;    // undamped
  Eigen::MatrixXd momenta_;  // M Φ
  Eigen::MatrixXd C_;
};

/// Of yᵀ D(s) y, by Newton's method.
Complex DynamicStiffness::root(const Eigen::VectorXcd& y, Complex near) const {
  const auto& model = point_.model;
  const auto along = [&](const auto& matrix) -> Complex { return y.transpose() * (matrix * y); };
  const Complex a = along(model.M), b = along(C_), c = along(model.K);
  std::vector<Complex> pressed;
  for (const auto& arm : model.arms) {
    const Complex stretch = arm.s_y.cast<Complex>().transpose() * y;
    pressed.push_back(arm.stiffness * arm.rate * stretch * stretch);
  }
  constexpr int most = 20;
  constexpr double rounding = 1e-15;
  Complex s = near;
  for (int n = 0; n < most; ++n) {
    Complex value = (a * s + b) * s + c, slope = 2.0 * a * s + b;
    for (std::size_t j = 0; j < pressed.size(); ++j) {
      const Complex beside = s + model.arms[j].rate;
      value -= pressed[j] / beside;
      slope += pressed[j] / (beside * beside);
    }
    const Complex step = value / slope;
    s -= step;
    if (!(std::abs(step) > rounding * std::abs(s))) break;
  }
  return s;
}

std::optional<modal::DampedMode> DynamicStiffness::damped(int mode) const {
  const auto& model = point_.model;
  const auto& modes = point_.modes;
  if (!(modes.omega2[mode] > 0.0)) return {};
  Eigen::VectorXcd y = modes.shapes.col(mode).cast<Complex>();
  Complex pole = root(y, {0.0, modes.omega(mode)});
  constexpr int most = 12;
  constexpr double converged = 1e-13;
  bool found = false;
  for (int n = 0; n < most && !found; ++n) {
    // at the pole itself D has no inverse; beside it, y converges as well
    constexpr double away = 1e-9;
    const Eigen::VectorXcd force = slope(pole) * y;
    y = at(pole * (1.0 + away)).partialPivLu().solve(force).normalized();
    const Complex next = root(y, pole);
    if (!std::isfinite(next.real()) || !std::isfinite(next.imag())) return {};
    found = std::abs(next - pole) <= converged * std::abs(next);
    pole = next;
  }
  if (!found || !(pole.imag() > 0.0)) return {};
  double alike = 0.0;
  for (int k = 0; k < modes.size(); ++k)
    if (modes.group[k] == modes.group[mode])
      alike += std::norm((momenta_.col(k).cast<Complex>().transpose() * y).value());
  constexpr double same_mode = 0.5;  // MAC: it can be so much of one mode only
  if (!(alike > same_mode * (y.adjoint() * (model.M * y)).value().real())) return {};
  const double omega = std::abs(pole);
  return modal::DampedMode{.pole = pole,
                           .omega = omega,
                           .damping_ratio = -pole.real() / omega,
                           .stable = !(pole.real() > 0.0),
                           .real = modes.shapes.col(mode),
                           .imaginary = dynamics::ModelVector::Zero(modes.shapes.rows()),
                           .group = modes.group[mode]};
}

/// By two steps of inverse iteration from the undamped shape, beside the pole: where poles repeat,
/// D(λ) is singular in every direction of their modes. Each step takes `away` · ω over their
/// distance of modes nearby.
Eigen::VectorXcd DynamicStiffness::shape(int mode, Complex pole) const {
  constexpr double away = 1e-6;  // of λ
  const auto factors = at(pole * (1.0 + away)).partialPivLu();
  Eigen::VectorXcd y = factors.solve(momenta_.col(mode).cast<Complex>()).normalized();
  const Eigen::VectorXcd force = slope(pole) * y;
  y = factors.solve(force).normalized();
  return y;
}

DynamicStiffness::Mode DynamicStiffness::known(int number) const {
  const Complex pole = point_.damped_mode(number)->pole;
  const Eigen::VectorXcd y = shape(number, pole);
  return {.number = number,
          .pole = pole,
          .by_pole = y.transpose() * (slope(pole) * y),
          .y = y,
          .parts = momenta_.transpose() * y};
}

Eigen::MatrixXd DynamicStiffness::ratio_damping(Eigen::Index parameter) const {
  const auto& of = point_.derivatives[static_cast<std::size_t>(parameter)];
  const auto& shapes = point_.modes.shapes;
  Eigen::MatrixXd change =
      (2.0 * point_.ratio_derivatives[static_cast<std::size_t>(parameter)] * omega_).asDiagonal();
  if (modal_ratio_ == 0.0) return change;
  const Eigen::MatrixXd dK = shapes.transpose() * of.K * shapes,
                        dM = shapes.transpose() * of.M * shapes;
  for (Eigen::Index j = 0; j < omega_.size(); ++j)
    for (Eigen::Index k = 0; k < omega_.size(); ++k)
      if (const double sum = omega_[j] + omega_[k]; sum > 0.0)
        change(j, k) += 2.0 * modal_ratio_ * (dK(j, k) + omega_[j] * omega_[k] * dM(j, k)) / sum;
  return change;
}

/// −yᵀ dD y over yᵀ D' y.
Complex DynamicStiffness::change(const Mode& mode, Eigen::Index parameter,
                                 const Eigen::MatrixXd& damping) const {
  const auto& of = point_.derivatives[static_cast<std::size_t>(parameter)];
  const auto& [number, pole, by_pole, y, parts] = mode;
  const auto along = [&](const auto& matrix, const Eigen::VectorXcd& v) -> Complex {
    return v.transpose() * (matrix * v);
  };
  const auto relaxed = [&](const std::vector<dynamics::RelaxingArm>& arms) {
    Complex sum = 0.0;
    for (const auto& arm : arms) {
      const Complex stretch = arm.s_y.cast<Complex>().transpose() * y;
      sum += arm.stiffness * arm.rate / (pole + arm.rate) * stretch * stretch;
    }
    return sum;
  };
  Complex dD = pole * pole * along(of.M, y) + along(of.K, y) +
               pole * (along(of.C, y) + along(damping, parts));
  if (of.step > 0.0) dD -= (relaxed(of.arms_above) - relaxed(of.arms_below)) / (2.0 * of.step);
  return -dD / by_pole;
}

}  // namespace

bool is_shifted_by_damping(const dynamics::LinearModel& model) {
  return !model.C.isZero(0.0) || !model.arms.empty();
}

void add_damped(double modal_ratio, ModePoint& point) {
  const auto damped = modal::damped_modes(point.model, point.modes, modal_ratio);
  const auto counterparts = modal::damped_counterparts(point.model, point.modes, damped);
  point.damped.assign(counterparts.size(), {});
  for (std::size_t k = 0; k < counterparts.size(); ++k) {
    if (counterparts[k] < 0) continue;
    const auto& mode = damped[static_cast<std::size_t>(counterparts[k])];
    if (mode.pole.imag() > 0.0) point.damped[k] = mode;
  }
}

void add_damped(double modal_ratio, const std::vector<int>& modes, ModePoint& point) {
  const DynamicStiffness stiffness(point, modal_ratio);
  std::vector<std::optional<modal::DampedMode>> found(static_cast<std::size_t>(point.modes.size()));
  bool all = true;
  for (std::size_t i = 0; i < modes.size() && all; ++i) {
    auto mode = stiffness.damped(modes[i]);
    constexpr double same = 1e-9;
    for (std::size_t j = 0; mode && j < i; ++j) {
      const auto& other = *found[static_cast<std::size_t>(modes[j])];
      if (other.group != mode->group && std::abs(other.pole - mode->pole) < same * mode->omega)
        mode.reset();
    }
    all = mode.has_value();
    found[static_cast<std::size_t>(modes[i])] = std::move(mode);
  }
  if (!all) {
    add_damped(modal_ratio, point);
    std::swap(found, point.damped);
    for (std::size_t k = 0; k < found.size(); ++k) {
      auto& of_all = point.damped[k];
      of_all.reset();
      if (!found[k] || std::ranges::count(modes, static_cast<int>(k)) == 0) continue;
      of_all = std::move(found[k]);
      of_all->real = point.modes.shapes.col(static_cast<Eigen::Index>(k));
      of_all->imaginary.setZero();
    }
    return;
  }
  point.damped = std::move(found);
}

void add_pole_derivatives(double modal_ratio, ModePoint& point) {
  const auto count = static_cast<Eigen::Index>(point.derivatives.size());
  point.dpole_omega.setZero(point.modes.size(), count);
  point.dpole_ratio.setZero(point.modes.size(), count);
  const DynamicStiffness stiffness(point, modal_ratio);
  std::vector<DynamicStiffness::Mode> known;
  for (int k = 0; k < point.modes.size(); ++k)
    if (point.damped_mode(k) != nullptr) known.push_back(stiffness.known(k));
  for (Eigen::Index j = 0; j < count; ++j) {
    const Eigen::MatrixXd damping = stiffness.ratio_damping(j);
    for (const auto& mode : known) {
      const Complex dpole = stiffness.change(mode, j, damping);
      const auto& damped = *point.damped_mode(mode.number);
      double& domega = point.dpole_omega(mode.number, j);
      domega = (std::conj(mode.pole) * dpole).real() / damped.omega;
      point.dpole_ratio(mode.number, j) =
          -(dpole.real() + damped.damping_ratio * domega) / damped.omega;
    }
  }
}

}  // namespace hydrapod::calibration
