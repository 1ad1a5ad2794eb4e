#pragma once
/// Records of the software rig, as a user makes and reads them.

#include "hydrapod/identification/identify.hpp"
#include "hydrapod/model/machine.hpp"
#include "hydrapod/rig/rig.hpp"

namespace hydrapod::test {

struct RigExperiment {
  dynamics::ModelKind kind{dynamics::ModelKind::guide};
  spatial::Pose X_BP{};                  ///< where the platform stands
  double duration{};                     ///< [s]
  double level{1e-4};                    ///< RMS of the command, white noise [m, rad]
  signals::Form form{signals::White{}};  ///< of the command; forces are always white
  double drop_outs{};                    ///< share of samples that the recorder lost
  double ripple{};  ///< tone on all recorded channels but the commands, by their RMS
  double force{};   ///< of white forces [N], and moments [N m], instead; 0: none
  std::uint64_t seed{1};
  double sensors{1.0};  ///< noise and steps of the length sensors, in those of the default
  /// Whose motion is identified, in P; default: the mass centre.
  std::optional<spatial::Vector3> point{};
};

/// Drives, or forces, to platform motion of a rig record in a file; of a multisine, six of them.
identification::FrequencyResponses measured_on_rig(const model::Machine& machine,
                                                   const RigExperiment& experiment);

/// And what identification without any setting makes of it.
identification::Identification identified_on_rig(const model::Machine& machine,
                                                 const RigExperiment& experiment);

}  // namespace hydrapod::test
