#pragma once
/// Swings of the plant at an amplitude that lasts.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/simulation/plant.hpp"

namespace hydrapod::simulation {

/// A wrench along the motion of one mode makes up for its damping: c (bᵀ v) b with b = M_p φ_p,
/// where c is larger the smaller the amplitude is. Classical Runge–Kutta.
class SustainedSwing {
 public:
  /// `slope`: how much c grows as the amplitude falls. A loss that grows with the amplitude alone,
  /// as that of friction that slides, needs more than 0.5. Begins at rest where the mode turns, or
  /// with `blocked` cylinders, whose oil would be compressed there, at its velocity through rest.
  SustainedSwing(const model::Machine& machine, ModelKind kind, const modal::ModeAtAmplitude& point,
                 bool blocked = false, double slope = 0.5)
      : plant_(machine, kind,
               {.hydraulics = blocked, .friction = blocked ? Friction::all : Friction::none}),
        rest_(plant_.equilibrium(machine.neutral()).x),
        input_(plant_.equilibrium(machine.neutral()).input),
        shape_(point.shape.head<6>()),
        b_(dynamics::linear_model(machine, machine.neutral(), kind).platform_mass * shape_),
        own_(shape_.dot(b_)),
        omega_(point.omega),
        damping_(2.0 * point.damping_ratio * point.omega / (own_ * own_)),
        slope_(slope) {
    for (const auto& leg : machine.legs) {
      const Vector3 arm =
          machine.neutral().R_BP * (leg.platform_joint - machine.platform.mass_center);
      const Vector3 v = shape_.head<3>(), w = shape_.tail<3>();
      joint_ = std::max(joint_, (v + w.cross(arm)).norm());
    }
    amplitude_ = point.amplitude / joint_;
    Eigen::VectorXd change = Eigen::VectorXd::Zero(plant_.layout().tangent());
    if (blocked)
      change.segment(plant_.layout().velocity() - 1, point.shape.size()) =
          point.shape * (amplitude_ * omega_);
    else
      change.head(point.shape.size()) = point.shape * amplitude_;
    x_.resize(plant_.layout().size);
    plant_.displace(rest_.data(), change.data(), x_.data());
  }

  struct Found {
    double amplitude{}, omega{}, damping_ratio{};
  };

  /// Means over so many periods, from a time on.
  Found swing(double settled, int periods, double step = 2.5e-4) {
    double first = -1.0, before = coordinate(x_), squares = 0.0, gains = 0.0;
    long steps = 0;
    for (double t = 0.0; t < 100.0;) {
      advance(step);
      t += step;
      const double now = coordinate(x_);
      const bool crosses = before < 0.0 && now >= 0.0;
      const double at = t - step * now / (now - before);
      before = now;
      if (t < settled) continue;
      if (crosses && first < 0.0) {
        first = at;
        crossings_ = 0;
      } else if (crosses && ++crossings_ == periods) {
        const auto n = static_cast<double>(steps);
        const double omega = 2.0 * std::numbers::pi * periods / (at - first);
        return {joint_ * std::sqrt(2.0 * squares / n), omega,
                gains / squares_of_rate_ * own_ * own_ / (2.0 * omega)};
      }
      if (first < 0.0) continue;
      squares += now * now;
      gains += gain(x_) * std::pow(rate_of(x_), 2);
      squares_of_rate_ += std::pow(rate_of(x_), 2);
      ++steps;
    }
    ADD_FAILURE() << "it does not swing";
    return {};
  }

 private:
  [[nodiscard]] double coordinate(const Eigen::VectorXd& x) const {
    const Eigen::Quaterniond q(x[3], x[4], x[5], x[6]), q_0(rest_[3], rest_[4], rest_[5], rest_[6]);
    const Eigen::AngleAxisd turned(q.normalized() * q_0.normalized().conjugate());
    const double angle = turned.angle() > std::numbers::pi ? turned.angle() - 2.0 * std::numbers::pi
                                                           : turned.angle();
    Vector6 motion;
    motion << x.head<3>() - rest_.head<3>(), angle * turned.axis();
    return b_.dot(motion) / own_;
  }
  [[nodiscard]] double rate_of(const Eigen::VectorXd& x) const {
    return b_.dot(x.segment<6>(plant_.layout().velocity())) / own_;
  }
  [[nodiscard]] double gain(const Eigen::VectorXd& x) const {
    const double a = std::hypot(coordinate(x), rate_of(x) / omega_) / amplitude_;
    return damping_ * (1.0 + slope_ * (1.0 - a * a));
  }
  [[nodiscard]] Eigen::VectorXd rate(const Eigen::VectorXd& x) const {
    Eigen::VectorXd result(x.size());
    PlantInput input = input_;
    input.wrench = gain(x) * rate_of(x) * own_ * b_;
    EXPECT_TRUE(plant_.derivative(0.0, x.data(), input, result.data()));
    return result;
  }
  void advance(double h) {
    const Eigen::VectorXd k1 = rate(x_), k2 = rate(x_ + 0.5 * h * k1), k3 = rate(x_ + 0.5 * h * k2),
                          k4 = rate(x_ + h * k3);
    x_ += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }

  Plant plant_;
  Eigen::VectorXd rest_, x_{};
  PlantInput input_;
  Vector6 shape_, b_;
  double own_, omega_, damping_, slope_, joint_{}, amplitude_{}, squares_of_rate_{};
  int crossings_{};
};

}  // namespace hydrapod::simulation
