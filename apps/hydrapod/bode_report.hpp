#pragma once
/// Bode diagrams as people read them.

#include <string>

#include "hydrapod/tasks/linear.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

/// What was swept, and the peaks of the six direct responses, flexible and rigid.
std::string peak_text(const report::Bode& bode, const TableStyle& style);

/// Bandwidths, peaks and couplings of the response from command to pose.
std::string command_text(const report::CommandResponse& response, const TableStyle& style);

/// Title and assumptions for a plot.
report::PlotText plot_text(const tasks::Machine& machine, const report::Bode& bode);

}  // namespace hydrapod::cli
