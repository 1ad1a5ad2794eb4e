#pragma once
/// How high a resonance stands beside that of rigid legs.
///
/// A force along a rigid-leg mode ψ meets a mode of the flexible model that holds the share MAC of
/// ψ. At its resonance the response along ψ is MAC/(2 ζ ω²), that of the rigid-leg model 1/(2 ζ
/// ω_r²). With equal damping ratios their quotient is MAC (ω_r/ω)², which is also the mode's share
/// of the static compliance over that of rigid legs.

namespace hydrapod::modal {

/// [rad/s]; 0 where `omega` is 0, of a mode that there is not.
inline double peak_height(double mac, double omega, double omega_rigid) {
  return omega > 0.0 ? mac * (omega_rigid / omega) * (omega_rigid / omega) : 0.0;
}

}  // namespace hydrapod::modal
