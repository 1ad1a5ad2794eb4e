#pragma once
/// Swings of the plant at an amplitude that lasts.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/simulation/plant.hpp"
#include "support/classical_step.hpp"

namespace hydrapod::simulation {

/// How far the platform joint that moves most goes at the neutral pose, per motion of the platform.
inline double joint_motion(const model::Machine& machine, const Vector6& motion) {
  double largest = 0.0;
  for (const auto& leg : machine.legs) {
    const Vector3 arm =
        machine.neutral().R_BP * (leg.platform_joint - machine.platform.mass_center);
    const Vector3 v = motion.head<3>(), w = motion.tail<3>();
    largest = std::max(largest, (v + w.cross(arm)).norm());
  }
  return largest;
}

/// A wrench along the motion of one mode makes up for its damping: c (bᵀ v) b with b = M_p φ_p,
/// where c is larger the smaller the amplitude is.
class SustainedSwing {
 public:
  /// `slope`: how much c grows as the amplitude falls. A loss that grows with the amplitude alone,
  /// as that of friction that slides, needs more than 0.5. Begins at rest where the mode turns, or
  /// with `blocked` cylinders, whose oil would be compressed there, at its velocity through rest.
  SustainedSwing(const model::Machine& machine, ModelKind kind, const modal::ModeAtAmplitude& point,
                 bool blocked = false, double slope = 0.5)
      : plant_(machine, kind,
               {.hydraulics = blocked, .friction = blocked ? Friction::all : Friction::none}),
        shape_(point.shape.head<6>()),
        b_(dynamics::linear_model(machine, machine.neutral(), kind).platform_mass * shape_),
        own_(shape_.dot(b_)),
        omega_(point.omega),
        damping_(2.0 * point.damping_ratio * point.omega / (own_ * own_)),
        slope_(slope) {
    auto rest = plant_.equilibrium(machine.neutral());
    rest_ = std::move(rest.x);
    input_ = rest.input;
    joint_ = joint_motion(machine, shape_);
    amplitude_ = point.amplitude / joint_;
    Eigen::VectorXd change = Eigen::VectorXd::Zero(plant_.layout().tangent());
    if (blocked)  // a change of the pose has three numbers for the rotation, the state has four
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
      x_ = test::classical_step([this](const Eigen::VectorXd& x) { return rate(x); }, x_, step);
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

  Plant plant_;
  Eigen::VectorXd rest_, x_{};
  PlantInput input_;
  Vector6 shape_, b_;
  double own_, omega_, damping_, slope_, joint_{}, amplitude_{}, squares_of_rate_{};
  int crossings_{};
};

/// How near swings of the plant come to the harmonic balance: of the amplitude that was asked for,
/// of the frequency in ζ, of ζ.
struct SwingTolerance {
  double amplitude{}, frequency{}, damping{};
};

/// Swings of the lowest mode of the rigid-leg model with blocked cylinders against the balance at
/// the amplitude that comes out; the highest of the frequencies over the lowest.
inline double swing_as_in_the_balance(const model::Machine& machine,
                                      const std::vector<double>& amplitudes,
                                      const SwingTolerance& tolerance) {
  constexpr auto kind = ModelKind::rigid;
  const auto balance = [&](const std::vector<double>& at) {
    return modal::modes_at_amplitudes(machine, machine.neutral(), kind, at).front();
  };
  std::vector<double> frequencies;
  for (const auto& point : balance(amplitudes).points) {
    EXPECT_TRUE(point.converged);
    SustainedSwing sustained(machine, kind, point, true, 2.0);
    const auto found = sustained.swing(2.0, 40, 1.2e-4);
    EXPECT_NEAR(found.amplitude, point.amplitude, tolerance.amplitude * point.amplitude);
    const auto there = balance({found.amplitude}).points.front();
    EXPECT_TRUE(there.converged);
    // the higher harmonics that the balance leaves out grow with the loss
    const double zeta = there.damping_ratio;
    EXPECT_NEAR(found.omega, there.omega, tolerance.frequency * zeta * there.omega)
        << found.amplitude;
    EXPECT_NEAR(found.damping_ratio, zeta, tolerance.damping * zeta) << found.amplitude;
    fmt::print("{:.3g} m: {:.5g} rad/s (balance {:.5g}), {:.4g} ({:.4g})\n", found.amplitude,
               found.omega, there.omega, found.damping_ratio, zeta);
    frequencies.push_back(found.omega);
  }
  return std::ranges::max(frequencies) / std::ranges::min(frequencies);
}

}  // namespace hydrapod::simulation
