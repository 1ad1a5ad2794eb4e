#pragma once
/// Modes at given amplitudes as JSON, CSV and picture.

#include <string>
#include <vector>

#include "hydrapod/modal/amplitude.hpp"
#include "hydrapod/report/json.hpp"

namespace hydrapod::report {

struct ModesAtAmplitudes {
  std::vector<double> amplitudes{};             ///< [m] of the platform joint that moves most
  std::vector<modal::AmplitudeCurve> curves{};  ///< a mode each
};

/// `amplitude_m[]`, and `curves[]` with `mode`, `direction`, `frequency_hz` of small motions and
/// `points[]`.
Json modes_at_amplitudes_json(const ModesAtAmplitudes& modes);
ModesAtAmplitudes modes_at_amplitudes_from_json(const Json& json, const std::string& file);
/// A line per mode and amplitude.
std::string modes_at_amplitudes_csv(const ModesAtAmplitudes& modes);
/// Frequency and damping ratio over the amplitude. Needs gnuplot; see plot_bode.
void plot_modes_at_amplitudes(const ModesAtAmplitudes& modes, const std::string& title,
                              const std::string& subtitle, const std::string& path);

}  // namespace hydrapod::report
