#pragma once
/// First resonances of a machine beside those of the rigid-leg model.

#include <array>
#include <string>
#include <vector>

#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/spatial/directions.hpp"

namespace hydrapod::diagnosis {

/// The machine whose base stands still and whose gimbals do not give way: with its rigid model it
/// is the rigid calculation.
model::Machine without_mount_and_gimbals(model::Machine machine);

/// A rigid mode stands for the direction in which it mostly moves the platform. Its first resonance
/// in the real machine is the lowest mode that holds a tenth of it (MAC) or more: with soft seals x
/// and y have two resonances each, and the lower one is what users see.
inline constexpr double resonance_mac = 0.1;

struct FirstResonance {
  std::string direction{};  ///< "x", "ry + x"
  int main_direction{};     ///< 0…5, x … rz
  int rigid_mode{};         ///< index of the rigid mode
  double omega_rigid{};     ///< [rad/s]
  int mode{};               ///< index of the flexible mode
  double omega{};           ///< [rad/s]
  double mac{};             ///< how much of the rigid mode is in it
  /// 1 − ω/ω_rigid; negative where the seals lie below and push the mode up.
  [[nodiscard]] double drop() const { return 1.0 - omega / omega_rigid; }
};

/// One per rigid mode, in their order. Throws base::ComputationError where the machine has no
/// equilibrium.
std::array<FirstResonance, 6> first_resonances(const model::Machine& machine,
                                               const spatial::Pose& X_BP, dynamics::ModelKind kind);

using spatial::direction_name;

}  // namespace hydrapod::diagnosis
