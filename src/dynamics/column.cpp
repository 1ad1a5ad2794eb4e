#include "hydrapod/dynamics/statics.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "round_section.hpp"

namespace hydrapod::dynamics {

namespace {

using std::numbers::pi;

/// Guided length over the leg's; below, rounding takes what is left of the stiffness.
constexpr double least_guide = 1e-3;

/// A span under the compression P: shear and moment at its ends for unit deflections and slopes,
/// times L³/EI, L²/EI, L/EI and L/EI.
struct StabilityFunctions {
  double shear{};     ///< 12 without a force
  double moment{};    ///< 6: shear by a slope, moment by a deflection
  double near_end{};  ///< 4
  double far_end{};   ///< 2
};

/// `u` = L √(P/EI), less than 2π.
StabilityFunctions stability_functions(double u) {
  const double u2 = u * u;
  constexpr double small = 0.1;  // below, the terms of u⁶ are less than what rounding takes
  if (u < small)
    return {12.0 - 1.2 * u2 - u2 * u2 / 700.0, 6.0 - u2 / 10.0 - u2 * u2 / 1400.0,
            4.0 - u2 / 7.5 - 11.0 * u2 * u2 / 6300.0, 2.0 + u2 / 30.0 + 13.0 * u2 * u2 / 12600.0};
  const double s = std::sin(u), c = std::cos(u), phi = 2.0 - 2.0 * c - u * s;
  return {u * u2 * s / phi, u2 * (1.0 - c) / phi, u * (s - u * c) / phi, u * (u - s) / phi};
}

/// Deflections at piston and sleeve; slopes of the case at the base joint, at piston and sleeve;
/// slopes of the rod at piston, sleeve and platform joint.
enum Freedom {
  at_piston,
  at_sleeve,
  case_base,
  case_piston,
  case_sleeve,
  rod_piston,
  rod_sleeve,
  rod_end,
  freedoms
};
constexpr int held = -1;
using Stiffness = Eigen::Matrix<double, freedoms, freedoms>;

struct Span {
  double length{}, EI{};
  bool loaded{};
  std::array<int, 4> at{};  ///< deflection and slope, deflection and slope
};

void add(const Span& span, double P, Stiffness& K) {
  const double L = span.length, b = span.EI / L;
  const auto f = stability_functions(span.loaded ? L * std::sqrt(P / span.EI) : 0.0);
  Eigen::Matrix4d k;
  k << f.shear / L / L, f.moment / L, -f.shear / L / L, f.moment / L,   //
      f.moment / L, f.near_end, -f.moment / L, f.far_end,               //
      -f.shear / L / L, -f.moment / L, f.shear / L / L, -f.moment / L,  //
      f.moment / L, f.far_end, -f.moment / L, f.near_end;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      if (span.at[i] != held && span.at[j] != held)
        K(span.at[i], span.at[j]) += b * k(static_cast<int>(i), static_cast<int>(j));
}

/// A case that does not bend turns by θ: its slopes are θ, its deflections l_m θ and L_g θ.
struct RigidCase {
  double l_m{}, L_g{};
};

bool is_stable(const std::array<Span, 4>& spans, const std::optional<RigidCase>& rigid, double P) {
  Stiffness K = Stiffness::Zero();
  const std::size_t first = rigid ? 2 : 0;
  for (std::size_t s = first; s < spans.size(); ++s) add(spans[s], P, K);
  if (!rigid) return K.llt().info() == Eigen::Success;
  Eigen::Matrix<double, freedoms, 4> turned = Eigen::Matrix<double, freedoms, 4>::Zero();
  turned(at_piston, 0) = rigid->l_m;
  turned(at_sleeve, 0) = rigid->L_g;
  turned(rod_piston, 1) = turned(rod_sleeve, 2) = turned(rod_end, 3) = 1.0;
  Eigen::Matrix4d reduced = turned.transpose() * K * turned;
  reduced(0, 0) -= P * rigid->l_m;  // the force follows the case as far as the piston
  return reduced.llt().info() == Eigen::Success;
}

}  // namespace

std::optional<ColumnStrength> column_strength(const model::Leg& leg, double length) {
  const auto& rod = leg.rod;
  const auto& around = leg.cylinder_case;
  const double diameter = model::rod_diameter(leg).value_or(0.0);
  const double l_m = length - rod.length, L_g = leg.guide_sleeve.position;
  if (!(diameter > 0.0) || !(l_m > 0.0) || !(L_g - l_m > least_guide * length) || !(length > L_g))
    return {};

  const auto section = round_section(diameter, rod.wall);
  const double E = rod.youngs_modulus, EI_r = E * section.second_moment;
  std::optional<RigidCase> rigid;
  double EI_c = 0.0;
  if (around.diameter && around.wall)
    EI_c = E * round_section(*around.diameter, around.wall).second_moment;
  else
    rigid = RigidCase{l_m, L_g};
  const std::array<Span, 4> spans{{
      {l_m, EI_c, true, {held, case_base, at_piston, case_piston}},
      {L_g - l_m, EI_c, false, {at_piston, case_piston, at_sleeve, case_sleeve}},
      {L_g - l_m, EI_r, true, {at_piston, rod_piston, at_sleeve, rod_sleeve}},
      {length - L_g, EI_r, true, {at_sleeve, rod_sleeve, held, rod_end}},
  }};
  double low = 0.0, high = std::numeric_limits<double>::infinity();
  for (const auto& span : spans)  // between clamped ends
    if (span.loaded && span.EI > 0.0)
      high = std::min(high, 4.0 * pi * pi * span.EI / (span.length * span.length));
  constexpr double tolerance = 1e-12;
  while (high - low > tolerance * high) {
    const double middle = 0.5 * (low + high);
    (is_stable(spans, rigid, middle) ? low : high) = middle;
  }
  ColumnStrength result{.euler = low, .strength = low};
  const double yield = rod.yield_strength, euler_stress = low / section.area;
  result.yields = euler_stress > 0.5 * yield;
  if (result.yields) result.strength = section.area * yield * (1.0 - yield / (4.0 * euler_stress));
  return result;
}

}  // namespace hydrapod::dynamics
