#pragma once
/// Outputs alone whose excitation ends sharply at a frequency, as that of a noise generator with a
/// band does. Private to the module.
///
/// Half spectra are the causal part of spectra. A step of the spectra at f_e is a logarithm there,
/// ln |f − f_e|, which a fit takes for modes. Where the spectra of all outputs have such a step
/// they are continued beyond it by what they are beside it, and lines beyond it are not used.
///
/// With L the mean over the outputs of ln S_oo, a step is a difference D of its means over two
/// stretches of n lines with a gap of g lines between them, which is the reach of the window. What
/// tells it from the flank of a resonance: on either side L is the same within `level` · |D| in
/// this stretch, in the next one and in the one behind that and the gap, and within twice as much
/// from two lines to two lines of this stretch; and two lines on either side of the gap differ by
/// more than `sharp` · D already.

#include <vector>

#include "names.hpp"

namespace hydrapod::identification {

struct ExcitationEndsOptions {
  double least{1.84};  ///< |D| > least: 8 dB
  double level{0.35}, sharp{0.75};
  /// The largest step up is the lower end where no step down before it has more than this share of
  /// it, and alike at the upper end: else there is a gap.
  double beyond{0.5};
  Index stretch{8};         ///< n [lines]
  Index gap{4};             ///< g [lines]
  Index fewest_lines{250};  ///< with fewer, a resonance may be as narrow as a step
};

struct ExcitationEnds {
  /// [lines] The first and the last one that is inside.
  Index first{}, last{};
  /// D [1] at either end; 0: it does not end there.
  double lower_step{}, upper_step{};
};

/// `S`: per line, outputs × outputs, from 0 Hz.
ExcitationEnds excitation_ends(const std::vector<MatrixXcd>& S,
                               const ExcitationEndsOptions& options = {});

/// Lines outside become the mean of the first or the last lines inside.
void continue_beyond(const ExcitationEnds& ends, std::vector<MatrixXcd>& S,
                     const ExcitationEndsOptions& options = {});

}  // namespace hydrapod::identification
