#pragma once
/// Identified modes as the page of `hydrapod report` shows them: with what it takes to switch poles
/// on and off there and to fit the responses anew.

#include <optional>

#include "hydrapod/report/mode_comparison.hpp"

namespace hydrapod::report {

/// "6 inputs, 6 outputs, 200 lines from 1 Hz to 20 Hz, h1 with 45.1 independent averages".
std::string measurement_text(const identification::FrequencyResponses& responses);

/// How outputs were brought to directions: "leg lengths brought to platform directions".
const char* frame_text(bool from_legs, bool from_accelerometers);

struct MeasuredText {
  std::vector<std::string> records{};
  std::string measured{};  ///< "6 inputs, 6 outputs, …"
  std::string frame{};     ///< how outputs were brought to directions
};

/// What identification_json() has, and `records[]`, `measured`, `frame`, `comparison` (or null),
/// `responses`: `frequency_hz[]`, `line[]`, `response[output][input]` with `re[]`, `im[]`,
/// `deviation[]`, `multiple_coherence[]`, at most 1000 lines of them; `taper`: ρ − 1 at steps of
/// `step_s`, null where resonances are not widened; poles of `stabilisation[]` with `pole` and
/// `participation`. Numbers to seven digits.
Json identification_section(const identification::Identification& result,
                            const std::optional<ComparedModes>& compared, const MeasuredText& text);

}  // namespace hydrapod::report
