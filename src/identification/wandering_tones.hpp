#pragma once
/// Vibrations of outputs alone whose frequency varies: those of a machine that turns at a speed
/// which is not constant. Private to the module.
///
/// In averaged spectra such a vibration is a bump as wide as its frequency varies, and bumps are
/// what resonances under noise are, too. What tells them apart is the modulus of the samples around
/// one frequency: of a vibration with the share p of the power there it is nearly constant, of a
/// resonance it is that of a Gaussian process,
///
///     var |z|²/(E|z|²)² = 1 − p²,   p = 0: noise and resonances.
///
/// 1. Blocks of n samples (n = `shortest` … , each twice as long as the last, overlapping by half,
///    Hann's window) of a few outputs that see most: at which lines is the relative variance of
///    |z|² less than chance makes? The bound of that chance is the one of tones.hpp. A vibration is
///    seen best by blocks whose lines are as wide as it wanders; in longer ones it comes and goes.
/// 2. Around such a line all these outputs are demodulated, once to find the mean frequency, and
/// once
///    around it. Again the relative variance is asked for, of each output and of the combination
///    with the largest power, against J = 1/Σ P_k² independent values, P_k being the shares of the
///    lines of the whole record. A vibration of constant frequency has J = 1 and is not for here:
///    harmonics.hpp.
/// 3. It wanders as far as the phase says, from one demodulated value to the next.
///
/// An amplitude that varies with the speed, as on the flank of a resonance, leaves the modulus more
/// constant than noise does: between half and three halves of its mean, evenly, the variance is
/// 0.29. A resonance that a machine passes all the time is not told from noise.

#include <array>
#include <vector>

#include "tone_zoom.hpp"

namespace hydrapod::identification {

struct WanderingToneOptions {
  /// Chance · number of lines that are asked, of all lengths and outputs ≥ bound of the chance that
  /// noise is as even: false alarms per record.
  double chance{1e-3};
  /// Relative variance of |z|² < uneven: the vibration then has 0.7 of the power around it. With
  /// less it is no bump of its own.
  double uneven{0.5};
  int shortest{64};             ///< block [samples]
  Index fewest_blocks{32};      ///< of the longest: fewer are even by chance
  Index lowest_line{6};         ///< below are the mean and what drifts
  std::size_t most_outputs{4};  ///< that are looked at
  std::size_t most{24};         ///< lines of step 2, the most even first
  /// Values of the phase beyond this share at either end do not count: noise.
  double outliers{0.005};
};

/// `most` outputs that together see what all see, as they are read; none: all are dead.
ToneReading outputs_that_see_all(const std::vector<std::size_t>& used, std::int64_t settling,
                                 const CrossSpectra& spectra, const std::vector<int>& outputs,
                                 std::size_t most);

/// From where to where a frequency wanders [Hz].
using WanderingTone = std::array<double, 2>;

/// Ascending, without overlap. `used`: channels of the records, of which `spectra` are and which
/// `outputs` number. Records of fewer than fewest_blocks · shortest samples have none.
std::vector<WanderingTone> find_wandering_tones(data::RecordSet& records,
                                                const std::vector<std::size_t>& used,
                                                std::int64_t settling, const CrossSpectra& spectra,
                                                const std::vector<int>& outputs,
                                                const WanderingToneOptions& options = {});

}  // namespace hydrapod::identification
