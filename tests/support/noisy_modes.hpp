#pragma once
/// Modes as identification gives them from a record of a machine: only those that the platform
/// feels, close ones as one, frequencies, dampings and shapes with noise.

#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/observation/targets.hpp"
#include "support/random.hpp"

namespace hydrapod::test {

/// Standard deviations.
struct ModeNoise {
  double frequency{1e-3};  ///< relative
  double damping{0.07};    ///< relative
  double shape{0.03};      ///< of a shape scaled to unit kinetic energy
};

/// Modes of a machine at a pose, whatever they come from, ascending.
struct PoseModes {
  std::string pose{};
  spatial::Pose X_BP{};
  spatial::Vector3 p_BC{};                             ///< the platform's mass centre in B [m]
  spatial::Matrix6 platform_mass{};                    ///< about it
  Eigen::VectorXd omega{};                             ///< [rad/s]
  Eigen::Matrix<double, 6, Eigen::Dynamic> motions{};  ///< of it, of shapes with φᵀ M φ = 1
};

/// Share of the platform in the kinetic energy below which a mode drowns in its neighbours.
inline constexpr double drowned = 2e-3;

/// Undamped modes of the linear model. Throws std::runtime_error where the legs have buckled.
PoseModes modes_at(const model::Machine& machine, const model::NamedPose& pose,
                   dynamics::ModelKind kind);

/// As they are measured: the motion of the platform frame's origin. `damping`: ratio of all modes.
observation::Targets noisy_modes(const std::vector<PoseModes>& poses, double damping,
                                 const ModeNoise& noise, Random& random);

/// Of the machine at its poses with these names.
observation::Targets noisy_modes(const model::Machine& machine,
                                 const std::vector<std::string>& poses, dynamics::ModelKind kind,
                                 const ModeNoise& noise, Random& random);

/// The same of the plant: what a record identified from the drives of the valves on shows. Poles
/// with a damping ratio below 0.3; those nearer than half the smaller decay rate are one, in every
/// direction they move the platform in. Complex shapes with complex noise.
observation::Targets noisy_plant_modes(
    const model::Machine& machine, const std::vector<std::string>& poses, dynamics::ModelKind kind,
    const ModeNoise& noise, Random& random,
    observation::Observed observed = observation::Observed::plant);

}  // namespace hydrapod::test
