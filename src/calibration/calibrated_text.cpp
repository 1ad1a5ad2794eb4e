#include <fmt/format.h>

#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/calibration/calibrate.hpp"
#include "hydrapod/model/file_edit.hpp"
#include "hydrapod/model/variable_machine.hpp"

namespace hydrapod::calibration {

namespace {

constexpr int digits = 9;

/// A value as --set takes it, as TOML.
std::string as_toml(const std::string& value) {
  const auto first = value.find_first_not_of(" \t");
  const char c = first == std::string::npos ? ' ' : value[first];
  const bool quoted = c == '"' || c == '\'' || c == '[' || c == '{';
  const bool number = value.find_first_not_of("0123456789.+-eE_ ") == std::string::npos;
  const bool word = value == "true" || value == "false";
  return quoted || number || word ? value.substr(first) : fmt::format("\"{}\"", value);
}

std::string last_key(const std::string& path) {
  const auto dot = path.rfind('.');
  return dot == std::string::npos ? path : path.substr(dot + 1);
}

/// "7.21 ± 0.05 kg", "7.21 kg, not determined by the data"
std::string value_text(const FittedParameter& p, const model::WrittenUnit& unit) {
  const std::string name = !unit.name.empty() ? unit.name : p.unit == "1" ? "" : p.unit;
  const std::string value = fmt::format("{:.5g}", p.value / unit.size);
  const std::string spread = fmt::format(" ± {:.2g}", p.deviation / unit.size);
  const std::string in_unit = name.empty() ? "" : " " + name;
  switch (p.verdict) {
    case Verdict::determined:
      return value + spread + in_unit;
    case Verdict::by_prior:
      return value + spread + in_unit + " by the prior";
    case Verdict::at_bound:
      return value + in_unit + " at its bound";
    case Verdict::undetermined:
      break;
  }
  return value + in_unit + " not determined by the data";
}

model::FileEdit edit_of(const std::string& text, const std::string& path,
                        const FittedParameter& p) {
  const auto unit = model::written_unit(text, path, p.unit);
  return {
      path, model::written(p.value, unit, digits),
      fmt::format("{} {} (was {:.5g})", last_key(path), value_text(p, unit), p.start / unit.size)};
}

/// The text must be read as the machine that was fitted.
void verify(const model::MachineFile& file, const std::string& text, const Candidate& candidate) {
  model::MachineFile edited = file;
  edited.text = text;
  const model::VariableMachine machine(edited);
  constexpr double rounding = 1e-8;
  for (const auto& p : candidate.parameters)
    for (const auto& path : p.paths) {
      const auto* number = machine.find(path);
      if (number == nullptr || std::abs(number->value - p.value) > rounding * std::abs(p.value))
        throw base::ComputationError(
            fmt::format("`{}` could not be written into the machine file", path));
    }
}

}  // namespace

std::string calibrated_text(const model::MachineFile& file, const Candidate& candidate) {
  std::vector<model::FileEdit> edits;
  auto overrides = file.overrides;
  overrides.insert(overrides.end(), candidate.overrides.begin(), candidate.overrides.end());
  for (const auto& text : overrides) {
    const auto equals = text.find('=');
    const std::string path = text.substr(0, text.find_last_not_of(" \t", equals - 1) + 1);
    edits.push_back({path, as_toml(text.substr(equals + 1)), last_key(path) + " chosen"});
  }
  for (const auto& p : candidate.parameters)
    for (const auto& path : p.paths) {
      std::erase_if(edits, [&](const model::FileEdit& edit) { return edit.path == path; });
      edits.push_back(edit_of(file.text, path, p));
    }
  const std::string text = model::edited_file(file.text, edits, "calibrated");
  model::MachineFile without = file;
  without.overrides.clear();
  verify(without, text, candidate);
  return text;
}

}  // namespace hydrapod::calibration
