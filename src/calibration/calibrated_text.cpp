#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "candidate.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/model/machine_file.hpp"

namespace hydrapod::calibration {

namespace {

constexpr int digits = 9;
constexpr const char* label = "calibrated";  ///< of the remarks

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
    case Verdict::ambiguous:
      return fmt::format("{}{}, or {:.5g}", value, in_unit, *p.other_value / unit.size);
    case Verdict::undetermined:
      break;
  }
  return value + in_unit + " not determined by the data";
}

/// `value` [SI] with as many digits as it takes to be read as the same again.
std::string unchanged(double value, const model::WrittenUnit& unit) {
  constexpr int most = 17;
  for (int count = digits; count < most; ++count) {
    const std::string text = model::written(value, unit, count);
    double number = 0.0;
    std::from_chars(text.data() + (unit.name.empty() ? 0 : 1), text.data() + text.size(), number);
    if (number * unit.size == value) return text;
  }
  return model::written(value, unit, most);
}

/// `before`: the value in the file, with the choices made [SI].
model::FileEdit edit_of(const std::string& text, const std::string& path, const FittedParameter& p,
                        double before) {
  const auto unit = model::written_unit(text, path, p.unit);
  if (p.verdict == Verdict::undetermined && p.value == before)
    return {path, unchanged(before, unit),
            fmt::format("{} not determined by the data, left as it was", model::last_key(path))};
  return {path, model::written(p.value, unit, digits),
          fmt::format("{} {} (was {:.5g})", model::last_key(path), value_text(p, unit),
                      before / unit.size)};
}

/// Where the number stands in the file, or where it would; an element of a tensor that is given in
/// rows stands there twice.
std::vector<std::string> written_paths(const model::MachineFile& file,
                                       const model::ParameterId& id) {
  std::vector<std::string> paths;
  for (const auto& given : file.given)
    if (given.id == id) paths.push_back(given.written);
  if (paths.empty()) paths.push_back(path(file.machine, id));
  return paths;
}

/// The text must be read as the machine that was fitted.
void verify(const std::string& text, const Candidate& candidate) {
  const auto edited = model::parse_machine(text, "calibrated machine", {}, {});
  constexpr double rounding = 1e-8;
  for (const auto& p : candidate.parameters)
    for (const auto& path : p.paths) {
      const auto id = find_parameter(edited, path);
      const auto value = id ? model::value(edited.machine, *id) : std::nullopt;
      if (!value || std::abs(*value - p.value) > rounding * std::abs(p.value))
        throw base::ComputationError(
            fmt::format("`{}` could not be written into the machine file", path));
    }
}

}  // namespace

void require_possible_targets(const Candidate& candidate, const observation::Targets& targets) {
  constexpr double many = 100.0;  // standard deviations
  constexpr double apart = 1.25;  // ratio of the frequencies
  std::optional<std::size_t> worst;
  for (std::size_t i = 0; i < candidate.targets.size(); ++i) {
    const auto& target = candidate.targets[i];
    const double off = std::abs(std::log(target.omega / targets.modes[i].omega));
    if (target.outlier || !(std::abs(target.difference) > many) || !(off > std::log(apart)))
      continue;
    if (!worst || std::abs(target.difference) > std::abs(candidate.targets[*worst].difference))
      worst = i;
  }
  if (!worst) return;
  const auto& target = candidate.targets[*worst];
  throw base::ComputationError(fmt::format(
      "the machine is not calibrated: target {} is {:.0f} σ from the mode paired with "
      "it, which has {:.4g} Hz; check the unit of the target and the machine",
      targets.modes[*worst].name, std::abs(target.difference), target.omega / base::two_pi));
}

std::string calibrated_text(const model::MachineFile& file, const Candidate& candidate,
                            const observation::Targets& targets) {
  require_possible_targets(candidate, targets);
  const auto before = file_with_choices(file, candidate);
  auto edits = model::edits_of_overrides(file.text, before.overrides);
  for (auto& edit : edits) edit.remark = fmt::format("{} chosen", model::last_key(edit.path));
  const std::string with_choices = model::edited_file(file.text, edits, label);
  for (const auto& p : candidate.parameters)
    for (const auto& path : p.paths) {
      const auto id = find_parameter(before, path).value();
      for (const auto& at : written_paths(before, id)) {
        std::erase_if(edits, [&](const auto& edit) { return edit.path == at; });
        edits.push_back(edit_of(with_choices, at, p, value(before.machine, id).value()));
      }
    }
  edits.push_back({.path = "state", .value = fmt::format("\"{}\"", label)});
  const std::string text = model::edited_file(file.text, edits, label);
  verify(text, candidate);
  return text;
}

}  // namespace hydrapod::calibration
