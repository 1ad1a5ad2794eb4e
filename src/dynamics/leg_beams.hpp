#pragma once
/// Rod and case of a leg as beams: how far they give way at the guide sleeve, and the mass of what
/// bends.
///
/// The rod lies on the piston (ξ = 0), is pinned at the platform joint (ξ = l_mn) and carries the
/// seal's force F at the sleeve, ξ = a = L_g − s. The case is pinned at the base joint, carries the
/// piston at x = s and the force back at x = L_g. Between the chords, with b = l_mn − a,
///
///     f = a² b² / (3 E I_r (a + b)) + a² (s + a) / (3 E I_c)
///
/// A compression P in the rod, and in the case as far as the piston, makes both larger. With
/// κ² = P/EI the rod's share is
///
///     f_r = [sin κa sin κb / (κ sin κ(a + b)) − a b / (a + b)] / P
///
/// and the slope of the case at the piston grows by ψ = 3 (1 − u cot u)/u², u = κ s. (Timoshenko &
/// Gere, Theory of Elastic Stability, 1961, chapter 1; hyperbolic for tension.) A compression of
/// more than `most` of what buckles rod or case between its ends counts as that much; see
/// column_strength().
///
/// Mass. The field of the rod is its chord less F g_r(ξ), that of the case its chord plus F g_c(x),
/// g being the deflections for a unit force at the sleeve. Rod and case are taken as uniform beams
/// with point masses at their ends, so that mass, mass centre and transverse inertia are those of
/// the file:
///
///     μ = 6 (m c (L − c) − I) / L³, no more than leaves the rest a body that can be
///
/// What is left moves with the chord, but the end of the case with the case. Where the piston is
/// retracted, rod and case bend under their own inertia in other shapes too. With the joints held,
/// a Ritz model of tilt, both deflections g and two more shapes of each body has the lowest
/// frequency ω_1 (within 0.1 % of beam elements). What F of the tilt must carry beside the field to
/// have that frequency too is added to ∫ μ g².

#include <Eigen/Core>
#include <optional>

#include "hydrapod/dynamics/leg.hpp"

namespace hydrapod::dynamics {

/// f [m/N] at a position s of the piston, with its derivatives by s.
struct BeamCompliance {
  double f{}, f_s{}, f_ss{};
};

/// Moments of the bow per F: the rod's momentum is −∫ μ_r g_r Ḟ, and so on.
struct BowMass {
  double piston{};  ///< ∫ μ_r g_r dξ [kg m/N]
  double tilt{};    ///< ∫ μ_r g_r ξ dξ [kg m²/N]
  double around{};  ///< ∫ μ_c g_c x dx [kg m²/N]
  double self{};    ///< ∫ μ_r g_r² dξ + ∫ μ_c g_c² dx and what ω_1 asks for [kg m²/N²]
  double moment{};  ///< ∫ μ_r g_r dξ − ∫ μ_c g_c dx [kg m/N]: momentum is −moment ḃ
};

struct LegBeams {
  static constexpr double most = 0.95;  ///< of Euler's load

  double EI_rod{};   ///< [N m²]; infinite where nothing bends
  double EI_case{};  ///< infinite where the case does not bend
  double l_mn{}, L_g{};
  double mu_rod{}, mu_case{};  ///< [kg/m]
  double case_end{};           ///< point mass at the end of the case [kg]
  struct Body {
    double mass{}, center{}, inertia{};  ///< inertia about its centre
  } rod{};
  double case_inertia{};  ///< about the base joint [kg m²]

  /// P: compression [N].
  [[nodiscard]] BeamCompliance compliance(double s, double P) const;
  /// `k`: of seal and guide ring [N/m].
  [[nodiscard]] BowMass bow_mass(double s, double P, double k) const;
};

/// None where the leg does not bend.
std::optional<LegBeams> leg_beams(const model::Leg& leg);

/// ∂F/∂δ [N/m] of seal and guide ring.
Eigen::Matrix2d seal_tangent(const LegElement& element);

/// How δ and F follow d_s, beams in series: δ = δ_d d_s, F = F_d d_s for small changes.
struct InSeries {
  Eigen::Matrix2d delta_d, F_d;
  explicit InSeries(const LegElement& element);
};

}  // namespace hydrapod::dynamics
