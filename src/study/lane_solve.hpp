#pragma once
/// Undamped modes of several models at once, one model per SIMD lane: for studies, which need those
/// of many machines. The method is that of modal/normal_modes.hpp, and so is the result but for
/// rounding. Private to the module.

#include <span>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "lane_modes.hpp"

namespace hydrapod::study {

/// Those that this processor can run, the fastest first.
std::span<const LaneKernels> usable_kernels();

/// normal_modes() of models of one kind, on bases without coordinates. sound[k] says whether
/// ‖D^-½ (K φ − ω² M φ)‖ ≤ 1e-12 ω²_max and |φᵀ M φ − 1| ≤ 1e-12 hold for every mode of model k
/// (D: the diagonal of M). Where they do not, modes[k] is not set, and the model must be solved
/// alone. The modes of a model do not depend on the models beside it. Throws std::invalid_argument
/// for models of several kinds.
void modes_in_lanes(std::span<const dynamics::LinearModel* const> models,
                    std::span<modal::NormalModes> modes, std::span<bool> sound);

/// The same by these kernels.
void solve_in_lanes(const LaneKernels& kernels,
                    std::span<const dynamics::LinearModel* const> models,
                    std::span<modal::NormalModes> modes, std::span<bool> sound);

}  // namespace hydrapod::study
