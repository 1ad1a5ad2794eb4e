#pragma once
/// A diagnosis as JSON and as a picture; modes out of the JSON of `hydrapod identify`. The fields
/// are documented in docs/howto/json.md.

#include "hydrapod/diagnosis/summary.hpp"
#include "hydrapod/report/json.hpp"

namespace hydrapod::report {

/// `summary[]`, `finding`, `explanations[]`, `measured_modes[]`, `discriminators[]`,
/// `attribution[]`, `remedy`.
Json diagnosis_json(const diagnosis::CaseFile& file);

/// Modes out of `kind: identified_modes`. Throws base::InputError naming what is missing; `file` is
/// what messages call it.
observation::Targets modes_from_json(const Json& json, const std::string& file,
                                     const model::Machine& machine,
                                     const observation::MeasuredAt& at);

/// Measured beside rigid and best explanation, ranking, frequency against stiffness; what there is
/// of these. Throws as report's other pictures do.
void plot_diagnosis(const diagnosis::CaseFile& file, const std::string& path);

}  // namespace hydrapod::report
