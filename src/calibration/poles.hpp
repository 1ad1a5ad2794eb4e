#pragma once
/// Damped modes beside the undamped ones of a point, and how they follow the parameters. Private to
/// the module.
///
/// The dynamic stiffness D(s) = s² M + s C + K − Σ κ r/(s + r) s_y s_yᵀ is symmetric; its C has the
/// ratio ζ of all undamped modes in it. A pole λ and its shape y, D(λ) y = 0, are found from an
/// undamped mode by Rayleigh's iteration: y ← D(λ)⁻¹ D'(λ) y, then λ from yᵀ D(λ) y = 0. With a
/// parameter
///
///     dλ = −yᵀ dD y / (yᵀ D' y),   D' = 2λ M + C + Σ κ r/(λ + r)² s_y s_yᵀ
///
/// The ratio ζ of all modes is C = 2ζ M Φ Ω Φᵀ M = 2ζ M (M⁻¹K)^½, of which
///
///     (Φᵀ dC Φ)_jk = 2 dζ ω_k δ_jk + 2ζ (Φᵀ dK Φ + Ω Φᵀ dM Φ Ω)_jk / (ω_j + ω_k)
///
/// Source: P. Lancaster, Numer. Math. 6 (1964) 377.

#include "hydrapod/calibration/calibrate.hpp"

namespace hydrapod::calibration {

/// Has the model anything that makes |λ| another than the undamped ω? A ratio for all modes has
/// not.
bool is_shifted_by_damping(const dynamics::LinearModel& model);

/// Fills ModePoint::damped of all modes that oscillate, those most alike in pairs, every mode in
/// one pair only. `modal_ratio`: ζ of all undamped modes.
void add_damped(double modal_ratio, ModePoint& point);

/// The same of these modes alone, with the undamped shapes.
void add_damped(double modal_ratio, const std::vector<int>& modes, ModePoint& point);

/// Fills the rows of ModePoint::dpole_omega and dpole_ratio of those whose damped mode is known,
/// after ModePoint::derivatives.
void add_pole_derivatives(double modal_ratio, ModePoint& point);

}  // namespace hydrapod::calibration
