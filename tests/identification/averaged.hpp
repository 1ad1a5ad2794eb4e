#pragma once
/// Responses as an analyser averages them under random excitation: blocks with a window, lines of a
/// band, nothing said of either. The averages are the test's own. Shared by the short and the long
/// test.

#include <string>

#include "exact/modal_system.hpp"
#include "hydrapod/identification/identify.hpp"
#include "support/identification_score.hpp"

namespace hydrapod::identification {

struct Averaged {
  Eigen::Index inputs{2};
  int block{2048};  ///< samples, at averaged_rate
  double blocks{73.0};
  std::string window{"hann"};  ///< or "flat-top", "blackman", "tukey", half a block
                               ///< apart; or "box", side by side
  double colour{};             ///< of the inputs: u_k = colour u_{k−1} + e_k
  double noise{0.02};          ///< of the RMS of each output
};

constexpr double averaged_rate = 247.3;

/// Five modes with 4.4 Hz to 23 Hz, four outputs.
test::ModalSystem frame(Eigen::Index inputs);

/// H1 from 1.1 Hz to 40 Hz.
FrequencyResponses averaged_responses(const Averaged& how, std::uint64_t seed);

/// Of modes whose quality is at least `least_quality`.
test::ClassScore averaged_score(const Averaged& how, int seeds, const IdentifyOptions& options = {},
                                double least_quality = 0.0);

}  // namespace hydrapod::identification
