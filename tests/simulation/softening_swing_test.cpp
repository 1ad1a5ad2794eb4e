/// Swings of the plant that last, with elastomers that soften, against the harmonic balance.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/simulation/plant.hpp"
#include "support/symmetric_machine.hpp"

namespace hydrapod::simulation {
namespace {

using Eigen::VectorXd;
using modal::ModeAtAmplitude;

constexpr double swing_softening_time = 0.43;

/// Under a weight that its seals carry; no two legs are alike, so that x and y are apart.
model::Machine heavy_machine(bool bends) {
  auto machine = test::symmetric_machine(9.81);
  machine.damping.modal_ratio = 0.0;
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    auto& leg = machine.legs[i];
    leg.guide_sleeve.stiffness *= i < 2 ? 1.9 : 2.3 + 0.1 * static_cast<double>(i);
    leg.guide_sleeve.elastomer = {.dynamic_ratio = 1.4,
                                  .loss_factor = 0.12,
                                  .frequency = 8.3,
                                  .softening = 0.37,
                                  .softening_amplitude = 1.7e-4,
                                  .softening_time = swing_softening_time};
    if (!bends) continue;
    leg.bending = model::LegBending::elastic;
    leg.rod.diameter = 0.036;
    leg.rod.wall = 0.009;
    leg.cylinder_case.diameter = 0.061;
    leg.cylinder_case.wall = 0.0047;
  }
  return machine;
}

/// A wrench along the motion of one mode makes up for its damping: c (bᵀ v) b with b = M_p φ_p,
/// where c is larger the smaller the amplitude is. Classical Runge–Kutta.
class Sustained {
 public:
  Sustained(const model::Machine& machine, ModelKind kind, const ModeAtAmplitude& point)
      : plant_(machine, kind, {.hydraulics = false, .friction = Friction::none}),
        rest_(plant_.equilibrium(machine.neutral()).x),
        shape_(point.shape.head<6>()),
        b_(dynamics::linear_model(machine, machine.neutral(), kind).platform_mass * shape_),
        own_(shape_.dot(b_)),
        omega_(point.omega),
        damping_(2.0 * point.damping_ratio * point.omega / (own_ * own_)) {
    for (const auto& leg : machine.legs) {
      const Vector3 arm =
          machine.neutral().R_BP * (leg.platform_joint - machine.platform.mass_center);
      const Vector3 v = shape_.head<3>(), w = shape_.tail<3>();
      joint_ = std::max(joint_, (v + w.cross(arm)).norm());
    }
    amplitude_ = point.amplitude / joint_;
    VectorXd change = VectorXd::Zero(plant_.layout().tangent());
    change.head(point.shape.size()) = point.shape * amplitude_;
    x_.resize(plant_.layout().size);
    plant_.displace(rest_.data(), change.data(), x_.data());
  }

  struct Found {
    double amplitude{}, omega{}, damping_ratio{};
  };

  /// Means over so many periods, from a time on.
  Found swing(double settled, int periods) {
    constexpr double step = 2.5e-4;
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
  [[nodiscard]] double coordinate(const VectorXd& x) const {
    const Eigen::Quaterniond q(x[3], x[4], x[5], x[6]), q_0(rest_[3], rest_[4], rest_[5], rest_[6]);
    const Eigen::AngleAxisd turned(q.normalized() * q_0.normalized().conjugate());
    const double angle = turned.angle() > std::numbers::pi ? turned.angle() - 2.0 * std::numbers::pi
                                                           : turned.angle();
    Vector6 motion;
    motion << x.head<3>() - rest_.head<3>(), angle * turned.axis();
    return b_.dot(motion) / own_;
  }
  [[nodiscard]] double rate_of(const VectorXd& x) const {
    return b_.dot(x.segment<6>(plant_.layout().velocity())) / own_;
  }
  [[nodiscard]] double gain(const VectorXd& x) const {
    const double a = std::hypot(coordinate(x), rate_of(x) / omega_) / amplitude_;
    return damping_ * (1.0 + 0.5 * (1.0 - a * a));
  }
  [[nodiscard]] VectorXd rate(const VectorXd& x) const {
    VectorXd result(x.size());
    const PlantInput input{.wrench = gain(x) * rate_of(x) * own_ * b_};
    EXPECT_TRUE(plant_.derivative(0.0, x.data(), input, result.data()));
    return result;
  }
  void advance(double h) {
    const VectorXd k1 = rate(x_), k2 = rate(x_ + 0.5 * h * k1), k3 = rate(x_ + 0.5 * h * k2),
                   k4 = rate(x_ + h * k3);
    x_ += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }

  Plant plant_;
  VectorXd rest_, x_{};
  Vector6 shape_, b_;
  double own_, omega_, damping_, joint_{}, amplitude_{}, squares_of_rate_{};
  int crossings_{};
};

/// The softening is built up from nothing by the swing itself.
void expect_harmonic_balance(const model::Machine& machine) {
  constexpr auto kind = ModelKind::guide;
  const std::vector<double> amplitudes{4e-5, 1.3e-4, 4.1e-4};
  const auto balance = [&](const std::vector<double>& at) {
    return modal::modes_at_amplitudes(machine, machine.neutral(), kind, at).front();
  };
  const auto curve = balance(amplitudes);
  for (const auto& point : curve.points) {
    ASSERT_TRUE(point.converged);
    Sustained sustained(machine, kind, point);
    const auto found = sustained.swing(12.0 * swing_softening_time, 40);
    EXPECT_NEAR(found.amplitude, point.amplitude, 0.05 * point.amplitude);
    const auto there = balance({found.amplitude}).points.front();
    ASSERT_TRUE(there.converged);
    const double change = std::abs(there.omega - curve.omega);
    EXPECT_NEAR(found.omega, there.omega, 0.01 * change + 1e-4 * there.omega);
    EXPECT_NEAR(found.damping_ratio, there.damping_ratio, 0.01 * there.damping_ratio);
    testing::Test::RecordProperty("at " + std::to_string(1e6 * found.amplitude) + " um",
                                  std::to_string(there.omega) +
                                      " rad/s (small: " + std::to_string(curve.omega) +
                                      "), swings " + std::to_string(found.omega) + "; ratio " +
                                      std::to_string(there.damping_ratio) + ", swings " +
                                      std::to_string(found.damping_ratio));
  }
}

TEST(SwingsOfElastomers, HaveFrequencyAndLossOfTheHarmonicBalance) {
  expect_harmonic_balance(heavy_machine(false));
}

TEST(SwingsOfElastomers, HaveThemInSeriesWithRodsThatBend) {
  expect_harmonic_balance(heavy_machine(true));
}

}  // namespace
}  // namespace hydrapod::simulation
