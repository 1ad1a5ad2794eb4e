#pragma once
/// What the system that was measured would show of a hypothesis at any pose. Private to the module.

#include <map>
#include <string>
#include <vector>

#include "hydrapod/diagnosis/diagnose.hpp"
#include "hydrapod/observation/pairing.hpp"

namespace hydrapod::diagnosis {

/// Resonances of mechanics, of the plant or of the system, as in Targets::observed; of a hypothesis
/// that was fitted by mechanics those of mechanics, which the plant or the system changes in the
/// ratio that it does in the nominal machine.
class Predictions {
 public:
  /// `file` and `targets` must outlive it; `stated`: model of the nominal machine.
  Predictions(const model::MachineFile& file, const observation::Targets& targets,
              dynamics::ModelKind stated)
      : file_(file), targets_(targets), stated_(stated) {}

  /// Throws base::ComputationError and base::InputError where there is no such machine, or it
  /// cannot be observed at this pose.
  [[nodiscard]] std::vector<observation::Resonance> at(const Hypothesis& hypothesis,
                                                       const model::NamedPose& pose);

  /// Of another machine, under the same controller. Throws as at() does.
  [[nodiscard]] std::vector<observation::Resonance> of(const model::Machine& machine,
                                                       dynamics::ModelKind kind,
                                                       const model::NamedPose& pose) {
    return observation::visible_resonances(seen(machine, kind, pose));
  }

  /// The measured system with another machine in it. Throws as at() does.
  [[nodiscard]] observation::Observation seen(const model::Machine& machine,
                                              dynamics::ModelKind kind,
                                              const model::NamedPose& pose);

  /// The nominal machine.
  [[nodiscard]] const model::Machine& machine() const { return file_.machine; }

 private:
  /// The controller at work: tuned for the nominal machine, whatever is wrong with it.
  [[nodiscard]] const control::ControllerParameters* controller(const model::NamedPose& pose);
  /// Brings resonances of mechanics to the observed system.
  void bring(const model::NamedPose& pose, std::vector<observation::Resonance>& resonances);

  const model::MachineFile& file_;
  const observation::Targets& targets_;
  dynamics::ModelKind stated_;
  std::map<std::string, control::ControllerParameters> tuned_{};
};

/// Chamber pressure [Pa] at which the oil springs of all legs together are as stiff as the chambers
/// of the plant are at rest, whose pressures differ. `machine` carries air and has hydraulics.
/// Throws as simulation::Plant and its equilibrium() do.
double pressure_at_rest(const model::Machine& machine, dynamics::ModelKind kind,
                        const spatial::Pose& X_BP);

/// Lets entrained air be compressed as it is in the plant where the plant or the system was
/// measured: what mechanics says of a hypothesis is then what the plant makes of it.
void settle_air(const model::MachineFile& file, const observation::Targets& targets,
                dynamics::ModelKind kind, std::vector<Cause>& causes);

}  // namespace hydrapod::diagnosis
