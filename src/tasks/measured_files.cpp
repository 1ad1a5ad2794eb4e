#include "measured_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"

namespace hydrapod::tasks {

void add_warning(const std::string& file, const std::string& text, Diagnostics& warnings) {
  warnings.push_back({.severity = base::Severity::warning, .file = file, .message = text});
}

void add_new_warnings(const std::string& file, const std::vector<data::ResponseWarning>& found,
                      Diagnostics& warnings) {
  for (const auto& warning : found) {
    const std::string text = report::warning_text(warning);
    if (std::ranges::find(warnings, text, &base::Diagnostic::message) == warnings.end())
      add_warning(file, text, warnings);
  }
}

void append(const Diagnostics& more, Diagnostics& all) {
  all.insert(all.end(), more.begin(), more.end());
}

report::Json parsed_json(const std::string& path, const std::vector<std::string>& kinds) {
  constexpr std::size_t largest = std::size_t{1} << 29;  // its values take several times as much
  report::Json json;
  try {
    json = report::Json::parse(base::read_file(path, largest, "JSON of hydrapod"));
  } catch (const nlohmann::json::parse_error& error) {
    const std::string_view what = error.what();  // "[json.exception.…] parse error at line …"
    base::refuse(path, "is not JSON: " + base::printable(what.substr(what.find(']') + 2), 300));
  }
  const auto kind = json.is_object() ? json.find("kind") : json.end();
  if (kind == json.end() || std::ranges::count(kinds, kind->dump()) > 0) return json;
  throw base::InputError({{.file = path,
                           .key = "kind",
                           .message = fmt::format("is {}; accepted here are {}", kind->dump(),
                                                  fmt::join(kinds, ", "))}});
}

void refuse_modal_results(const std::string& path) {
  if (data::file_kind(path) == data::FileKind::modal_results)
    base::refuse(path,
                 "holds modes (dataset 55 or 2414) without their uncertainties; JSON or CSV of "
                 "`hydrapod identify` has them");
}

Measured responses_from(const report::Json& json, const std::string& path) {
  Measured measured;
  measured.measurement.responses = report::responses_from_json(json, path);
  measured.header = report::record_origin_from_json(json, path);
  add_warnings(path, measured.measurement.responses.warnings, measured.warnings);
  return measured;
}

}  // namespace hydrapod::tasks
