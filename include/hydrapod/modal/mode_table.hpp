#pragma once
/// The answer to "which modes does my machine have, and what do the seals change": the rigid and the
/// rigid-flexible model of one pose side by side.
///
/// Rigid counterpart. For a rigid mode ψ and a mode φ of the flexible model, both M-normalised,
/// MAC = (ψᵀ M_r φ)² with M_r the platform's six rows of M: the share of ψ that is found in φ. Over all φ it sums
/// to 1. A mode's counterpart is the rigid mode of which it holds most.

#include <optional>
#include <string>
#include <vector>

#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/modal/energy.hpp"

namespace hydrapod::modal {

/// A mode whose platform share of the kinetic energy is below this is one that the platform cannot feel.
inline constexpr double felt_by_platform = 1e-4;

struct RigidCounterpart {
  int mode{};      ///< index into ModeTable::rigid
  double mac{};    ///< 0…1
  double shift{};  ///< ω / ω_rigid − 1
};

struct TabledMode {
  DampedMode mode{};
  EnergyShares energy{};
  bool platform_feels{true};
  std::string label{};  ///< "x, knee of all legs"; "seal mode the platform cannot feel"
  std::optional<RigidCounterpart> rigid{};  ///< none for rigid modes and those the platform cannot feel
};

struct ModeTable {
  dynamics::ModelKind kind{};
  ModalRatio ratio{};
  std::vector<TabledMode> modes{};  ///< of the model asked for, ascending
  std::vector<TabledMode> rigid{};  ///< of the rigid model at the same pose, ascending
  LinearModel model{};              ///< what `modes` were computed from
  LinearModel rigid_model{};
};

ModeTable mode_table(const model::Machine& machine, const spatial::Pose& X_BP,
                     dynamics::ModelKind kind);

/// A plain label from the energy shares alone.
std::string mode_label(const EnergyShares& energy, bool stable);

/// The platform directions ("x", "x + ry") that hold most of the platform's motion, largest first.
std::string platform_directions(const EnergyShares& energy);

}  // namespace hydrapod::modal
