#pragma once
/// Resonances as a measurement of the platform sees them, direction by direction.
///
/// Modes within `seen_as_one` of each other's frequency are one resonance in every direction that
/// they move the platform in: of a group with platform motions u_k (in the metric of the platform's
/// mass, so that |u|² is its share of the kinetic energy) the eigenvectors of Σ u uᵀ are the
/// motions that are seen, and the eigenvalues their strengths. What is weaker than `visible` is
/// not seen.

#include <array>
#include <string>
#include <vector>

#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/spatial/directions.hpp"

namespace hydrapod::diagnosis {

/// Share of ω within which modes cannot be told apart.
inline constexpr double seen_as_one = 5e-3;

/// Share of the kinetic energy that the platform has in a resonance that can be seen.
inline constexpr double visible = 2e-3;

struct Resonance {
  int direction{};            ///< 0…5, x … rz: what the platform mostly does
  double omega{};             ///< mean of the group, weighted with its motion [rad/s]
  double strength{};          ///< the platform's share of the kinetic energy
  spatial::Vector6 motion{};  ///< of the mass centre, scaled to unit kinetic energy of the platform
};

/// Ascending in ω. Throws base::ComputationError where the machine has no equilibrium.
std::vector<Resonance> visible_resonances(const model::Machine& machine, const spatial::Pose& X_BP,
                                          dynamics::ModelKind kind);

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
