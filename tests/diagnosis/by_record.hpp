#pragma once
/// Measured modes of a blind case as a test rig gives them: records of the machine with its fault,
/// one per pose, identified without any setting.

#include <array>
#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/observation/targets.hpp"
#include "kept_records.hpp"
#include "support/rig_record.hpp"

namespace hydrapod::test {

struct RecordSetting {
  double duration{120.0};  ///< [s] per pose
  double level{1e-4};      ///< of the command [m, rad]
  double sensors{1.0};     ///< noise and steps of the length sensors, in those of the default
  double force{};          ///< of white forces [N] and moments [N m] instead of commands; 0: none
  bool varied{};           ///< a third of the cases, see Variation
  double to{40.0};         ///< [Hz] of excitation in a band: above the platform's modes
};

/// How a third of the records are made: not with white noise, or not as they should be.
struct Variation {
  const char* name;
  signals::Form form{signals::White{}};
  double level{1.0};  ///< factor on that of the setting
  double drop_outs{}, ripple{};
  double duration{};  ///< [s]; 0: as the others
};

inline Variation variation_of(const RecordSetting& setting, int repetition) {
  if (!setting.varied || repetition % 3 != 2) return {"white"};
  if (setting.force > 0.0) {  // forces are always white
    const std::array forces{Variation{.name = "white, 2 % lost", .drop_outs = 0.02},
                            Variation{.name = "white, ripple", .ripple = 0.3},
                            Variation{.name = "white", .duration = 20.0}};
    return forces[static_cast<std::size_t>(repetition / 3) % forces.size()];
  }
  const double pass = setting.duration / 6.0;
  // commands in a band are followed, and what is followed must be less than what white noise
  // commands
  const double followed = 0.25 * std::sqrt(setting.to / 500.0);
  const std::array all{
      Variation{
          .name = "noise in a band", .form = signals::Noise{.to = setting.to}, .level = followed},
      Variation{.name = "white, 2 % lost", .drop_outs = 0.02},
      Variation{.name = "sweeps",
                .form =
                    signals::Sweep{
                        .from = 1.0, .to = setting.to, .duration = pass, .turns = 1, .rms = true},
                .level = followed},
      Variation{.name = "white, ripple", .ripple = 0.3},
      Variation{
          .name = "multisines",
          .form = signals::Multisine{.from = 1.0, .to = setting.to, .period = 5.0, .slope = -6.0},
          .level = followed},
      Variation{.name = "white", .duration = 20.0}};
  return all[static_cast<std::size_t>(repetition / 3) % all.size()];
}

inline Measure by_record(const RecordSetting& setting) {
  return [setting](const BlindCase& test, const model::MachineFile& truth) {
    observation::Targets all;
    const auto variation = variation_of(setting, test.repetition);
    for (const auto& name : test.poses) {
      const auto pose = std::ranges::find(truth.machine.poses, name, &model::NamedPose::name);
      const auto responses = kept_responses(test, name, [&] {
        return measured_on_rig(
            truth.machine,
            {.kind = test.kind,
             .X_BP = pose->X_BP,
             .duration = variation.duration > 0.0 ? variation.duration : setting.duration,
             .level = variation.level * setting.level,
             .form = variation.form,
             .drop_outs = variation.drop_outs,
             .ripple = variation.ripple,
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
