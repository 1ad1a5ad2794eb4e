#include "leg_beams.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace hydrapod::dynamics {

namespace {

using std::numbers::pi;

double bending_stiffness(double E, double diameter, std::optional<double> wall) {
  const double inside = wall ? diameter - 2.0 * *wall : 0.0;
  return E * pi / 64.0 * (std::pow(diameter, 4) - std::pow(inside, 4));
}

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
    constexpr std::array<double, 6> c{1.0,           1.0 / 15.0,    2.0 / 315.0,
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
  auto rod = between_supports(beams.L_g - s, beams.l_mn,
                              squared_wave_number(P, beams.EI_rod, beams.l_mn));
  return {rod.f / beams.EI_rod, -rod.f_s / beams.EI_rod, rod.f_ss / beams.EI_rod};
}

BeamCompliance of_case(const LegBeams& beams, double s, double P) {
  const double a = beams.L_g - s, a2 = a * a, per = 1.0 / (3.0 * beams.EI_case);
  const auto at = end_slope(s, squared_wave_number(P, beams.EI_case, beams.L_g));
  return {(a2 * a + a2 * at.f) * per, (-3.0 * a2 - 2.0 * a * at.f + a2 * at.f_s) * per,
          (6.0 * a + 2.0 * at.f - 4.0 * a * at.f_s + a2 * at.f_ss) * per};
}

/// ∫ from x0 to x1, exact for polynomials up to the seventh degree.
template <class Use>
void integrate(double x0, double x1, Use use) {
  constexpr std::array<double, 4> at{-0.86113631159405258, -0.33998104358485626,
                                     0.33998104358485626, 0.86113631159405258};
  constexpr std::array<double, 4> weight{0.34785484513745386, 0.65214515486254614,
                                         0.65214515486254614, 0.34785484513745386};
  const double half = 0.5 * (x1 - x0);
  for (std::size_t i = 0; i < at.size(); ++i) use(x0 + half * (1.0 + at[i]), half * weight[i]);
}

}  // namespace

BeamCompliance LegBeams::compliance(double s, double P) const {
  const auto rod = of_rod(*this, s, P), tube = of_case(*this, s, P);
  return {rod.f + tube.f, rod.f_s + tube.f_s, rod.f_ss + tube.f_ss};
}

BowMass LegBeams::bow_mass(double s, double P) const {
  const double a = L_g - s, b = l_mn - a, L = l_mn;
  const auto growth = [&](auto part) {  // by the compression, of the bow as a whole
    const double without = part(*this, s, 0.0).f;
    return without > 0.0 ? part(*this, s, P).f / without : 1.0;
  };
  BowMass bow;
  const double of_rods = growth(of_rod) / (6.0 * EI_rod * L);
  const auto add_rod = [&](double xi, double dx) {
    const double from_end = L - xi;
    const double g = of_rods * (xi < a ? b * xi * (L * L - b * b - xi * xi)
                                       : a * from_end * (L * L - a * a - from_end * from_end));
    const double first = mu_rod * g * dx;
    bow.piston += first;
    bow.tilt += first * xi;
    bow.self += first * g;
  };
  integrate(0.0, a, add_rod);
  integrate(a, L, add_rod);
  bow.moment = bow.piston;

  const double of_cases = growth(of_case) / (6.0 * EI_case);
  const auto add_case = [&](double x, double mass) {
    const double beyond = x - s;
    const double g = of_cases * (x < s ? -a * x * (s * s - x * x) / s
                                       : beyond * (2.0 * a * s + 3.0 * a * beyond - beyond * beyond));
    const double first = mass * g;
    bow.around += first * x;
    bow.self += first * g;
    bow.moment -= first;
  };
  const auto add_tube = [&](double x, double dx) { add_case(x, mu_case * dx); };
  integrate(0.0, s, add_tube);
  integrate(s, L_g, add_tube);
  add_case(L_g, case_end);
  return bow;
}

std::optional<LegBeams> leg_beams(const model::Leg& leg) {
  const auto diameter = model::rod_diameter(leg);
  if (leg.bending == model::LegBending::rigid || !diameter) return {};
  const auto& rod = leg.rod;
  const auto& tube = leg.cylinder_case;
  const double E = rod.youngs_modulus, L_g = leg.guide_sleeve.position;
  LegBeams beams{.EI_rod = bending_stiffness(E, *diameter, rod.wall),
                 .EI_case = std::numeric_limits<double>::infinity(),
                 .l_mn = rod.length,
                 .L_g = L_g};
  beams.mu_rod = spread(rod.mass, rod.mass_center, rod.transverse_inertia, rod.length).uniform;
  if (!tube.diameter || !tube.wall) return beams;
  beams.EI_case = bending_stiffness(E, *tube.diameter, tube.wall);
  const auto of_tube = spread(tube.mass, tube.mass_center, tube.transverse_inertia, L_g);
  beams.mu_case = of_tube.uniform;
  beams.case_end = of_tube.end;
  return beams;
}

Eigen::Matrix2d seal_tangent(const LegElement& element) {
  const double k = element.k_s + element.k_contact;
  return k * Eigen::Matrix2d::Identity() +
         element.contact_root * element.contact_root.transpose();
}

InSeries::InSeries(const LegElement& element) {
  const Eigen::Matrix2d tangent = seal_tangent(element);
  const Eigen::Matrix2d series = Eigen::Matrix2d::Identity() + element.bending * tangent;
  delta_d = series.inverse();
  F_d = tangent * delta_d;
}

}  // namespace hydrapod::dynamics
