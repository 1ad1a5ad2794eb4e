#pragma once
/// The several-models normal_modes() with chosen kernels. Private to the module.

#include <span>

#include "hydrapod/dynamics/linear_model.hpp"
#include "lane_modes.hpp"

namespace hydrapod::modal {

/// Those that this processor can run, the fastest first.
std::span<const LaneKernels> usable_kernels();

/// normal_modes() of several models by these kernels.
void solve_in_lanes(const LaneKernels& kernels,
                    std::span<const dynamics::LinearModel* const> models,
                    std::span<dynamics::NormalModes> modes, std::span<bool> sound);

}  // namespace hydrapod::modal
