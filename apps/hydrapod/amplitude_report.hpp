#pragma once
/// `hydrapod modes --amplitude`.

#include <string>
#include <vector>

#include "hydrapod/report/model_results.hpp"
#include "hydrapod/tasks/machine.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

/// "1 mm", or FROM:TO:COUNT with equal ratios. Refuses what is neither.
std::vector<double> amplitudes_of(const std::string& text);

std::string amplitudes_text(const tasks::Machine& machine, const report::ModesAtAmplitudes& modes,
                            const TableStyle& style);

void plot_amplitudes(const tasks::Machine& machine, const report::ModesAtAmplitudes& modes,
                     const std::string& path);

}  // namespace hydrapod::cli
