#include "variables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "amplitudes.hpp"
#include "hydrapod/base/units.hpp"

namespace hydrapod::calibration {

namespace {

constexpr double decade = 10.0;

base::Diagnostic fault_at(const FreeParameter& free, std::string path, std::string message) {
  const auto& [file, line, column] = free.origin;
  return {base::Severity::error, file, line, column, std::move(path), std::move(message)};
}

class VariableMaker {
 public:
  VariableMaker(const FreeParameter& free, const model::MachineFile& file,
                std::vector<base::Diagnostic>& errors)
      : free_(free), file_(file), errors_(errors) {}

  Variable make() {
    Variable variable{.paths = free_.paths};
    const auto first = find_paths(variable);
    if (!first) return variable;
    variable.unit = first->unit;
    variable.start = free_.start ? amount(*free_.start, variable.unit, "start") : first->value;
    set_bounds(variable);
    if (free_.prior) {
      variable.prior = Prior{amount(free_.prior->value, variable.unit, "prior"),
                             amount(free_.prior->spread, variable.unit, "prior")};
      if (!(variable.prior->spread > 0.0)) error("prior: expected a spread above 0");
    }
    return variable;
  }

 private:
  void error(const std::string& message) {
    errors_.push_back(fault_at(free_, free_.paths.empty() ? "" : free_.paths.front(), message));
  }

  /// The number at the first path; nothing where one of the paths is none that can be tied to it.
  std::optional<model::FileNumber> find_paths(Variable& variable) {
    std::optional<model::FileNumber> first;
    double least = std::numeric_limits<double>::infinity(), greatest = -least;
    for (const auto& path : free_.paths) {
      const auto number = find_number(file_, path);
      if (!number) {
        const auto near = nearest_parameter(file_, path);
        error(fmt::format("the machine file has no number `{}`{}", path,
                          near.empty() ? "; `hydrapod sensitivity FILE` lists those that matter"
                                       : fmt::format("; did you mean `{}`?", near)));
        return std::nullopt;
      }
      if (!first) first = number;
      if (number->unit != first->unit) {
        error(fmt::format("`{}` is in {} and `{}` in {}; they cannot be tied to one value", path,
                          number->unit, first->path, first->unit));
        return std::nullopt;
      }
      variable.ids.push_back(number->id);
      least = std::min(least, number->value);
      greatest = std::max(greatest, number->value);
    }
    if (least < greatest) variable.stated = {least, greatest};
    if (!first) error("no path is given");
    return first;
  }

  double amount(const Amount& amount, const std::string& unit, const char* what) {
    if (const auto* value = std::get_if<double>(&amount)) {
      if (!std::isfinite(*value))
        error(fmt::format("{}: is {}, expected a finite number", what, *value));
      return *value;
    }
    const auto& text = std::get<std::string>(amount);
    double number = 0.0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (status == std::errc{} && end == text.data() + text.size()) {
      if (!std::isfinite(number))
        error(fmt::format("{}: is {}, expected a finite number", what, text));
      return number;
    }
    const auto read = base::read_quantity(text, unit);
    if (!read.ok()) error(fmt::format("{}: {}", what, read.problem));
    return read.value;
  }

  void set_bounds(Variable& v) {
    const auto bound = [&](const std::optional<Amount>& given, double fallback) {
      return given ? amount(*given, v.unit, "bounds") : fallback;
    };
    const bool both = free_.lower && free_.upper;
    if (v.start == 0.0 && !both)
      return error("starts at 0, which has no decade around it; give start or bounds");
    const double small = v.start / decade, large = v.start * decade;
    v.lower = bound(free_.lower, std::min(small, large));
    v.upper = bound(free_.upper, std::max(small, large));
    if (!std::isfinite(v.lower) || !std::isfinite(v.upper) || !std::isfinite(v.start)) return;
    if (v.lower >= v.upper)
      return error(fmt::format("bounds: the lowest value, {:g}, is not below the highest, {:g} {}",
                               v.lower, v.upper, v.unit));
    if (v.start < v.lower || v.start > v.upper)
      return error(
          fmt::format("starts at {:g} {}, which is not within its bounds [{:g}, {:g}]; "
                      "give `start`",
                      v.start, v.unit, v.lower, v.upper));
    set_range(v, v.start, v.lower, v.upper);
  }

  const FreeParameter& free_;
  const model::MachineFile& file_;
  std::vector<base::Diagnostic>& errors_;
};

/// A number has one value, whichever way its paths are written.
void check_repeats(const std::vector<FreeParameter>& free, const std::vector<Variable>& variables,
                   std::vector<base::Diagnostic>& errors) {
  std::vector<model::ParameterId> seen;
  for (std::size_t j = 0; j < free.size(); ++j)
    for (std::size_t k = 0; k < variables[j].ids.size(); ++k) {
      const auto& id = variables[j].ids[k];
      if (std::ranges::count(seen, id) > 0)
        errors.push_back(fault_at(free[j], free[j].paths[k], "is free twice"));
      seen.push_back(id);
    }
}

}  // namespace

std::vector<Variable> make_variables(const std::vector<FreeParameter>& free,
                                     const model::MachineFile& file, const Targets& targets,
                                     std::vector<base::Diagnostic>& errors) {
  std::vector<Variable> variables;
  for (const auto& parameter : free)
    variables.push_back(VariableMaker(parameter, file, errors).make());
  check_repeats(free, variables, errors);
  if (!errors.empty()) return variables;
  const bool at_amplitudes = has_amplitudes(targets);
  for (std::size_t j = 0; j < free.size(); ++j)
    if (std::ranges::none_of(variables[j].ids, [&](const model::ParameterId& id) {
          return model::of_mechanics(file.machine, id) || (at_amplitudes && acts_at_amplitudes(id));
        }))
      errors.push_back(fault_at(free[j], free[j].paths.front(),
                                "has no effect on the modes; it cannot be fitted"));
  return variables;
}

void set_range(Variable& variable, double start, double lower, double upper) {
  constexpr double share = 0.1;
  variable.start = start;
  variable.lower = lower;
  variable.upper = upper;
  variable.sign = lower > 0.0 ? 1 : upper < 0.0 ? -1 : 0;
  variable.scale = std::max(std::abs(start), share * (upper - lower));
}

std::vector<Variable> unbound(std::vector<Variable> variables) {
  for (auto& variable : variables) {
    const double room = 10.0 * std::max(std::abs(variable.lower), std::abs(variable.upper));
    variable.lower = -room;
    variable.upper = room;
    variable.sign = 0;
    variable.scale = std::abs(variable.start) > 0.0 ? std::abs(variable.start) : 0.01 * room;
  }
  return variables;
}

}  // namespace hydrapod::calibration
