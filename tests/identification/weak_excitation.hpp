#pragma once
/// A loop whose excitation is so weak that other forces and noise move the inputs too. Shared by
/// the short and the long test.

#include <algorithm>
#include <vector>

#include "foreign_loop.hpp"

namespace hydrapod::identification {

/// Noise in a band, between 1/400 and all of what foreign_loop.hpp has.
ForeignLoop weak_loop(double level, std::uint64_t seed);

std::vector<data::ResponseWarning> weak_bands(const FrequencyResponses& responses);

/// Is a mode of this pole within one of them?
bool is_weak(const std::vector<data::ResponseWarning>& bands, std::complex<double> pole);

struct WeakScore {
  int modes{}, weak_modes{};             ///< of the plant, and those in a weak band
  int intervals{}, covered{};            ///< of found modes elsewhere, frequency and damping
  int weak_intervals{}, weak_covered{};  ///< of those in a weak band
  int records_with_bands{}, most_bands{};
  int false_modes{}, false_and_good{};  ///< that the plant does not have; quality ≥ 0.5
  double best_weak_quality{};           ///< by the largest that its band allows
};

void add_weak_loop(const test::ModalSystem& plant, double level, std::uint64_t seed,
                   WeakScore& score);

}  // namespace hydrapod::identification
