#pragma once
/// Measured responses as evidence: motion of the platform, line by line, for each input.
///
/// Drives of the valves, and commands to a controller: what a valve lets through is rarely known to
/// a tenth, and differs from line to line; how the platform then moves is not the valve's.
/// Responses to six of them are brought to the six legs, and a column of H, a line and a leg, is
/// compared up to one complex factor (the operating shape at this line, as in the frequency domain
/// assurance BIC).
///
///     deviation² = inputs (noise² + error² lines/modes)
///
/// both as shares of the column in the metric of the platform's mass; error: the model's, the same
/// in all lines. All lines at a pose together count like one shape per mode measured there.
///
/// Forces and moments on the platform: a column counts up to a phase, in m/N, and so says how heavy
/// and how stiff the machine is besides how it moves. To error² comes what poles make of it that
/// are off by the frequency error and, for dampings are rarely known, by their whole half width:
/// max (f² + ζ²) ω_k²/|s − λ_k|² over the measured modes.
///
/// Lines: those where the noise of a column is below `worst_noise` of it, spread evenly over the
/// logarithm of the frequency from 0.6 times the lowest measured mode to 1.4 times the highest, at
/// most `most_lines` over all poses, and besides those on the flanks of measured modes and at poles
/// of the nominal machine; none within two half widths of a measured mode, where its damping
/// decides. Theory: docs/theory/diagnosis.md.

#include "hydrapod/diagnosis/diagnose.hpp"

namespace hydrapod::diagnosis {

inline constexpr double worst_noise = 0.3;
inline constexpr int most_lines = 32;

/// The lines that count, with the deviations that count, of those that the observed system has.
std::vector<observation::ResponseTarget> chosen_lines(const model::MachineFile& file,
                                                      const observation::Targets& measured,
                                                      dynamics::ModelKind kind,
                                                      const DiagnoseOptions& options);

}  // namespace hydrapod::diagnosis
