#pragma once
/// Is what a zoom shows a tone, and which? Private to the module.

#include "tone_zoom.hpp"

namespace hydrapod::identification {

/// One track per zoom, those of one candidate in all records; empty: no tone. `line`: distance of
/// the lines of the spectra, `wander`: ToneOptions::wander, both in rad/sample.
std::vector<ToneTrack> fit_tone(const std::vector<Zoom>& zooms, double line, double wander,
                                const ToneOptions& options);

}  // namespace hydrapod::identification
