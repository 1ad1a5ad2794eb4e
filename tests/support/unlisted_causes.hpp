#pragma once
/// Machines whose modes are made by physics that the diagnosis does not assume: no candidate cause
/// is the right answer.
///
/// Every case plants one effect in a machine of the blind series. Its size is a size that is usual
/// for this effect times a factor between 0.4 and 2, drawn from the number of the case, and halved
/// until the machine stands. The diagnosis gets the modes with the noise of the blind series.

#include <functional>
#include <string>
#include <vector>

#include "diagnosis/blind_series.hpp"
#include "support/modes_at_amplitude.hpp"

namespace hydrapod::test {

/// What the diagnosis calls bristles of the cylinders' seals.
inline constexpr const char* sticking_seals = "sticking cylinder seals of all legs";

struct UnlistedCase {
  std::string physics{};  ///< what was planted, with its size
  BlindCase basic{};  ///< machine, design, poses, noise; `fault` holds what a machine file states
  /// Modes of the machine with `fault` at a pose; none: those of its linear model.
  Modes modes{};
  /// What is wrong with the measurement itself.
  std::function<void(observation::Targets&)> misread{};
  /// Parts of the names of candidate causes that are this very part, whose law is another, or whose
  /// number the data cannot tell from what was planted: whoever is sent there finds what is wrong.
  std::vector<std::string> same_parts{};
};

struct UnlistedResult {
  diagnosis::Diagnosis diagnosis{};
  std::string refused{};  ///< why there is no diagnosis: more modes than the machine has
  double change{};        ///< the largest relative change of a frequency
  bool blamed{};      ///< a candidate cause is identified, or several are said to explain the data
  bool right_part{};  ///< all that is blamed is of `same_parts`
};

/// All cases of the series, or those of its first machines, which take less time to make. Bristles
/// of the cylinders' seals are a candidate cause with one spring for all modes and legs; harmonic
/// balance has another one for each.
/// `draw`: other sizes, noise and random machines.
std::vector<UnlistedCase> unlisted_cases(std::size_t machines = 1000, unsigned draw = 0);

/// Those with bristles, at two amplitudes.
std::vector<UnlistedCase> sticking_cases();

/// What is measured of a case.
observation::Targets measure_unlisted(const UnlistedCase& test);

UnlistedResult run_unlisted(const UnlistedCase& test,
                            const diagnosis::DiagnoseOptions& options = {});

}  // namespace hydrapod::test
