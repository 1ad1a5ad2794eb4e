#pragma once
/// What a set of undamped modes is: (K − ω² M) φ = 0. modal/normal_modes.hpp computes them;
/// responses and others that only use them need no more than this.

#include <cmath>
#include <vector>

#include "hydrapod/dynamics/linear_model.hpp"

namespace hydrapod::dynamics {

struct NormalModes {
  ModelVector omega2{};      ///< ω² [rad²/s²], ascending; negative: unstable, the legs buckle
  ModelMatrix shapes{};      ///< columns φ [m, rad per √(kg m²)…], φᵀ M φ = 1
  std::vector<int> group{};  ///< same number for modes whose ω² repeat

  [[nodiscard]] int size() const { return static_cast<int>(omega2.size()); }
  /// √ω² [rad/s], 0 when unstable.
  [[nodiscard]] double omega(int k) const { return omega2[k] > 0.0 ? std::sqrt(omega2[k]) : 0.0; }
};

}  // namespace hydrapod::dynamics
