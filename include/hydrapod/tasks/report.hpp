#pragma once
/// The page: one HTML file with modes, Bode diagrams and what was simulated, measured, diagnosed.

#include "hydrapod/report/json.hpp"
#include "hydrapod/tasks/fit.hpp"
#include "hydrapod/tasks/simulation.hpp"

namespace hydrapod::tasks {

struct ReportOptions {
  std::vector<model::NamedPose> poses{};            ///< empty: the machine's pose
  report::HtmlOptions page{};                       ///< `kind` is not used
  std::optional<SimulateOptions> simulation{};      ///< at the first pose
  std::optional<IdentifyOptions> identification{};  ///< beside the modes at the first pose
  /// The page then shows the machine that explains the measurement best, its guilty mode first.
  std::optional<DiagnoseOptions> diagnosis{};
};

struct Report {
  report::Json document{};
  std::vector<base::Diagnostic> warnings{};
};

/// What report::html_page() draws.
Report report_document(const Machine& machine, const ReportOptions& options = {},
                       const Progress& progress = {});

}  // namespace hydrapod::tasks
