#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/study/study.hpp"

namespace hydrapod::study {

std::optional<std::size_t> pose_of(const model::ParameterId& id) {
  if (!model::row_of(id).path.starts_with("poses.*.")) return std::nullopt;
  return static_cast<std::size_t>(id.of - 1);
}

namespace {

constexpr int digits = 17;  ///< a number is read back bit for bit

/// The number at `path`. Throws base::InputError with the path that was probably meant.
model::FileNumber number_at(const model::MachineFile& file, const std::string& path,
                            const std::string& place) {
  if (auto number = find_number(file, path)) return *number;
  const std::string near = nearest_parameter(file, path);
  base::refuse(place, "the machine file has no such number" +
                          (near.empty() ? std::string("; `hydrapod sensitivity` lists them")
                                        : fmt::format("; did you mean `{}`?", near)));
}

void refuse_forbidden(const model::FileNumber& number, const Distribution& d,
                      const std::string& place) {
  if (d.shape != Shape::normal) return;
  const auto& bound = row_of(number.id).bound;
  // Beyond four deviations is one sample in 31 574; nearer, a run of any size has some.
  constexpr double far = 4.0;
  const double low = d.low.value_or(d.a - far * d.b), high = d.high.value_or(d.a + far * d.b);
  if (low >= bound.lowest && high <= bound.highest) return;
  base::refuse(place,
               fmt::format("four standard deviations from the mean reach {:.4g} {}, which "
                           "the machine cannot have; use lognormal, or add \"within A .. B\"",
                           low < bound.lowest ? low : high, number.unit));
}

/// A distribution, and what stands behind it: "per leg", "per leg correlated 0.6".
struct VariationParts {
  std::string_view distribution{};
  bool per_leg{};
  double correlated{};
};

VariationParts parts_of(std::string_view text, const std::string& place) {
  constexpr std::string_view per_leg = "per leg", correlated = "correlated";
  constexpr double least_of_legs = -1.0 / (model::leg_count - 1);
  VariationParts parts{.distribution = base::trimmed(text)};
  auto& rest = parts.distribution;
  if (const auto at = rest.find(correlated); at != std::string_view::npos) {
    const auto behind = base::trimmed(rest.substr(at + correlated.size()));
    rest = base::trimmed(rest.substr(0, at));
    parts.correlated = read_correlation(behind, place);
    if (parts.correlated < least_of_legs)
      base::refuse(place, fmt::format("six numbers can have {:g} with each other at the least, not "
                                      "{:g}",
                                      least_of_legs, parts.correlated));
    if (!rest.ends_with(per_leg))
      base::refuse(place,
                   "\"correlated\" is how the numbers of the legs depend on each other and stands "
                   "behind \"per leg\"; --correlate is for numbers of two paths");
  }
  parts.per_leg = rest.ends_with(per_leg);
  if (parts.per_leg) rest = base::trimmed(rest.substr(0, rest.size() - per_leg.size()));
  return parts;
}

}  // namespace

double read_correlation(std::string_view text, const std::string& place) {
  const auto read = base::read_plain_or_quantity(std::string(text), "1");
  if (!read.ok() || !(std::abs(read.value) <= 1.0))
    base::refuse(place, fmt::format("'{}' is not a correlation; expected a number from -1 to 1",
                                    base::printable(std::string(text))));
  return read.value;
}

std::vector<Input> read_variation(const model::MachineFile& file, const std::string& path,
                                  const std::string& text, const std::string& place) {
  const auto number = number_at(file, path, place);
  const auto [rest, each, correlated] = parts_of(text, place);
  Input one{.name = path,
            .unit = number.unit,
            .distribution = read_distribution(rest, number.unit, number.value, place),
            .id = number.id,
            .correlated = correlated};
  refuse_forbidden(number, one.distribution, place);
  if (!each) return {one};
  if (!path.starts_with(model::of_legs))
    base::refuse(place, "\"per leg\" is for numbers of all legs, whose path begins with `legs.`");
  std::vector<Input> six;
  for (int leg = 1; leg <= model::leg_count; ++leg) {
    one.name = fmt::format("leg.{}.{}", leg, path.substr(model::of_legs.size()));
    const auto of_leg = number_at(file, one.name, place);
    one.id = of_leg.id;
    one.distribution = read_distribution(rest, number.unit, of_leg.value, place);
    six.push_back(one);
  }
  return six;
}

namespace {

/// Throws where all machines or none meet a bound by what the output is.
void require_in_reach(const Column& output, bool at_least, double bound, const std::string& place) {
  const bool share = output.name == "mac" || output.name.starts_with("share");
  if (output.unit == "Hz" && !(bound > 0.0))
    base::refuse(place, fmt::format("{} machine meets that; a frequency is more than 0",
                                    at_least ? "every" : "no"));
  if (at_least && output.name.starts_with("drop") && bound > 1.0)
    base::refuse(place, "no machine meets that; a drop is at most 100 %");
  if (at_least && share && bound > 1.0)
    base::refuse(place, "no machine meets that; it is at most 1");
  if (!at_least && share && bound < 0.0)
    base::refuse(place, "no machine meets that; it is at least 0");
  if (!at_least && output.name == "condition" && bound < 1.0)
    base::refuse(place, "no machine meets that; a condition is at least 1");
}

}  // namespace

Requirement read_requirement(const std::string& text, const std::vector<Column>& outputs,
                             const std::string& place) {
  const auto at = text.find_first_of("<>");
  if (at == std::string::npos || at + 1 >= text.size() || text[at + 1] != '=')
    base::refuse(place,
                 "expected an output, >= or <=, and a bound: \"x >= 6 Hz\", \"drop <= 2 %\"");
  const std::string name(base::trimmed(std::string_view(text).substr(0, at)));
  const auto found = std::ranges::find(outputs, name, &Column::name);
  if (found == outputs.end()) {
    std::vector<std::string_view> names;
    for (const auto& output : outputs) names.push_back(output.name);
    const auto near = base::nearest(name, names);
    base::refuse(place, fmt::format("unknown output '{}'; {}outputs are {}", base::printable(name),
                                    near ? fmt::format("did you mean '{}'? ", *near) : "",
                                    fmt::join(names, ", ")));
  }
  const std::string bound(base::trimmed(std::string_view(text).substr(at + 2)));
  const auto read = base::read_plain_or_quantity(bound, found->unit);
  if (!read.ok())
    base::refuse(place, fmt::format("'{}': {}", base::printable(bound), read.problem));
  require_in_reach(*found, text[at] == '>', read.value, place);
  return {text, static_cast<int>(found - outputs.begin()), text[at] == '>', read.value};
}

std::string machine_text(const model::MachineFile& file, const std::vector<Input>& inputs,
                         std::span<const double> values, const std::string& label) {
  auto edits = model::edits_of_overrides(file.text, file.overrides);
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const auto unit = model::written_unit(file.text, inputs[k].name, inputs[k].unit);
    std::vector<std::string> paths;
    for (const auto& given : file.given)
      if (given.id == inputs[k].id) paths.push_back(given.written);
    if (paths.empty()) paths.push_back(inputs[k].name);
    for (const auto& at : paths) {
      std::erase_if(edits, [&](const auto& edit) { return edit.path == at; });
      edits.push_back({.path = at,
                       .value = model::written(values[k], unit, digits),
                       .remark = std::string(model::last_key(at))});
    }
  }
  const std::string text = model::edited_file(file.text, edits, label);
  constexpr double rounding = 1e-12;  // of a unit's factor, there and back
  const auto edited = model::parse_machine(text, label, {}, {});
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const auto number = find_number(edited, inputs[k].name);
    if (!number || std::abs(number->value - values[k]) > rounding * std::abs(values[k]))
      throw base::ComputationError(
          fmt::format("`{}` could not be written into the machine file", inputs[k].name));
  }
  return text;
}

}  // namespace hydrapod::study
