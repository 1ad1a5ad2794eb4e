#pragma once
/// Records with drop-outs, of masses between springs and dampers that stand here. Shared by the
/// short and the long test.
///
/// M q̈ + D q̇ + K q = u: five masses, 4.5 Hz to 19.4 Hz, damped by 0.6 % to 2.7 %; three forces,
/// white, held between samples; all five motions are measured, with sensor noise.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "exact/modal_system.hpp"
#include "hydrapod/identification/identify.hpp"
#include "hydrapod/identification/responses.hpp"
#include "support/identification_score.hpp"
#include "support/run_program.hpp"

namespace hydrapod::identification {

/// The first `inputs` masses are pushed.
test::ModalSystem five_masses(Eigen::Index inputs = 3);

struct DropOuts {
  double share{};              ///< of samples lost at random
  int gaps{};                  ///< at random places
  double gap{0.1};             ///< [s]
  bool channels_separately{};  ///< else all channels of a sample together
  double noise{0.01};          ///< of each output's RMS
  double duration{300.0};      ///< [s]
  double sample_rate{200.0};   ///< [Hz]
  bool output_only{};
};

void drop(const DropOuts& d, test::Random& random, data::Record& record);

/// `noise`: of each output's RMS.
void add_output_noise(double noise, Eigen::Index inputs, test::Random& random,
                      data::Record& record);

data::Record gapped_record(const test::ModalSystem& system, const DropOuts& d, std::uint64_t seed);

/// As a user measures it, without any option.
Measurement gapped_measurement(const data::Record& record, bool output_only = false);

struct GappedScore {
  test::ClassScore score{};
  double frequency_bias{};  ///< largest over modes of |mean over seeds of Δω/ω|
  /// Largest over modes of |mean of (ζ̂ − ζ)| over its own standard error; of ω in the same way.
  double damping_bias{}, frequency_bias_in_deviations{};
  double damping_bias_relative{};  ///< of the mode with the largest |mean Δζ/ζ|
  double missing{}, unknown{};     ///< of the last warning
  std::size_t warnings{};          ///< of modes, all seeds
  /// Of all seeds and modes: largest |error| over the deviation that is stated for it.
  double frequency_in_deviations{}, damping_in_deviations{};
};

GappedScore gapped_score(const DropOuts& d, int seeds, int first_seed = 1);

}  // namespace hydrapod::identification
