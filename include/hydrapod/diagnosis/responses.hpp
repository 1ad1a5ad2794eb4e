#pragma once
/// Measured responses as evidence: motion of the platform, line by line, for each input.
///
/// What a valve lets through for a command is rarely known to a tenth, and differs from line to
/// line; how the platform then moves is not the valve's. A column of H, a line and an input, is
/// therefore compared up to one complex factor (the operating shape at this line, as in the
/// frequency domain assurance criterion). Its deviation is what the measurement says of its noise
/// and the model's error, as root of the sum of squares, both as shares of the column in the metric
/// of the platform's mass; all inputs of a line together count like one shape.
///
/// Lines: those where the noise of a column is below `worst_noise` of it, spread evenly over the
/// logarithm of the frequency from 0.6 times the lowest measured mode to 1.4 times the highest, at
/// most `most_lines` over all poses, and besides those nearest to measured modes and to poles of
/// the machine as stated: neighbouring lines say the same, and the model's error is the same in
/// them.

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
