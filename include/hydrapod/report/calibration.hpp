#pragma once
/// A calibration and sensitivities as JSON, as pictures and in words.

#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/calibration/sensitivity.hpp"
#include "hydrapod/report/json.hpp"

namespace hydrapod::report {

/// `candidates[]`, best first: choices, misfit, parameters, targets, identifiability.
Json calibration_json(const calibration::Calibration& result, const observation::Targets& targets);
struct ReadCalibration {
  calibration::Calibration result{};
  observation::Targets targets{};  ///< names, poses, frequencies and damping of modes
};
ReadCalibration calibration_from_json(const Json& json, const std::string& file);

/// `profiles[]` of parameters of the best candidate.
Json profile_json(const calibration::Profile& profile, const calibration::Candidate& candidate);

/// `modes[]`, `parameters[]`, `percent_per_percent` by mode, then by parameter.
Json sensitivity_json(const calibration::Sensitivities& sensitivities);
/// Reads it; `point` stays empty.
calibration::Sensitivities sensitivity_from_json(const Json& json, const std::string& file);

/// "determined", "not determined", "at its bound", "by the prior".
const char* verdict_word(calibration::Verdict verdict);

/// What a reader must know and numbers do not say: "The targets cannot be met: …", one per line.
std::vector<std::string> calibration_remarks(const calibration::Calibration& result,
                                             const observation::Targets& targets);

/// Target against model per mode, above the misfit of every combination; throws as report's other
/// pictures do.
void plot_calibration(const calibration::Calibration& result, const observation::Targets& targets,
                      const std::string& path);

/// Heat map: modes downwards, parameters across, colour and number in per cent per per cent.
void plot_sensitivities(const calibration::Sensitivities& sensitivities, const std::string& title,
                        const std::string& path);

}  // namespace hydrapod::report
