#pragma once
/// Mathematical constants that the standard library does not have.

#include <numbers>

namespace hydrapod::base {

inline constexpr double two_pi = 2.0 * std::numbers::pi;

}  // namespace hydrapod::base
