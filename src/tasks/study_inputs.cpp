#include "study_inputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"

namespace hydrapod::tasks {

namespace {

constexpr int most_of_a_range = 1'000'000;

double number_of(const std::string& text, const std::string& unit, const std::string& place) {
  const auto read = base::read_plain_or_quantity(text, unit);
  if (!read.ok()) base::refuse(place, fmt::format("'{}': {}", text, read.problem));
  return read.value;
}

/// "4:6:11 kN/mm": from, to, count; the unit may stand behind any number.
study::Distribution range_of(const Varied& varied, const std::string& unit, bool grid) {
  auto parts = base::split(varied.text, ":");
  const auto last = parts.back();
  const auto blank = last.find(' ');
  const std::string behind = blank == std::string::npos ? "" : last.substr(blank);
  const std::size_t wanted = grid ? 3 : 2;
  if (parts.size() != wanted)
    base::refuse(varied.place,
                 grid ? "expected from:to:count, for instance \"2:20:10 kN/mm\", or a list"
                      : "expected from:to; the number of values is that of --samples");
  const auto with_unit = [&](const std::string& part) {
    return number_of(part.find_first_of(" %") == std::string::npos ? part + behind : part, unit,
                     varied.place);
  };
  const double from = with_unit(parts[0]), to = with_unit(parts[1]);
  if (from == to) base::refuse(varied.place, "both ends are equal");
  if (!grid)
    return {.shape = study::Shape::uniform, .a = std::min(from, to), .b = std::max(from, to)};
  const auto count = base::read_quantity(std::string_view(last).substr(0, blank), "1");
  if (!count.ok() || count.value != std::floor(count.value) || count.value < 2 ||
      count.value > most_of_a_range)
    base::refuse(varied.place,
                 fmt::format("'{}' is not a count; expected a whole number from 2 to {}", last,
                             most_of_a_range));
  study::Distribution d{.shape = study::Shape::values};
  for (int k = 0; k < static_cast<int>(count.value); ++k)
    d.list.push_back(from + (to - from) * k / (count.value - 1.0));
  return d;
}

/// "1, 2, 5 kN/mm"
study::Distribution list_of(const Varied& varied, const std::string& unit) {
  const auto parts = base::split(varied.text, ",");
  const auto blank = parts.back().find(' ');
  const std::string behind = blank == std::string::npos ? "" : parts.back().substr(blank);
  study::Distribution d{.shape = study::Shape::values};
  for (const auto& part : parts)
    d.list.push_back(
        number_of(part.find(' ') == std::string::npos ? part + behind : part, unit, varied.place));
  return d;
}

}  // namespace

model::FileNumber number_at(const Machine& machine, const std::string& path,
                            const std::string& place) {
  if (auto number = find_number(machine.file, path)) return *number;
  const std::string near = nearest_parameter(machine.file, path);
  base::refuse(place, "the machine file has no such number" +
                          (near.empty() ? "" : fmt::format("; did you mean `{}`?", near)));
}

study::Input input_over(const Machine& machine, const Varied& varied, bool poses, bool grid) {
  study::Input input{.name = varied.path};
  if (poses) {
    const auto direction = spatial::direction_from_name(varied.path);
    if (!direction)
      base::refuse(varied.place, "unknown direction; directions are x, y, z, rx, ry, rz");
    input.unit = *direction < 3 ? "m" : "rad";
  } else {
    const auto number = number_at(machine, varied.path, varied.place);
    input.unit = number.unit;
    input.id = number.id;
  }
  input.distribution = varied.text.find(':') == std::string::npos
                           ? list_of(varied, input.unit)
                           : range_of(varied, input.unit, grid);
  return input;
}

std::vector<base::Diagnostic> of_other_poses(const Machine& machine,
                                             const std::vector<study::Input>& inputs,
                                             const std::vector<model::NamedPose>& poses) {
  std::vector<base::Diagnostic> errors;
  std::vector<std::string_view> names;
  for (const auto& pose : poses) names.push_back(pose.name);
  for (const auto& input : inputs) {
    const auto number = study::pose_of(input.id);
    if (!number) continue;
    const auto& name = machine.file.machine.poses.at(*number).name;
    if (std::ranges::count(names, name) == 0)
      errors.push_back({.file = input.name,
                        .message = fmt::format("has no effect at pose {}; expected is a number of "
                                               "that pose, or --pose {}",
                                               fmt::join(names, ", "), name)});
  }
  return errors;
}

std::optional<std::string> no_output_text(const model::Machine& machine, dynamics::ModelKind kind,
                                          const std::vector<study::Column>& outputs,
                                          std::string_view name) {
  const auto why = study::why_no_output(machine, kind, name);
  if (!why) return std::nullopt;
  std::vector<std::string_view> names;
  for (const auto& one : outputs) names.push_back(one.name);
  return fmt::format("{} {}; outputs of this machine are {}", name, *why, fmt::join(names, ", "));
}

void require_output(const model::Machine& machine, dynamics::ModelKind kind,
                    const std::vector<study::Column>& outputs, std::string_view name,
                    const std::string& place) {
  if (const auto text = no_output_text(machine, kind, outputs, name)) base::refuse(place, *text);
}

study::Requirement requirement_of(const model::Machine& machine, dynamics::ModelKind kind,
                                  std::vector<study::Column> outputs, const std::string& text) {
  const auto place = "--want \"" + text + "\"";
  const auto name = base::trimmed(std::string_view(text).substr(0, text.find_first_of("<>")));
  const bool known = std::ranges::find(outputs, name, &study::Column::name) != outputs.end();
  if (!known) require_output(machine, kind, outputs, name, place);
  for (const auto& extra : study::extra_outputs(machine, kind))  // for the message
    if (std::ranges::count(outputs, extra.name, &study::Column::name) == 0)
      outputs.push_back(extra);
  return study::read_requirement(text, outputs, place);
}

std::string duration_text(double seconds) {
  if (seconds < 120) return fmt::format("{:.0f} s", seconds);
  if (seconds < 7200) return fmt::format("{:.0f} min", seconds / 60);
  if (seconds < 172800) return fmt::format("{:.1f} h", seconds / 3600);
  return fmt::format("{:.0f} days", seconds / 86400);
}

namespace {

/// The inputs of one --vary: a path of all legs may have six.
struct Variation {
  std::string path{};
  std::size_t first{}, count{};
};

/// Which inputs a text of --correlate means.
Variation variation_of(const std::string& text, const std::vector<Variation>& variations,
                       const std::vector<study::Input>& inputs, const std::string& place) {
  if (const auto at = std::ranges::find(variations, text, &Variation::path); at != variations.end())
    return *at;
  const auto one = std::ranges::find(inputs, text, &study::Input::name);
  if (one != inputs.end()) return {text, static_cast<std::size_t>(one - inputs.begin()), 1};
  std::vector<std::string_view> names;
  for (const auto& variation : variations) names.push_back(variation.path);
  base::refuse(place, fmt::format("'{}' does not vary; numbers that do are {}",
                                  base::printable(text), fmt::join(names, ", ")));
}

/// "A, B = 0.6" into the matrix. Of two numbers of all legs, those of the same leg.
void add_correlation(const Asked& asked, const std::vector<Variation>& variations,
                     const std::vector<study::Input>& inputs, Eigen::MatrixXd& matrix) {
  const auto equal = asked.text.rfind('=');
  const auto paths = base::split(std::string_view(asked.text).substr(0, equal), ",");
  if (equal == std::string::npos || paths.size() != 2)
    base::refuse(asked.place,
                 "expected two paths and a correlation, \"platform.mass, "
                 "legs.guide_sleeve.stiffness = 0.6\"");
  const double value = study::read_correlation(
      base::trimmed(std::string_view(asked.text).substr(equal + 1)), asked.place);
  const auto one = variation_of(paths[0], variations, inputs, asked.place);
  const auto other = variation_of(paths[1], variations, inputs, asked.place);
  if (one.first == other.first && one.count == other.count)
    base::refuse(asked.place,
                 "names the same number twice; numbers of the legs depend on each "
                 "other with \"per leg correlated 0.6\" in --vary");
  const bool by_leg = one.count > 1 && other.count > 1;
  for (std::size_t i = 0; i < one.count; ++i)
    for (std::size_t j = 0; j < other.count; ++j) {
      if (by_leg && i != j) continue;
      const auto row = static_cast<Eigen::Index>(one.first + i);
      const auto column = static_cast<Eigen::Index>(other.first + j);
      if (row == column || matrix(row, column) != 0.0)
        base::refuse(asked.place,
                     fmt::format("{} and {} have a correlation already", inputs[one.first + i].name,
                                 inputs[other.first + j].name));
      matrix(row, column) = matrix(column, row) = value;
    }
}

/// Empty where all inputs are independent.
Eigen::MatrixXd correlation_of(const StudyOptions& options,
                               const std::vector<Variation>& variations,
                               const std::vector<study::Input>& inputs) {
  const auto n = static_cast<Eigen::Index>(inputs.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(n, n);
  std::string place;
  for (const auto& one : variations)
    for (std::size_t i = 0; i < one.count; ++i)
      for (std::size_t j = 0; j < one.count; ++j) {
        const double value = inputs[one.first].correlated;
        if (i == j || value == 0.0) continue;
        matrix(static_cast<Eigen::Index>(one.first + i), static_cast<Eigen::Index>(one.first + j)) =
            value;
        place = "the correlation of " + one.path;
      }
  for (const auto& asked : options.correlate) {
    add_correlation(asked, variations, inputs, matrix);
    place = asked.place;
  }
  if (place.empty()) return {};
  if (options.plan.indices)
    base::refuse(place,
                 "--indices are for independent inputs: of correlated ones no share of the "
                 "variance belongs to one alone");
  return study::correlation_factor(matrix, place);
}

/// Throws where there would be nothing to take the worst of, or too much.
void check_worst_over(const StudyOptions& options, const std::vector<study::Input>& inputs,
                      std::size_t outer) {
  constexpr double most = 100'000;
  double count = 1.0;
  for (std::size_t k = outer; k < inputs.size(); ++k)
    count *= static_cast<double>(inputs[k].distribution.list.size());
  if (count > most)
    base::refuse(
        options.worst_over.back().place,
        fmt::format("every row would be the worst of {:.6g} poses; at most {:.6g}", count, most));
}

}  // namespace

StudyInputs study_inputs(const Machine& machine, const StudyOptions& options) {
  StudyInputs found;
  auto& inputs = found.inputs;
  std::vector<Variation> variations;
  std::vector<base::Diagnostic> errors;
  const auto gather = [&](const auto& read) {
    try {
      for (auto& input : read()) inputs.push_back(std::move(input));
    } catch (const base::InputError& error) {
      errors.insert(errors.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
  };
  for (const auto& varied : options.vary) {
    const std::size_t first = inputs.size();
    gather([&] {
      return study::read_variation(machine.file, varied.path, varied.text, varied.place);
    });
    variations.push_back({varied.path, first, inputs.size() - first});
  }
  const bool grid = options.plan.design == study::Design::grid;
  for (const auto& varied : options.over)
    gather([&] { return std::vector{input_over(machine, varied, options.poses, grid)}; });
  found.outer = inputs.size();
  for (const auto& varied : options.worst_over)
    gather([&] { return std::vector{input_over(machine, varied, options.poses, true)}; });
  for (std::size_t k = 0; k < inputs.size(); ++k)
    for (std::size_t other = 0; other < k; ++other)
      if (inputs[k].name == inputs[other].name ||
          (!options.poses && inputs[k].id == inputs[other].id))
        errors.push_back({.file = inputs[k].name, .message = "is varied twice"});
  if (!options.poses)
    for (auto& error : of_other_poses(machine, inputs, {machine.pose})) errors.push_back(error);
  if (!errors.empty()) throw base::InputError(errors);
  check_worst_over(options, inputs, found.outer);
  found.correlation = correlation_of(options, variations, inputs);
  return found;
}

namespace {

/// What a requirement bounds.
std::string_view required_output(const std::string& text) {
  return base::trimmed(std::string_view(text).substr(0, text.find_first_of("<>")));
}

/// Those of the extra outputs that a name stands for.
std::vector<std::string> extra_named(const std::vector<study::Column>& extra,
                                     const std::string& name) {
  std::vector<std::string> names;
  for (const auto& column : extra)
    if (column.name == name || column.name.starts_with(name + "_")) names.push_back(column.name);
  return names;
}

}  // namespace

std::vector<std::string> extra_outputs_of(const Machine& machine, const StudyOptions& options) {
  const auto& subject = machine.file.machine;
  const auto all = study::extra_outputs(subject, machine.kind);
  std::vector<std::string> names;
  for (const auto& text : options.want) {  // what is required is computed
    const auto name = required_output(text);
    if (std::ranges::count(all, name, &study::Column::name) > 0) names.emplace_back(name);
  }
  for (const auto& asked : options.only)
    for (auto& name : extra_named(all, asked.text)) names.push_back(std::move(name));
  for (const auto& asked : options.also) {
    auto found = extra_named(all, asked.text);
    std::ranges::move(found, std::back_inserter(names));
    if (!found.empty()) continue;
    require_output(subject, machine.kind, all, asked.text, asked.place);
    std::vector<std::string_view> known;
    for (const auto& column : all) known.push_back(column.name);
    const auto near = base::nearest(asked.text, known);
    base::refuse(asked.place, fmt::format("unknown output '{}'; {}outputs that are computed where "
                                          "they are asked for are {}",
                                          base::printable(asked.text),
                                          near ? fmt::format("did you mean '{}'? ", *near) : "",
                                          fmt::join(known, ", ")));
  }
  return names;
}

std::optional<std::vector<std::string>> only_of(const Machine& machine, const StudyOptions& options,
                                                const std::vector<study::Column>& columns) {
  if (options.only.empty()) return std::nullopt;
  const auto& subject = machine.file.machine;
  const auto extra = study::extra_outputs(subject, machine.kind);
  std::vector<std::string> names;
  for (const auto& asked : options.only) {
    const auto found = study::columns_of_word(columns, asked.text);
    names.insert(names.end(), found.begin(), found.end());
    if (!found.empty() || !extra_named(extra, asked.text).empty()) continue;
    require_output(subject, machine.kind, columns, asked.text, asked.place);
    std::vector<std::string_view> known{"frequencies", "modes", "drops"};
    for (const auto& column : columns) known.push_back(column.name);
    const auto near = base::nearest(asked.text, known);
    base::refuse(
        asked.place,
        fmt::format("unknown output '{}'; {}accepted are {}", base::printable(asked.text),
                    near ? fmt::format("did you mean '{}'? ", *near) : "", fmt::join(known, ", ")));
  }
  for (const auto& text : options.want)
    for (auto& name : study::columns_of_word(columns, required_output(text)))
      names.push_back(std::move(name));
  return names;
}

}  // namespace hydrapod::tasks
