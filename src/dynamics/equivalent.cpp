/// Guide rings and elastomers at given amplitudes: docs/theory/amplitude.md.

#include "hydrapod/dynamics/linear_model.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "gauss_rule.hpp"
#include "guide_contact.hpp"

namespace hydrapod::dynamics {

namespace {

using std::numbers::pi;

/// Mean force of seal and guide ring, its derivative by the mean offset, and S.
struct PeriodSums {
  Vector2 force{Vector2::Zero()};
  Eigen::Matrix2d slope{Eigen::Matrix2d::Zero()}, at_omega{Eigen::Matrix2d::Zero()};
  bool touches{};

  PeriodSums(const model::GuideSleeve& sleeve, const Vector2& mean, const Vector2& amplitude) {
    slope = sleeve.stiffness * Eigen::Matrix2d::Identity();
    force = sleeve.stiffness * mean;
    if (!(mean.norm() + amplitude.norm() > (1.0 - GuideContact::smoothing) * *sleeve.gap)) return;
    // The motion there is the motion back: half of a period has it all.
    const auto ends = smooth_pieces(sleeve, mean, amplitude);
    for (std::size_t piece = 0; piece + 1 < ends.size(); ++piece)
      over_piece<20>(ends[piece], ends[piece + 1], [&](double theta, double weight) {
        add(sleeve, mean, amplitude, theta, weight / pi);
      });
  }

 private:
  /// Ends of pieces of [0, π] between which the offset passes none of both ends of the rounded
  /// corner.
  static std::vector<double> smooth_pieces(const model::GuideSleeve& sleeve, const Vector2& mean,
                                           const Vector2& amplitude) {
    std::vector<double> ends{0.0, pi};
    const double a2 = amplitude.squaredNorm(), am = amplitude.dot(mean);
    for (const double share : {1.0 - GuideContact::smoothing, 1.0 + GuideContact::smoothing}) {
      const double r = share * *sleeve.gap;  // |m + a c|² = r²
      const double root = am * am - a2 * (mean.squaredNorm() - r * r);
      if (!(root > 0.0)) continue;
      for (const double c : {(-am - std::sqrt(root)) / a2, (-am + std::sqrt(root)) / a2})
        if (std::abs(c) < 1.0) ends.push_back(std::acos(c));
    }
    std::sort(ends.begin(), ends.end());
    return ends;
  }

  void add(const model::GuideSleeve& sleeve, const Vector2& mean, const Vector2& amplitude,
           double theta, double weight) {
    const double sine = std::sin(theta);
    const Vector2 d = mean + std::cos(theta) * amplitude;
    const double offset = d.norm();
    const auto contact = guide_contact(sleeve, offset);
    if (contact.tangent == 0.0) return;
    touches = true;
    force += weight * contact.secant * d;
    const Vector2 r = d / offset;
    const Eigen::Matrix2d J = contact.secant * Eigen::Matrix2d::Identity() +
                              (contact.tangent - contact.secant) * r * r.transpose();
    slope += weight * J;
    at_omega += 2.0 * weight * sine * sine * J;
  }
};

}  // namespace

GuideEquivalent guide_equivalent(const model::GuideSleeve& sleeve, const Vector2& rest,
                                 const Vector2& amplitude) {
  if (!sleeve.gap) return {.mean = rest};
  const Vector2 load = (sleeve.stiffness + guide_contact(sleeve, rest.norm()).secant) * rest;
  GuideEquivalent result{.mean = rest};
  constexpr double settled = 1e-12;  // of the gap
  constexpr int most_steps = 50;  // the mean force grows with the mean offset: Newton meets no turn
  for (int k = 0;; ++k) {
    const PeriodSums sums(sleeve, result.mean, amplitude);
    result.stiffness = sums.at_omega;
    result.touches = sums.touches;
    const Vector2 step = Eigen::Matrix2d(sums.slope).inverse() * (load - sums.force);
    if (k == most_steps || step.norm() <= settled * (*sleeve.gap)) return result;
    result.mean += step;
  }
}

double softened(const model::Elastomer& elastomer, double amplitude) {
  const double r = std::pow(amplitude / elastomer.softening_amplitude, softening_exponent);
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
