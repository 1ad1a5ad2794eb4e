#pragma once
/// Measured modes of a blind case as a test rig gives them: records of the machine with its fault,
/// one per pose, identified without any setting.

#include "hydrapod/base/error.hpp"
#include "hydrapod/observation/targets.hpp"
#include "kept_records.hpp"
#include "support/rig_record.hpp"

namespace hydrapod::test {

struct RecordSetting {
  double duration{120.0};  ///< [s] per pose
  double level{1e-4};      ///< of the white command [m, rad]
  double sensors{1.0};     ///< noise and steps of the length sensors, in those of the default
  double force{};          ///< of white forces [N] and moments [N m] instead of commands; 0: none
};

inline Measure by_record(const RecordSetting& setting) {
  return [setting](const BlindCase& test, const model::MachineFile& truth) {
    observation::Targets all;
    for (const auto& name : test.poses) {
      const auto pose = std::ranges::find(truth.machine.poses, name, &model::NamedPose::name);
      const auto responses = kept_responses(test, name, [&] {
        return measured_on_rig(truth.machine,
                               {.kind = test.kind,
                                .X_BP = pose->X_BP,
                                .duration = setting.duration,
                                .level = setting.level,
                                .force = setting.force,
                                .seed = 100u + static_cast<std::uint64_t>(test.repetition),
                                .sensors = setting.sensors,
                                .point = spatial::Vector3::Zero()});
      });
      const auto found = identification::identify_modes(responses);
      keep_modes(test, name, found);
      // the owner's file says where the legs are; where the mass centre is it may not
      observation::MeasuredAt at{.pose = name, .point = spatial::Vector3::Zero()};
      if (setting.force > 0.0) {  // about the mass centre, and the controller is at work
        at.observed = observation::Observed::system;
        at.force_point = truth.machine.platform.mass_center;
      }
      const auto targets =
          observation::measured_modes(identification::modal_results(found), truth.machine, at);
      if (all.modes.empty())
        all = targets;
      else
        all.modes.insert(all.modes.end(), targets.modes.begin(), targets.modes.end());
      if (const auto lines = observation::measured_responses(responses, truth.machine, at))
        all.responses.push_back(*lines);
    }
    return all;
  };
}

}  // namespace hydrapod::test
