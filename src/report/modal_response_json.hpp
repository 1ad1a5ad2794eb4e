#pragma once
/// A 6×6 frequency response as JSON in its modal form: small, exact at every frequency, so that a
/// page can draw any range of it at any resolution.
///
/// With the undamped modes Φ (M-normalised, platform rows Φ_p at the point Q), Ω² = diag(ω_k²) and
/// Γ = Φᵀ C Φ + diag(2 ζ ω_k),
///
///     H(ω) = Φ_p (Ω² − ω² I + iω Γ)⁻¹ Φ_pᵀ
///
/// for a wrench at Q and the displacement there. Γ is diagonal where no viscous damper couples the
/// modes, and H then is the modal sum; else the page solves for the modes' amplitudes, and no
/// eigenvector of a damped (perhaps defective) problem is needed. Chambers that relax
/// (dynamics::RelaxingArm) take Σ λ/(iω + λ) g gᵀ off the matrix in brackets, g = √κ Φᵀ s_y.

#include "hydrapod/report/json.hpp"
#include "hydrapod/response/frequency_response.hpp"

namespace hydrapod::report {

/// `omega2`, `damping` (a list: the diagonal of Γ; a list of rows: all of it), `platform_shapes`
/// (six numbers per mode), `mode` (its number in the mode table), with chambers `relaxing` (a list
/// of `rate_1_s` λ and `shape` g). Throws std::invalid_argument for a model with loads on flexible
/// coordinates.
Json modal_response_json(const response::ResponseModel& model, const std::vector<int>& tabled);

/// `point`, `point_m`, `from_rad_s`, `to_rad_s`, `points`, `real` and `rigid` in modal form,
/// `peaks` and `rigid_peaks`: the response at the platform's mass centre over the band of the modes
/// it feels.
Json bode_json(const modal::ModeTable& table, const model::Machine& machine, int points);

}  // namespace hydrapod::report
