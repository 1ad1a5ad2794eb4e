#pragma once
/// A diagnosis as JSON and as a picture. The fields are documented in docs/howto/json.md.

#include "hydrapod/diagnosis/summary.hpp"
#include "hydrapod/report/json.hpp"

namespace hydrapod::report {

/// `summary[]`, `finding`, `explanations[]`, `measured_modes[]`, `discriminators[]`,
/// `attribution[]`, `remedy`.
Json diagnosis_json(const diagnosis::CaseFile& file);

/// Measured beside rigid and best explanation, ranking, frequency against stiffness; what there is
/// of these. Throws as report's other pictures do.
void plot_diagnosis(const diagnosis::CaseFile& file, const std::string& path);

}  // namespace hydrapod::report
