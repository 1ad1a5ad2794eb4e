#pragma once
/// Frequency responses and identified modes as files of other programs.

#include "hydrapod/identification/identify.hpp"

namespace hydrapod::report {

/// Modes as Universal File, dataset 55 (data/modal_results.hpp).
void write_modes_uff(const std::string& path, const identification::Identification& result,
                     const std::string& title, const std::string& date);

/// MAT file of version 5. `frequency_hz`, `response` (outputs × inputs × lines), `deviation`,
/// `coherence` (outputs × lines), `condition`, `outputs`, `inputs` with units.
void write_responses_mat(const std::string& path,
                         const identification::FrequencyResponses& responses);

/// The same, and modes: a row each in `pole`, `mode_frequency_hz`, `damping_ratio`, their
/// `…_95`, `mpc`, `mpd_rad`, `quality`, a column each in `shape`, `displacement_shape` and
/// `participation`; `mac`, and the model's response at the lines, `fitted`.
void write_modes_mat(const std::string& path, const identification::Identification& result);

}  // namespace hydrapod::report
