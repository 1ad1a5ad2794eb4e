#include "variables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "hydrapod/base/units.hpp"

namespace hydrapod::calibration {

namespace {

constexpr double decade = 10.0;

class VariableMaker {
 public:
  VariableMaker(const FreeParameter& free, const model::VariableMachine& machine,
                std::vector<base::Diagnostic>& errors)
      : free_(free), machine_(machine), errors_(errors) {}

  Variable make() {
    Variable variable{.paths = free_.paths};
    const auto* number = find_paths();
    if (number == nullptr) return variable;
    for (const auto& path : free_.paths) variable.ids.push_back(machine_.id(path));
    variable.unit = number->unit;
    variable.start = free_.start ? amount(*free_.start, "start") : number->value;
    set_bounds(variable);
    if (free_.prior) {
      variable.prior =
          Prior{amount(free_.prior->value, "prior"), amount(free_.prior->spread, "prior")};
      if (!(variable.prior->spread > 0.0)) error("prior: expected a spread above 0");
    }
    return variable;
  }

 private:
  void error(const std::string& message) {
    errors_.push_back({base::Severity::error, free_.origin.file, free_.origin.line,
                       free_.origin.column, free_.paths.empty() ? "" : free_.paths.front(),
                       message});
  }

  const model::FileNumber* find_paths() {
    const model::FileNumber* first = nullptr;
    for (const auto& path : free_.paths) {
      const auto* number = machine_.find(path);
      if (number == nullptr) {
        const auto near = machine_.nearest_path(path);
        error(fmt::format("the machine file has no number `{}`{}", path,
                          near.empty() ? "; `hydrapod sensitivity FILE` lists those that matter"
                                       : fmt::format("; did you mean `{}`?", near)));
        return nullptr;
      }
      if (first == nullptr) first = number;
      if (number->unit != first->unit) {
        error(fmt::format("`{}` is in {} and `{}` in {}; they cannot be tied to one value", path,
                          number->unit, first->path, first->unit));
        return nullptr;
      }
    }
    if (first == nullptr) error("no path is given");
    return first;
  }

  double amount(const Amount& amount, const char* what) {
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
    const auto read = base::read_quantity(text, machine_.find(free_.paths.front())->unit);
    if (!read.ok()) error(fmt::format("{}: {}", what, read.problem));
    return read.value;
  }

  void set_bounds(Variable& v) {
    const auto bound = [&](const std::optional<Amount>& given, double fallback) {
      return given ? amount(*given, "bounds") : fallback;
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
    v.sign = v.lower > 0.0 ? 1 : v.upper < 0.0 ? -1 : 0;
    constexpr double share = 0.1;
    v.scale = std::max(std::abs(v.start), share * (v.upper - v.lower));
  }

  const FreeParameter& free_;
  const model::VariableMachine& machine_;
  std::vector<base::Diagnostic>& errors_;
};

void check_repeats(const std::vector<FreeParameter>& free, std::vector<base::Diagnostic>& errors) {
  std::set<std::string> seen;
  for (const auto& parameter : free)
    for (const auto& path : parameter.paths)
      if (!seen.insert(path).second)
        errors.push_back({base::Severity::error, parameter.origin.file, parameter.origin.line,
                          parameter.origin.column, path, "is free twice"});
}

}  // namespace

std::vector<Variable> make_variables(const std::vector<FreeParameter>& free,
                                     model::VariableMachine& machine,
                                     std::vector<base::Diagnostic>& errors) {
  check_repeats(free, errors);
  std::vector<Variable> variables;
  std::vector<model::TiedPaths> paths;
  for (const auto& parameter : free) {
    variables.push_back(VariableMaker(parameter, machine, errors).make());
    paths.push_back(parameter.paths);
  }
  if (!errors.empty()) return variables;
  machine.vary(paths);
  for (std::size_t j = 0; j < free.size(); ++j)
    if (!machine.matters(j))
      errors.push_back({base::Severity::error, free[j].origin.file, free[j].origin.line,
                        free[j].origin.column, free[j].paths.front(),
                        "has no effect on the modes; it cannot be fitted"});
  return variables;
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
