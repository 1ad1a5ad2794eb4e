#pragma once
/// Measured responses as evidence: motion of the platform, line by line, for each input.
///
/// What a valve lets through for a command is rarely known to a tenth, and differs from line to
/// line; how the platform then moves is not the valve's. Responses to six drives are brought to the
/// six valves, and a column of H, a line and a valve, is compared up to one complex factor (the
/// operating shape at this line, as in the frequency domain assurance criterion).
///
///     deviation² = inputs (noise² + error² lines/modes)
///
/// both as shares of the column in the metric of the platform's mass; error: the model's, the same
/// in all lines. All lines at a pose together count like one shape per mode measured there.
///
/// Lines: those where the noise of a column is below `worst_noise` of it, spread evenly over the
/// logarithm of the frequency from 0.6 times the lowest measured mode to 1.4 times the highest, at
/// most `most_lines` over all poses, and besides those on the flanks of measured modes and at poles
/// of the machine as stated; none within two half widths of a measured mode, where its damping
/// decides. Theory: docs/theory/diagnosis.md.

#include <optional>

#include "hydrapod/calibration/targets.hpp"
#include "hydrapod/diagnosis/measured.hpp"
#include "hydrapod/dynamics/statics.hpp"
#include "hydrapod/model/machine_file.hpp"

namespace hydrapod::diagnosis {

inline constexpr double worst_noise = 0.3;
inline constexpr int most_lines = 32;

/// All lines of responses to drives; none where the inputs are not drives in directions of the
/// platform or of the legs, or the outputs not all six directions in one kind of unit.
std::optional<calibration::ResponseTarget> measured_responses(
    const identification::FrequencyResponses& responses, const model::Machine& machine,
    const MeasuredAt& at);

/// The lines that count, with the deviations that count.
std::vector<calibration::ResponseTarget> chosen_lines(const model::MachineFile& file,
                                                      const calibration::Targets& measured,
                                                      dynamics::ModelKind kind,
                                                      double response_error);

}  // namespace hydrapod::diagnosis
