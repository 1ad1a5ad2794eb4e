#pragma once
/// Warnings, and files of responses and modes. Private to the module.

#include <string>
#include <vector>

#include "hydrapod/tasks/measurement.hpp"

namespace hydrapod::tasks {

using Diagnostics = std::vector<base::Diagnostic>;

void add_warning(const std::string& file, const std::string& text, Diagnostics& warnings);

/// Those of responses or of identified modes, in words.
template <class Warning>
void add_warnings(const std::string& file, const std::vector<Warning>& found,
                  Diagnostics& warnings) {
  for (const auto& warning : found) add_warning(file, report::warning_text(warning), warnings);
}

/// What was said of responses while modes were found in them, and is not said yet.
void add_new_warnings(const std::string& file, const std::vector<data::ResponseWarning>& found,
                      Diagnostics& warnings);

void append(const Diagnostics& more, Diagnostics& all);

/// Modes of what was measured as `measure` says. Responses of a record that is too short for any
/// become those of the model that gave the modes; where that gives none, it is measured again with
/// averages, unless the whole record was asked for.
identification::Identification modes_of(Measured& measured, const MeasureOptions& measure,
                                        const identification::IdentifyOptions& options,
                                        const std::function<void(double)>& progress);

/// The JSON in `path`, whose kind must be one of `kinds`.
report::Json parsed_json(const std::string& path, const std::vector<std::string>& kinds);

/// Throws base::InputError where `path` holds modes without their uncertainties.
void refuse_modal_results(const std::string& path);

/// Responses and their experiment.
Measured responses_from(const report::Json& json, const std::string& path);

}  // namespace hydrapod::tasks
