#pragma once
/// The answer to the user's question in words and in four numbers: the lowest frequency, the same
/// with rigid legs, the drop, and where the energy of that mode is.

#include <string>

#include "hydrapod/modal/mode_table.hpp"
#include "hydrapod/report/json.hpp"

namespace hydrapod::report {

/// "Lowest mode the platform feels: 7.45 Hz in x; …", one line with its end; empty when there is no
/// such mode.
std::string answer_text(const modal::ModeTable& table);

/// `text`, `stable`, `mode`, `frequency_hz`, `directions`, `strain_energy`, and for models with
/// flexible legs `rigid_mode`, `rigid_frequency_hz`, `drop_percent`; null when the platform feels
/// no mode.
Json answer_json(const modal::ModeTable& table);

}  // namespace hydrapod::report
