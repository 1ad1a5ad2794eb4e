#include "hydrapod/calibration/calibrate.hpp"

#include <fmt/format.h>

#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "target_tables.hpp"

namespace hydrapod::calibration {

namespace {

constexpr std::size_t largest_file = std::size_t{1} << 20;

TargetsFile parse_toml(const std::string& text, const std::string& file,
                       const std::vector<std::string>& poses) {
  auto parsed = model::parse_tree(text, 0);
  if (const auto* error = std::get_if<model::SyntaxError>(&parsed))
    throw base::InputError({{base::Severity::error, file, error->place.line, error->place.column,
                             "", error->message}});
  model::Faults faults({file});
  TargetsFile targets = read_target_tables(std::get<model::Node>(parsed), file, poses, faults);
  if (faults.any_error()) throw base::InputError(faults.diagnostics(base::Severity::error));
  return targets;
}

}  // namespace

TargetsFile parse_targets(const std::string& text, const std::string& file_name,
                          const std::vector<std::string>& poses) {
  if (base::has_ending(file_name, {".csv"}))
    return {.targets = parse_target_csv(text, file_name, poses)};
  return parse_toml(text, file_name, poses);
}

TargetsFile read_targets(const std::string& path, const std::vector<std::string>& poses) {
  return parse_targets(base::read_file(path, largest_file, "a targets file"), path, poses);
}

}  // namespace hydrapod::calibration
