/// Guide rings and elastomers at given amplitudes: docs/theory/amplitude.md.

#include "hydrapod/dynamics/linear_model.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "gauss_rule.hpp"
#include "guide_contact.hpp"

namespace hydrapod::dynamics {

namespace {

using std::numbers::pi;

using Vector4 = Eigen::Vector4d;
using Matrix4 = Eigen::Matrix4d;

/// d̄ + a cos θ + b cos 2θ.
struct Offset {
  Vector2 mean{Vector2::Zero()}, first{Vector2::Zero()}, second{Vector2::Zero()};

  [[nodiscard]] Vector2 at(double cosine) const {
    return mean + cosine * first + (2.0 * cosine * cosine - 1.0) * second;
  }
};

/// Parts of the ring's force, and their derivatives by d̄ and b.
struct PeriodSums {
  Vector4 force{Vector4::Zero()};  // mean, at 2ω
  Vector2 at_omega{Vector2::Zero()};
  Matrix4 slope{Matrix4::Zero()};
  Eigen::Matrix2d stiffness{Eigen::Matrix2d::Zero()};  // S of b = 0
  bool touches{};

  PeriodSums(const model::GuideSleeve& sleeve, const Offset& offset) {
    const double reach = offset.mean.norm() + offset.first.norm() + offset.second.norm();
    if (!(reach > (1.0 - GuideContact::smoothing) * *sleeve.gap)) return;
    // The motion there is the motion back: half of a period has it all.
    const auto ends = smooth_pieces(*sleeve.gap, offset);
    for (std::size_t piece = 0; piece + 1 < ends.size(); ++piece)
      over_piece<20>(ends[piece], ends[piece + 1],
                     [&](double theta, double weight) { add(sleeve, offset, theta, weight / pi); });
  }

 private:
  /// Ends of pieces of [0, π] between which the offset passes none of both ends of the rounded
  /// corner: |d|² = r² is of the fourth degree in cos θ.
  static std::vector<double> smooth_pieces(double gap, const Offset& d) {
    std::vector<double> ends{0.0, pi};
    const Vector2 c0 = d.mean - d.second, c2 = 2.0 * d.second;
    for (const double share : {1.0 - GuideContact::smoothing, 1.0 + GuideContact::smoothing}) {
      const double unit = 1.0 / (gap * gap);
      const std::array<double, 5> p{c0.squaredNorm() * unit - share * share,
                                    2.0 * c0.dot(d.first) * unit,
                                    (d.first.squaredNorm() + 2.0 * c0.dot(c2)) * unit,
                                    2.0 * d.first.dot(c2) * unit, c2.squaredNorm() * unit};
      for (const double x : roots_within(p)) ends.push_back(std::acos(x));
    }
    std::sort(ends.begin(), ends.end());
    return ends;
  }

  /// Where the polynomial Σ p_k x^k changes its sign in (−1, 1).
  static std::vector<double> roots_within(const std::array<double, 5>& p) {
    const auto value = [&](double x) {
      return (((p[4] * x + p[3]) * x + p[2]) * x + p[1]) * x + p[0];
    };
    constexpr int steps = 64;
    std::vector<double> roots;
    double from = -1.0, at_from = value(from);
    for (int k = 1; k <= steps; ++k) {
      const double to = -1.0 + 2.0 * k / steps, at_to = value(to);
      if ((at_from < 0.0) != (at_to < 0.0)) {
        std::uintmax_t most = 60;
        const auto ends = boost::math::tools::toms748_solve(
            value, from, to, at_from, at_to, boost::math::tools::eps_tolerance<double>(48), most);
        roots.push_back(0.5 * (ends.first + ends.second));
      }
      from = to;
      at_from = at_to;
    }
    return roots;
  }

  void add(const model::GuideSleeve& sleeve, const Offset& offset, double theta, double weight) {
    const double cosine = std::cos(theta), sine2 = 1.0 - cosine * cosine,
                 twice = 2.0 * cosine * cosine - 1.0;
    const Vector2 d = offset.at(cosine);
    const double size = d.norm();
    const auto contact = guide_contact(sleeve, size);
    if (contact.tangent == 0.0) return;
    touches = true;
    const Vector2 f = contact.secant * d, r = d / size;
    force.head<2>() += weight * f;
    force.tail<2>() += 2.0 * weight * twice * f;
    at_omega += 2.0 * weight * cosine * f;
    const Eigen::Matrix2d J = contact.secant * Eigen::Matrix2d::Identity() +
                              (contact.tangent - contact.secant) * r * r.transpose();
    slope.topLeftCorner<2, 2>() += weight * J;
    slope.topRightCorner<2, 2>() += weight * twice * J;
    slope.bottomLeftCorner<2, 2>() += 2.0 * weight * twice * J;
    slope.bottomRightCorner<2, 2>() += 2.0 * weight * twice * twice * J;
    stiffness += 2.0 * weight * sine2 * J;
  }
};

/// Symmetric, near S, with S a = `force`.
Eigen::Matrix2d with_force(const Eigen::Matrix2d& S, const Vector2& a, const Vector2& force) {
  const double a2 = a.squaredNorm();
  if (a2 == 0.0) return S;
  const Vector2 rest = force - S * a;
  const Eigen::Matrix2d across = rest * a.transpose() / a2;
  return S + across + across.transpose() - (rest.dot(a) / (a2 * a2)) * a * a.transpose();
}

}  // namespace

GuideEquivalent guide_equivalent(const model::GuideSleeve& sleeve, const Vector2& rest,
                                 const Vector2& amplitude, const AroundSeal& around) {
  if (!sleeve.gap) return {.mean = rest};
  const Eigen::Matrix2d seal = sleeve.stiffness * Eigen::Matrix2d::Identity();
  const bool second = around.twice.has_value();
  // of all but the ring, and the ring's force at rest
  Matrix4 K = Matrix4::Identity();
  K.topLeftCorner<2, 2>() = seal + around.slow;
  if (second) K.bottomRightCorner<2, 2>() = seal + *around.twice;
  const Vector2 at_rest = guide_contact(sleeve, rest.norm()).secant * rest;
  Offset offset{rest, amplitude, Vector2::Zero()};
  constexpr double settled = 1e-12;  // of the gap
  constexpr int most_steps = 60;
  for (int k = 0;; ++k) {
    PeriodSums sums(sleeve, offset);
    if (!second) {
      sums.force.tail<2>().setZero();
      sums.slope.bottomRows<2>().setZero();
    }
    Vector4 error;
    error << K.topLeftCorner<2, 2>() * (offset.mean - rest) - at_rest,
        K.bottomRightCorner<2, 2>() * offset.second;
    error += sums.force;
    Vector4 step = -Matrix4(K + sums.slope).partialPivLu().solve(error);
    if (k == most_steps || step.norm() <= settled * (*sleeve.gap))
      return {second ? with_force(sums.stiffness, amplitude, sums.at_omega) : sums.stiffness,
              offset.mean, offset.second, sums.touches};
    // With seals alone the force grows with the offset, and Newton's method meets no turn.
    step *= std::min(1.0, *sleeve.gap / step.norm());
    offset.mean += step.head<2>();
    offset.second += step.tail<2>();
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
