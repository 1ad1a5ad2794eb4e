#pragma once
/// Five masses of which a mode drifts during the record. Shared by the short and the long test.

#include <chrono>

#include "gapped.hpp"

namespace hydrapod::identification {

struct Drift {
  int mode{-1};               ///< that drifts; −1: none
  double size{0.02};          ///< of ω from the beginning to the end, linear in time
  double noise{0.01};         ///< of each output's RMS
  double duration{300.0};     ///< [s]
  double sample_rate{200.0};  ///< [Hz]
  double growth{1.0};         ///< of the inputs from the beginning to the end, exponential in time
};

data::Record drifting_record(const test::ModalSystem& system, const Drift& d, std::uint64_t seed);

/// What the test costs beside all else, summed over records [s].
struct TimeTaken {
  double all_else{}, test{};
};

/// As tasks::identify asks it.
Identification tested_for_wandering(const data::Record& record, TimeTaken* time = nullptr);

std::vector<ModeWarning> wandering_in(const Identification& found);

}  // namespace hydrapod::identification
