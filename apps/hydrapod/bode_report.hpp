#pragma once
/// Bode diagrams as people read them.

#include <cstddef>
#include <string>

#include "hydrapod/report/bode.hpp"
#include "hydrapod/report/system.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

/// What was swept, and the peaks of the six direct responses, flexible and rigid. Tables wider than
/// `width` columns are split.
std::string peak_text(const report::Bode& bode, bool colour, std::size_t width = Table::unlimited);

/// Bandwidths, peaks and couplings of the response from command to pose.
std::string command_text(const report::CommandResponse& response, bool colour,
                         std::size_t width = Table::unlimited);

/// Title and assumptions for a plot.
report::PlotText plot_text(const model::Machine& machine, const report::PoseChoice& pose,
                           const report::Bode& bode);

}  // namespace hydrapod::cli
