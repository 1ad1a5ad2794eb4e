#pragma once
/// Responses that are the conjugates of what they should be. Private to the module.
///
/// In the convention e^(−iωt), and where cross spectra are formed the other way round, H* stands
/// for H. Its poles −λ* are unstable, so that no mode describes it. What tells: the mean time of an
/// impulse response, weighted by its energy,
///
///     ∫ t h² dt / ∫ h² dt = −∫ |H|² dφ/dω dω / ∫ |H|² dω,
///
/// is above 0 where the response follows its cause (1/(2σ) for a mode that decays with σ), and
/// below 0 of its conjugate. A delay of milliseconds between channels is small beside it.

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

/// Does what the conjugates leave over, as root mean square, fall to less than this share of what
/// the responses themselves do? Noise that is half of the responses leaves 0.5 of 1.
inline constexpr double of_conjugates = 0.6;

/// Are responses before their cause by that time? Each of them counts alike. False for those that
/// records of hydrapod give: these cannot be.
bool are_before_cause(const FrequencyResponses& responses);

/// With the conjugates of H and of its errors.
FrequencyResponses conjugated(FrequencyResponses responses);

/// √(Σ|Ĥ − H|²/Σ|Ĥ|²) as ModalModel::error, at any lines; 1 where the model has no mode.
double share_left_by(const ModalModel& model, const FrequencyResponses& responses);

}  // namespace hydrapod::identification
