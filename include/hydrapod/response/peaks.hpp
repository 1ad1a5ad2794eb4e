#pragma once
/// Resonance peaks of the direct responses H_dd (force in a direction, motion in the same
/// direction).
///
/// |H_dd| is sampled on a grid that is fine around every mode, so that no peak falls between two
/// points; every local maximum is refined, and its prominence is its height above the higher of the
/// two valleys that part it from higher ground [dB]. Ripples below `min_prominence_db` are not
/// resonances.
///
/// A model without any damping has unbounded peaks, one at every mode that takes part in a
/// direction; magnitude and prominence are then infinite.
///
/// The mode behind a peak is, of the modes within a few bandwidths of it, the one with the largest
/// term in the modal sum of H_dd; if there is none so near, the nearest mode. "The x direction has
/// two resonances" counts a direction's own peaks: x and ry are coupled wherever the mass centre is
/// not in the joints' plane, and the ry response then shows the x mode as well.

#include <string>
#include <vector>

#include "hydrapod/response/frequency_response.hpp"

namespace hydrapod::response {

struct Peak {
  int direction{};         ///< 0…5: x y z rx ry rz
  double omega{};          ///< [rad/s]
  double magnitude{};      ///< |H_dd| there, [m/N] or [rad/(N m)] times s^k of the output
  double prominence_db{};  ///< infinite for the highest peak of the band
  int mode{};              ///< index of the mode behind the peak, see below
  bool own{};  ///< that mode moves the platform mainly in this direction; else it is a mode of
               ///< another direction that this one is coupled to
};

struct PeakOptions {
  double from{};  ///< [rad/s] > 0
  double to{};    ///< [rad/s]
  Output output{Output::displacement};
  double min_prominence_db{3.0};
};

/// Number of a direction's own resonances in `peaks`.
int count_own(const std::vector<Peak>& peaks, int direction);

/// Peaks of all six direct responses, by direction and ascending in frequency.
std::vector<Peak> find_peaks(const ResponseModel& model, const PeakOptions& options);

}  // namespace hydrapod::response
