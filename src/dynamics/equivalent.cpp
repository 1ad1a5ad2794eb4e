/// Guide rings and elastomers at given amplitudes: docs/theory/amplitude.md.

#include "hydrapod/dynamics/linear_model.hpp"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "guide_contact.hpp"

namespace hydrapod::dynamics {

namespace {

constexpr double pi = std::numbers::pi;

/// Sums over a period of what is smooth and periodic converge faster than any power. The corner of a
/// guide ring is a tenth of its gap wide: at a hundred times the gap it lies between two points, and
/// the error is that of a sharp corner, some 1e-5 of the stiffness.
constexpr int points_of_period = 1024;

/// Mean force of seal and guide ring, its derivative by the mean offset, and S.
struct PeriodSums {
  Vector2 force{Vector2::Zero()};
  Eigen::Matrix2d slope{Eigen::Matrix2d::Zero()}, at_omega{Eigen::Matrix2d::Zero()};
  bool touches{};

  PeriodSums(const model::GuideSleeve& sleeve, const Vector2& mean, const Vector2& amplitude) {
    const Eigen::Matrix2d one = Eigen::Matrix2d::Identity();
    // The motion there is the motion back: half of a period has it all.
    constexpr int half = points_of_period / 2;
    for (int k = 0; k < half; ++k) {
      const double theta = pi * (k + 0.5) / half;
      const double sine = std::sin(theta);
      const Vector2 d = mean + std::cos(theta) * amplitude;
      const double offset = d.norm();
      const auto contact = guide_contact(sleeve, offset);
      force += (sleeve.stiffness + contact.secant) * d / half;
      if (contact.tangent == 0.0) continue;
      touches = true;
      const Vector2 r = d / offset;
      const Eigen::Matrix2d J =
          contact.secant * one + (contact.tangent - contact.secant) * r * r.transpose();
      slope += J / half;
      at_omega += 2.0 * sine * sine * J / half;
    }
    slope += sleeve.stiffness * one;
  }
};

}  // namespace

GuideEquivalent guide_equivalent(const model::GuideSleeve& sleeve, const Vector2& rest,
                                 const Vector2& amplitude) {
  if (!sleeve.gap) return {.mean = rest};
  const Vector2 load = (sleeve.stiffness + guide_contact(sleeve, rest.norm()).secant) * rest;
  GuideEquivalent result{.mean = rest};
  constexpr int most_steps = 50;  // the mean force grows with the mean offset: Newton meets no turn
  for (int k = 0;; ++k) {
    const PeriodSums sums(sleeve, result.mean, amplitude);
    result.stiffness = sums.at_omega;
    result.touches = sums.touches;
    const Vector2 step = Eigen::Matrix2d(sums.slope).inverse() * (load - sums.force);
    if (k == most_steps || step.norm() <= 1e-12 * (*sleeve.gap)) return result;
    result.mean += step;
  }
}

double softened(const model::Elastomer& elastomer, double amplitude) {
  constexpr double exponent = 1.2;  // 2m with m = 0.6 of Kraus, found for most filled rubbers
  const double r = std::pow(amplitude / elastomer.softening_amplitude, exponent);
  return 1.0 - elastomer.softening * r / (1.0 + r);
}

ModelVector per_coordinate(const LinearModel& model, int leg, const Vector7& per_x) {
  const int flexible = flexible_per_leg(model.kind);
  const spatial::Vector6 of_platform = model.J[leg].transpose() * per_x.head<3>();
  ModelVector row = ModelVector::Zero(model.dof());
  row.head<6>() = of_platform;
  row.segment(model.first_of_leg(leg), flexible) = per_x.segment(3, flexible);
  if (model.base_count() > 0)
    row.segment(model.first_of_base(), model.base_count()) =
        -model.carried_by_base.transpose() * of_platform;
  return row;
}

}  // namespace hydrapod::dynamics
