#pragma once
/// The answer to "which modes does my machine have, and what do the seals change": the rigid and
/// the rigid-flexible model of one pose side by side.
///
/// Rigid counterpart. For a rigid mode ψ and a mode φ of the flexible model, both M-normalised,
/// MAC = (ψᵀ M_r φ)² with M_r the rows of M of platform, base and payload: the share of ψ that is
/// found in φ. Over all φ it sums to 1. A mode's counterpart is the rigid mode of which it holds
/// most.

#include <optional>
#include <string>
#include <vector>

#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/modal/normal_modes.hpp"

namespace hydrapod::modal {

/// A mode whose platform share of the kinetic energy is below this is a local seal mode.
inline constexpr double local_mode_energy = 1e-4;

struct RigidCounterpart {
  int mode{};      ///< index into ModeTable::rigid.modes
  double mac{};    ///< 0…1
  double shift{};  ///< ω / ω_rigid − 1
};

struct TabledMode {
  DampedMode mode{};
  EnergyShares energy{};
  bool moves_platform{true};
  std::string label{};                      ///< "x, seals of all legs"; "local seal mode"
  std::optional<RigidCounterpart> rigid{};  ///< none for rigid modes and local seal modes
};

/// One model with its undamped modes and the table of its damped ones.
struct AnalysedModel {
  LinearModel linear{};
  NormalModes normal{};
  std::vector<TabledMode> modes{};  ///< ascending in frequency
  /// Per undamped mode the index of the tabled mode that is most like it (the same unless heavy
  /// dampers change their order).
  std::vector<int> tabled_of_normal{};
};

struct ModeTable {
  dynamics::ModelKind kind{};
  ModalRatio ratio{};
  AnalysedModel real{};   ///< the model asked for
  AnalysedModel rigid{};  ///< the rigid model at the same pose
};

/// Index of the lowest mode with platform motion, in `modes`; −1 when there is none.
int lowest_platform_mode(const std::vector<TabledMode>& modes);

/// Pairs the modes of two models by likeness of shape, most alike first, one to one: per mode of
/// `now` the index of a mode of `before`, −1 where there are none left. The models may be of
/// different kinds.
std::vector<int> match_modes(const AnalysedModel& now, const AnalysedModel& before);

ModeTable mode_table(const model::Machine& machine, const spatial::Pose& X_BP,
                     dynamics::ModelKind kind);

/// A plain label from the energy shares alone.
std::string mode_label(const EnergyShares& energy, bool stable);

/// The platform directions ("x", "x + ry") that hold most of the platform's motion, largest first.
std::string platform_directions(const EnergyShares& energy);

}  // namespace hydrapod::modal
