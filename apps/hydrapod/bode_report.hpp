#pragma once
/// Bode diagrams as people read them.

#include <string>

#include "hydrapod/report/bode.hpp"

namespace hydrapod::cli {

/// Peaks of the six direct responses, flexible and rigid.
std::string peak_text(const report::Bode& bode, bool colour);

/// Title and assumptions for a plot.
report::PlotText plot_text(const model::Machine& machine, const report::PoseChoice& pose,
                           const report::Bode& bode);

}  // namespace hydrapod::cli
