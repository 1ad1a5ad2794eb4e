#pragma once
/// Tables that `hydrapod identify` prints.

#include <string>

#include "hydrapod/identification/bootstrap.hpp"
#include "hydrapod/identification/realisation.hpp"
#include "hydrapod/identification/second_opinion.hpp"
#include "hydrapod/report/mode_comparison.hpp"
#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

/// What there is besides the modes.
struct Checks {
  std::vector<std::optional<identification::SecondOpinion>> opinions{};  ///< per mode, or empty
  std::optional<identification::BootstrapScatter> bootstrap{};
};

/// `measured` and `frame` say what was measured and how it was brought to directions.
std::string modes_text(const identification::Identification& result, const Checks& checks,
                       const std::string& measured, const std::string& frame,
                       const TableStyle& style);

std::string comparison_text(const report::ComparedModes& compared,
                            const identification::Identification& result, const TableStyle& style);

std::string output_only_text(const std::vector<identification::OutputOnlyMode>& modes,
                             std::size_t outputs, int block, const TableStyle& style);

}  // namespace hydrapod::cli
