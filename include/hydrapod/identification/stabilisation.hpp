#pragma once
/// What a pole of the stabilisation chart has in common with the model order before its own.

#include "hydrapod/identification/selection.hpp"

namespace hydrapod::identification {

/// Each level holds what the ones before it do.
enum class PoleStability {
  fresh,      ///< no pole near it in the order before
  frequency,  ///< one within SelectionOptions::frequency
  damping,    ///< and its damping ratio agrees
  vector      ///< and shape and participation lie in what poles near it span
};
/// "new", "frequency", "damping", "vector".
std::string_view stability_text(PoleStability stability);

/// Per order and pole of `chart`. Poles of the lowest order are fresh.
std::vector<std::vector<PoleStability>> pole_stability(const std::vector<OrderPoles>& chart,
                                                       const SelectionOptions& options = {});

}  // namespace hydrapod::identification
