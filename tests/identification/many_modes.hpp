#pragma once
/// Structures with many modes in the band, few references and many outputs, as a roving hammer
/// measures them. Shared by the short and the long test.
///
/// Two kinds: poles and shapes drawn at random, and a chain of masses. Responses are accelerations
/// per force on lines of a frequency axis; errors are complex normal numbers of a share of each
/// response's RMS over the band, with or without their variances.

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "exact/modal_system.hpp"
#include "hydrapod/identification/identify.hpp"
#include "support/identification_score.hpp"

namespace hydrapod::identification {

struct ManyModes {
  int modes{12}, outputs{26}, references{1};
  double noise{0.05};      ///< of each response's RMS
  bool known{};            ///< the variances are given
  bool close_pairs{};      ///< every third mode has a neighbour half a bandwidth away
  bool masses{};           ///< a chain of as many masses as modes
  double spacing{0.1307};  ///< of lines [Hz]
};

/// Frequencies from 6 Hz to 93 Hz or so, damping ratios from 0.4 % to 1.9 %.
test::ModalSystem random_system(const ManyModes& made, test::Random& random);

/// Masses of 1.73 kg between springs of 231 kN/m: up to 116 Hz. References are the first masses.
test::ModalSystem chain_system(const ManyModes& made);

FrequencyResponses responses_of_many(const test::ModalSystem& system, const ManyModes& made,
                                     test::Random& random);

/// The plain textbook method: poly-reference least squares over the whole band, orders 2 … 40, and
/// what is stable over them.
std::vector<test::FoundMode> textbook_modes(const FrequencyResponses& responses);

struct ManyModesScore {
  test::ClassScore ours{}, textbook{};
  int unexplained{};  ///< records that warn of what is left in the residual
};

/// One true mode is one found mode within half a bandwidth or so.
ManyModesScore score_of_many(const ManyModes& made, int seeds);

}  // namespace hydrapod::identification
