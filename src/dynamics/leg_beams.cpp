#include "leg_beams.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "gauss_rule.hpp"
#include "round_section.hpp"

namespace hydrapod::dynamics {

namespace {

using std::numbers::pi;

/// Of Gauss' rule: what is integrated are polynomials up to the eighth degree and two sines.
constexpr unsigned points = 10;

/// A uniform part and point masses at both ends.
struct Spread {
  double uniform{};  ///< μ [kg/m]
  double end{};      ///< [kg] at the far end
};

/// `center` and `inertia` (about it) of a body between 0 and L.
Spread spread(double mass, double center, double inertia, double L) {
  const double about_start = inertia + mass * center * center;
  const double wanted = 6.0 * (mass * center * L - about_start) / (L * L * L);
  // The least root of det(R − μ U), R of the body and U of a uniform one, about the start.
  const double U = L * L * L * L / 12.0, R = mass * inertia;
  const double mixed = mass * L * L * L / 3.0 + about_start * L - mass * center * L * L;
  const double most =
      R > 0.0 ? 2.0 * R / (mixed + std::sqrt(std::max(mixed * mixed - 4.0 * U * R, 0.0))) : 0.0;
  if (wanted > most) return {most, 0.0};
  const double uniform = std::max(wanted, 0.0);
  return {uniform, std::max((mass * center - 0.5 * uniform * L * L) / L, 0.0)};
}

/// P/EI [1/m²], no more than `most` of what buckles a length L.
double squared_wave_number(double P, double EI, double L) {
  return std::min(P / EI, LegBeams::most * pi * pi / (L * L));
}

/// Deflection of a beam on two supports under a unit force between them, times EI, and its
/// derivatives by the place a of the force. `k2`: P/EI.
BeamCompliance between_supports(double a, double L, double k2) {
  constexpr double small = 0.005;  // of (kL)²: below, the closed form loses digits, the series none
  const double b = L - a, q = a * b, q_a = L - 2.0 * a;
  if (const double u2 = k2 * L * L; std::abs(u2) < small) {
    const double c2 = 1.0 / 3.0 + u2 / 45.0 + 2.0 * u2 * u2 / 945.0 + u2 * u2 * u2 / 4725.0;
    const double c3 = k2 * (2.0 / 45.0 + 4.0 * u2 / 945.0 + 2.0 * u2 * u2 / 4725.0);
    const double c4 = k2 * k2 * (1.0 / 315.0 + u2 / 2835.0);
    const double c5 = k2 * k2 * k2 * 2.0 / 14175.0;
    const double f_q = q * (2.0 * c2 + q * (3.0 * c3 + q * (4.0 * c4 + q * 5.0 * c5)));
    const double f_qq = 2.0 * c2 + q * (6.0 * c3 + q * (12.0 * c4 + q * 20.0 * c5));
    return {q * q * (c2 + q * (c3 + q * (c4 + q * c5))) / L, f_q * q_a / L,
            (f_qq * q_a * q_a - 2.0 * f_q) / L};
  }
  const double k = std::sqrt(std::abs(k2));
  if (k2 > 0.0) {
    const double s = std::sin(k * L);
    return {(std::sin(k * a) * std::sin(k * b) / (k * s) - q / L) / k2,
            (std::sin(k * q_a) / s - q_a / L) / k2,
            (2.0 / L - 2.0 * k * std::cos(k * q_a) / s) / k2};
  }
  const double s = std::sinh(k * L);
  return {(std::sinh(k * a) * std::sinh(k * b) / (k * s) - q / L) / k2,
          (std::sinh(k * q_a) / s - q_a / L) / k2,
          (2.0 / L - 2.0 * k * std::cosh(k * q_a) / s) / k2};
}

/// s ψ: three times the slope at the end of a beam of length s under a unit moment there, times EI.
BeamCompliance end_slope(double s, double k2) {
  constexpr double small = 0.05;  // of (ks)²
  if (const double w = k2 * s * s; std::abs(w) < small) {
    constexpr std::array<double, 6> c{1.0,          1.0 / 15.0,    2.0 / 315.0,
                                      1.0 / 1575.0, 2.0 / 31185.0, 1382.0 / 212837625.0};
    double f = 0.0, f_s = 0.0, f_ss = 0.0;  // of Σ c wⁿ, by powers of s
    for (int n = 5; n >= 0; --n) {
      f = f * w + c[static_cast<std::size_t>(n)];
      f_s = f_s * w + (2 * n + 1) * c[static_cast<std::size_t>(n)];
      f_ss = f_ss * w + (2 * n + 1) * 2 * n * c[static_cast<std::size_t>(n)];
    }
    return {f * s, f_s, s != 0.0 ? f_ss / s : 0.0};
  }
  const double k = std::sqrt(std::abs(k2)), z = k * s;
  if (k2 > 0.0) {
    const double sine = std::sin(z), cosine = std::cos(z);
    return {3.0 * (1.0 / z - cosine / sine) / k, 3.0 * (1.0 / (sine * sine) - 1.0 / (z * z)),
            6.0 * k * (1.0 / (z * z * z) - cosine / (sine * sine * sine))};
  }
  const double sine = std::sinh(z), cosine = std::cosh(z);
  return {3.0 * (cosine / sine - 1.0 / z) / k, 3.0 * (1.0 / (z * z) - 1.0 / (sine * sine)),
          6.0 * k * (cosine / (sine * sine * sine) - 1.0 / (z * z * z))};
}

/// Of the rod, by s: a = L_g − s.
BeamCompliance of_rod(const LegBeams& beams, double s, double P) {
  auto rod =
      between_supports(beams.L_g - s, beams.l_mn, squared_wave_number(P, beams.EI_rod, beams.l_mn));
  return {rod.f / beams.EI_rod, -rod.f_s / beams.EI_rod, rod.f_ss / beams.EI_rod};
}

BeamCompliance of_case(const LegBeams& beams, double s, double P) {
  const double a = beams.L_g - s, a2 = a * a, per = 1.0 / (3.0 * beams.EI_case);
  const auto at = end_slope(s, squared_wave_number(P, beams.EI_case, beams.L_g));
  return {(a2 * a + a2 * at.f) * per, (-3.0 * a2 - 2.0 * a * at.f + a2 * at.f_s) * per,
          (6.0 * a + 2.0 * at.f - 4.0 * a * at.f_s + a2 * at.f_ss) * per};
}

/// Deflections of a body from its chord: that under a unit force at the sleeve, and two more that
/// its own inertia brings.
struct Bows {
  Vector3 at_sleeve{Vector3::Zero()};
  Vector3 momentum{Vector3::Zero()};  ///< ∫ μ w
  Vector3 moment{Vector3::Zero()};    ///< ∫ μ w x
  Matrix3 mass{Matrix3::Zero()};      ///< ∫ μ w wᵀ
  Matrix3 stiffness{Matrix3::Identity()};

  void add_mass(double m, double x, const Vector3& w) {
    momentum += m * w;
    moment += m * x * w;
    mass += m * w * w.transpose();
  }
};

/// Those of the rod: sines beside the cubic splines of the force.
Bows rod_bows(const LegBeams& beams, double s) {
  Bows bows;
  const double a = beams.L_g - s, L = beams.l_mn, b = L - a, k = pi / L;
  const double per_force = 1.0 / (6.0 * beams.EI_rod * L);
  const auto deflections = [&](double x) {
    const double y = L - x;
    return Vector3(
        per_force * (x < a ? b * x * (L * L - b * b - x * x) : a * y * (L * L - a * a - y * y)),
        std::sin(k * x), std::sin(2.0 * k * x));
  };
  bows.at_sleeve = deflections(a);
  for (const auto& [from, to] : {std::pair{0.0, a}, std::pair{a, L}})
    over_piece<points>(from, to, [&](double x, double dx) {
      bows.add_mass(beams.mu_rod * dx, x, deflections(x));
    });
  // A shape that vanishes at the supports meets the force with its deflection there.
  bows.stiffness.row(0) = bows.at_sleeve;
  bows.stiffness.col(0) = bows.at_sleeve;
  bows.stiffness.bottomRightCorner<2, 2>() =
      0.5 * beams.EI_rod * L * std::pow(k, 4) * Eigen::Vector2d(1.0, 16.0).asDiagonal();
  return bows;
}

/// Those of the case: (x − s) x and (x − s) x² over powers of L_g.
Bows case_bows(const LegBeams& beams, double s) {
  Bows bows;
  if (std::isinf(beams.EI_case)) return bows;
  const double L = beams.L_g, a = L - s, per_force = 1.0 / (6.0 * beams.EI_case);
  const auto deflections = [&](double x) {
    const double y = x - s;
    return Vector3(per_force * (x < s ? -a * x * (s * s - x * x) / s
                                      : y * (2.0 * a * s + 3.0 * a * y - y * y)),
                   x * y / (L * L), x * x * y / (L * L * L));
  };
  bows.at_sleeve = deflections(L);
  for (const auto& [from, to] : {std::pair{0.0, s}, std::pair{s, L}})
    over_piece<points>(from, to, [&](double x, double dx) {
      bows.add_mass(beams.mu_case * dx, x, deflections(x));
    });
  bows.add_mass(beams.case_end, L, bows.at_sleeve);
  bows.stiffness.setZero();
  bows.stiffness.row(0) = bows.at_sleeve;
  bows.stiffness.col(0) = bows.at_sleeve;
  over_piece<points>(0.0, L, [&](double x, double dx) {
    const Eigen::Vector2d curvatures(2.0 / (L * L), (6.0 * x - 2.0 * s) / (L * L * L));
    bows.stiffness.bottomRightCorner<2, 2>() +=
        beams.EI_case * dx * curvatures * curvatures.transpose();
  });
  return bows;
}

constexpr int shapes = 7;  // tilt, bows of the rod, bows of the case
using RitzMatrix = Eigen::Matrix<double, shapes, shapes>;
using RitzVector = Eigen::Matrix<double, shapes, 1>;

/// The leg with both joints held, seal and beams.
struct Tilt {
  RitzMatrix M{RitzMatrix::Zero()}, K{RitzMatrix::Zero()};

  Tilt(const LegBeams& beams, double s, double k, const Bows& rod, const Bows& tube) {
    const auto& of_rod = beams.rod;
    // rates of case, piston and rod per φ̇
    const double omega = -beams.l_mn / (s + beams.l_mn), piston = s * omega;
    const double omega_rod = omega + 1.0;
    const double center = piston + of_rod.center * omega_rod;
    M(0, 0) = beams.case_inertia * omega * omega + of_rod.mass * center * center +
              of_rod.inertia * omega_rod * omega_rod;
    M.block<1, 3>(0, 1) = (piston * rod.momentum + omega_rod * rod.moment).transpose();
    M.block<1, 3>(0, 4) = omega * tube.moment.transpose();
    M.block<6, 1>(1, 0) = M.block<1, 6>(0, 1).transpose();
    M.block<3, 3>(1, 1) = rod.mass;
    M.block<3, 3>(4, 4) = tube.mass;
    K.block<3, 3>(1, 1) = rod.stiffness;
    K.block<3, 3>(4, 4) = tube.stiffness;
    RitzVector offset;
    offset << beams.L_g - s, rod.at_sleeve, -tube.at_sleeve;
    K += k * offset * offset.transpose();
  }

  /// Lowest ω², by inverse iteration from the shape `v`.
  [[nodiscard]] double lowest(RitzVector v) const {
    const Eigen::LLT<RitzMatrix> factors(K);
    constexpr int most = 200;
    double omega2 = 0.0;
    for (int n = 0; n < most; ++n) {
      v = factors.solve(RitzVector(M * v));
      v /= std::sqrt(v.dot(M * v));
      const double before = omega2;
      omega2 = v.dot(K * v);
      if (std::abs(omega2 - before) <= 1e-14 * omega2) break;
    }
    return omega2;
  }
};

}  // namespace

BeamCompliance LegBeams::compliance(double s, double P) const {
  const auto inside = of_rod(*this, s, P), outside = of_case(*this, s, P);
  return {inside.f + outside.f, inside.f_s + outside.f_s, inside.f_ss + outside.f_ss};
}

BowMass LegBeams::bow_mass(double s, double P, double k) const {
  const double a = L_g - s;
  if (std::isinf(EI_rod) || !(s > 0.0) || !(a > 0.0) || !(a < l_mn) || !(k > 0.0)) return {};
  const auto of_rod = rod_bows(*this, s), of_case = case_bows(*this, s);
  BowMass bow{.piston = of_rod.momentum[0],
              .tilt = of_rod.moment[0],
              .around = of_case.moment[0],
              .self = of_rod.mass(0, 0) + of_case.mass(0, 0),
              .moment = of_rod.momentum[0] - of_case.momentum[0]};
  const double f = compliance(s, 0.0).f, force = a * k / (1.0 + f * k);  // per φ
  const Tilt tilt(*this, s, k, of_rod, of_case);
  RitzVector shape = RitzVector::Zero();
  shape[0] = 1.0;
  shape[1] = -force;
  shape[4] = force;
  const double mass = shape.dot(tilt.M * shape), missing = force * a / tilt.lowest(shape) - mass;
  bow.self += std::max(missing, 0.0) / (force * force);
  const double growth = compliance(s, P).f / f;
  for (double* part : {&bow.piston, &bow.tilt, &bow.around, &bow.moment}) *part *= growth;
  bow.self *= growth * growth;
  return bow;
}

std::optional<LegBeams> leg_beams(const model::Leg& leg) {
  const auto diameter = model::rod_diameter(leg);
  if (leg.bending == model::LegBending::rigid || !diameter) return {};
  const auto& rod = leg.rod;
  const auto& tube = leg.cylinder_case;
  const double E = rod.youngs_modulus, L_g = leg.guide_sleeve.position;
  LegBeams beams{.EI_rod = E * round_section(*diameter, rod.wall).second_moment,
                 .EI_case = std::numeric_limits<double>::infinity(),
                 .l_mn = rod.length,
                 .L_g = L_g};
  beams.rod = {rod.mass, rod.mass_center, rod.transverse_inertia};
  beams.case_inertia = tube.transverse_inertia + tube.mass * tube.mass_center * tube.mass_center;
  beams.mu_rod = spread(rod.mass, rod.mass_center, rod.transverse_inertia, rod.length).uniform;
  if (!tube.diameter || !tube.wall) return beams;
  beams.EI_case = E * round_section(*tube.diameter, tube.wall).second_moment;
  const auto of_tube = spread(tube.mass, tube.mass_center, tube.transverse_inertia, L_g);
  beams.mu_case = of_tube.uniform;
  beams.case_end = of_tube.end;
  return beams;
}

Eigen::Matrix2d seal_tangent(const LegElement& element) {
  const double k = element.k_s + element.k_contact;
  return k * Eigen::Matrix2d::Identity() + element.contact_root * element.contact_root.transpose();
}

InSeries::InSeries(const LegElement& element) {
  const Eigen::Matrix2d tangent = seal_tangent(element);
  const Eigen::Matrix2d series = Eigen::Matrix2d::Identity() + element.bending * tangent;
  delta_d = series.inverse();
  F_d = tangent * delta_d;
}

}  // namespace hydrapod::dynamics
