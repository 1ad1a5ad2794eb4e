#pragma once
/// What it costs to take a mode for a target, see pairing.hpp. Private to the module.

namespace hydrapod::observation {

inline constexpr double frequency_scale = 0.1;      ///< of ln ω
inline constexpr double wrong_shape = 25.0;         ///< at MAC 0
inline constexpr double wrong_mode_of_group = 1.0;  ///< another one of those seen as one
/// Cost of the frequency alone from which shapes are not looked at any more.
inline constexpr double hopeless = 100.0;

}  // namespace hydrapod::observation
