/// One evaluation by Dakota's files (Dakota Reference Manual, "Parameters file format" and "Results
/// file format").

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "study_inputs.hpp"

namespace hydrapod::tasks {

namespace {

constexpr std::size_t largest_parameters_file = std::size_t{1} << 24U;

/// A line of a parameters file: "value label", or "{ label = value }".
struct Entry {
  std::string label{}, value{};
  unsigned line{}, column{};
};

struct ParametersFile {
  std::string path{};
  std::vector<Entry> variables{};
  std::vector<Entry> requests{};  ///< of the functions; value: 1 value, 2 gradient, 4 Hessian
  std::vector<Entry> by{};        ///< numbers of the variables of gradients, from 1
  std::string id{};
};

[[noreturn]] void refuse_at(const std::string& path, const Entry& entry,
                            const std::string& message) {
  throw base::InputError({{.file = path,
                           .line = entry.line,
                           .column = entry.column,
                           .key = entry.label,
                           .message = message}});
}

/// The lines of the file, whichever of both formats it has.
std::vector<Entry> entries_of(const std::string& path) {
  const auto text = base::read_file(path, largest_parameters_file, "a parameters file of Dakota");
  std::vector<Entry> entries;
  unsigned line = 0;
  for (std::size_t at = 0, end = 0; at < text.size(); at = end + 1) {
    end = std::min(text.find('\n', at), text.size());
    ++line;
    const auto raw = std::string_view(text).substr(at, end - at);
    std::string_view rest = base::trimmed(raw);
    if (rest.empty() || rest.starts_with('#')) continue;
    const auto blanks = static_cast<std::size_t>(rest.data() - raw.data());
    Entry entry{.line = line, .column = static_cast<unsigned>(blanks) + 1};
    if (rest.starts_with('{') && rest.ends_with('}')) {
      rest = base::trimmed(rest.substr(1, rest.size() - 2));
      const auto equals = rest.find('=');
      if (equals == std::string_view::npos) refuse_at(path, entry, "expected { label = value }");
      entry.label = base::trimmed(rest.substr(0, equals));
      entry.value = base::trimmed(rest.substr(equals + 1));
    } else {
      const auto blank = rest.find_first_of(" \t");
      if (blank == std::string_view::npos)
        refuse_at(path, entry,
                  fmt::format("'{}' has no label; expected \"value label\" or \"{{ label = value "
                              "}}\", as Dakota writes",
                              base::printable(rest)));
      entry.value = rest.substr(0, blank);
      entry.label = base::trimmed(rest.substr(blank));
    }
    entries.push_back(std::move(entry));
  }
  return entries;
}

std::optional<double> number_in(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

std::size_t count_in(const std::string& path, const Entry& entry) {
  constexpr double most = 1e6;
  const auto value = number_in(entry.value);
  if (!value || *value < 0.0 || *value > most || *value != std::floor(*value))
    refuse_at(path, entry, fmt::format("'{}' is not a count", base::printable(entry.value)));
  return static_cast<std::size_t>(*value);
}

/// Reads one section after the other: a count with its label, then so many entries.
class Sections {
 public:
  explicit Sections(const std::string& path) : path_(path), entries_(entries_of(path)) {}

  /// `standard` and `aprepro`: labels of the count.
  std::vector<Entry> take(std::string_view standard, std::string_view aprepro) {
    if (at_ == entries_.size())
      base::refuse(path_, fmt::format("ends before the number of {}", standard));
    const Entry head = entries_[at_];
    if (head.label != standard && head.label != aprepro)
      refuse_at(path_, head,
                fmt::format("expected the number of {}, labelled `{}` or `{}`", standard, standard,
                            aprepro));
    const std::size_t count = count_in(path_, head);
    ++at_;
    if (entries_.size() - at_ < count)
      refuse_at(path_, head,
                fmt::format("{} entries are to follow, and the file has {}", count,
                            entries_.size() - at_));
    const auto from = entries_.begin() + static_cast<std::ptrdiff_t>(at_);
    at_ += count;
    return {from, from + static_cast<std::ptrdiff_t>(count)};
  }
  /// The value of the entry with one of both labels among the rest; what else is there (later
  /// versions of Dakota add metadata) is passed over.
  std::string rest(std::string_view standard, std::string_view aprepro) const {
    for (std::size_t k = at_; k < entries_.size(); ++k)
      if (entries_[k].label == standard || entries_[k].label == aprepro) return entries_[k].value;
    return {};
  }

 private:
  std::string path_;
  std::vector<Entry> entries_;
  std::size_t at_{};
};

/// "x" of "ASV_1:x".
std::string after_colon(const std::string& label) {
  const auto colon = label.find(':');
  return colon == std::string::npos ? label : label.substr(colon + 1);
}

ParametersFile read_parameters(const std::string& path) {
  Sections sections(path);
  ParametersFile file{.path = path};
  file.variables = sections.take("variables", "DAKOTA_VARS");
  file.requests = sections.take("functions", "DAKOTA_FNS");
  file.by = sections.take("derivative_variables", "DAKOTA_DER_VARS");
  file.id = sections.rest("eval_id", "DAKOTA_EVAL_ID");
  for (auto& request : file.requests) {
    if (!request.label.starts_with("ASV_"))
      refuse_at(path, request, "expected an entry of the active set vector, `ASV_1:label`");
    const std::size_t asked = count_in(path, request);
    if (asked > 7) refuse_at(path, request, "expected a sum of 1, 2 and 4");
    if ((asked & 4U) != 0)
      refuse_at(path, request,
                "asks for a Hessian; expected values and gradients (specify no_hessians or "
                "numerical_hessians in Dakota's input)");
  }
  if (file.variables.empty()) base::refuse(path, "has no variables");
  if (file.requests.empty()) base::refuse(path, "has no functions");
  return file;
}

/// What a variable of the parameters file is.
struct Variable {
  std::string name{}, path{};
  double factor{1.0};  ///< SI per unit
};

/// "k=legs.guide_sleeve.stiffness [kN/mm]"
Variable variable_of(const Machine& machine, const std::string& text) {
  const std::string place = "--variable \"" + text + "\"";
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    base::refuse(place, "expected NAME=PATH, or \"NAME=PATH [unit]\"");
  Variable variable{.name = std::string(base::trimmed(text.substr(0, equals)))};
  std::string right(base::trimmed(text.substr(equals + 1)));
  std::string unit;
  if (const auto open = right.find('[');
      open != std::string::npos && right.ends_with(']') && right.find(' ') < open) {
    unit = right.substr(open + 1, right.size() - open - 2);
    right = base::trimmed(right.substr(0, open));
  }
  variable.path = right;
  const auto number = number_at(machine, right, place);
  if (unit.empty()) return variable;
  const auto one = base::read_quantity("1 " + unit, number.unit);
  if (!one.ok()) base::refuse(place, one.problem);
  variable.factor = one.value;
  return variable;
}

/// Changes, their values in SI, and the factors from the file's units.
struct Given {
  std::vector<study::Input> changes{};
  std::vector<double> values{}, factors{};
};

Given given_by(const Machine& machine, const ParametersFile& file,
               const std::vector<std::string>& variables) {
  std::vector<Variable> known;
  for (const auto& text : variables) known.push_back(variable_of(machine, text));
  Given given;
  for (const auto& entry : file.variables) {
    const auto at = std::ranges::find(known, entry.label, &Variable::name);
    const auto variable =
        at == known.end() ? Variable{.name = entry.label, .path = entry.label} : *at;
    const auto value = number_in(entry.value);
    if (!value)
      refuse_at(file.path, entry,
                fmt::format("'{}' is not a number", base::printable(entry.value)));
    if (!find_number(machine.file, variable.path)) {
      const std::string near = nearest_parameter(machine.file, variable.path);
      refuse_at(
          file.path, entry,
          fmt::format("is no number of the machine file{}; name it with --variable "
                      "{}=PATH",
                      near.empty() ? "" : fmt::format(", did you mean `{}`?", near), entry.label));
    }
    const auto number = *find_number(machine.file, variable.path);
    if (std::ranges::count(given.changes, number.id, &study::Input::id) > 0)
      refuse_at(file.path, entry, fmt::format("sets `{}` twice", variable.path));
    const double si = *value * variable.factor;
    const double range = std::abs(si) > 0.0 ? std::abs(si) : 1.0;
    given.changes.push_back(
        {.name = variable.path,
         .unit = number.unit,
         .distribution = {.shape = study::Shape::uniform, .a = si - range, .b = si + range},
         .id = number.id});
    given.values.push_back(si);
    given.factors.push_back(variable.factor);
  }
  for (const auto& one : known)
    if (std::ranges::count(file.variables, one.name, &Entry::label) == 0)
      base::refuse("--variable " + one.name, "is no variable of " + file.path);
  return given;
}

std::vector<int> columns_asked(const ParametersFile& file, const model::Machine& machine,
                               dynamics::ModelKind kind, const std::vector<study::Column>& outputs,
                               const std::vector<std::string>& names) {
  if (!names.empty() && names.size() != file.requests.size())
    base::refuse("--function", fmt::format("{} outputs for the {} functions of {}", names.size(),
                                           file.requests.size(), file.path));
  std::vector<int> columns;
  for (std::size_t k = 0; k < file.requests.size(); ++k) {
    const auto name = names.empty() ? after_colon(file.requests[k].label) : names[k];
    const auto at = std::ranges::find(outputs, name, &study::Column::name);
    if (at == outputs.end()) {
      std::vector<std::string_view> known;
      for (const auto& output : outputs) known.push_back(output.name);
      if (const auto text = no_output_text(machine, kind, outputs, name))
        refuse_at(file.path, file.requests[k], *text);
      refuse_at(file.path, file.requests[k],
                fmt::format("'{}' is no output; name them with --function NAME, one for each "
                            "function; outputs are {}",
                            name, fmt::join(known, ", ")));
    }
    columns.push_back(static_cast<int>(at - outputs.begin()));
  }
  return columns;
}

/// Numbers of the changes by which gradients are asked for.
std::vector<std::size_t> derivative_variables(const ParametersFile& file) {
  std::vector<std::size_t> by;
  for (const auto& entry : file.by) {
    const std::size_t number = count_in(file.path, entry);
    if (number < 1 || number > file.variables.size())
      refuse_at(file.path, entry,
                fmt::format("expected the number of a variable, 1 … {}", file.variables.size()));
    by.push_back(number - 1);
  }
  return by;
}

std::string status_words(double status) {
  constexpr std::array words{"computed", "a number that the machine cannot have",
                             "the pose is out of reach", "the machine has no equilibrium",
                             "the legs buckle"};
  const auto at = static_cast<std::size_t>(status);
  return at < words.size() ? words[at] : "not computed";
}

bool asks(const ParametersFile& file, std::size_t bit) {
  return std::ranges::any_of(file.requests, [&](const Entry& request) {
    return (count_in(file.path, request) & bit) != 0;
  });
}

}  // namespace

Evaluation evaluate(const Machine& machine, const EvaluateOptions& options) {
  const auto file = read_parameters(options.parameters);
  auto given = given_by(machine, file, options.variables);
  study::DesignProblem problem{.machine = machine.file.machine,
                               .kind = machine.kind,
                               .poses = {machine.pose},
                               .changes = given.changes};
  if (const auto errors = of_other_poses(machine, given.changes, problem.poses); !errors.empty())
    throw base::InputError(errors);
  Evaluation result{.id = file.id};
  const auto fail = [&](const std::string& why) {
    result.text = "FAIL\n";
    result.failure = why;
    return result;
  };
  problem.outputs = study::design_outputs(problem);
  const auto columns =
      columns_asked(file, problem.machine, problem.kind, problem.outputs, options.outputs);
  for (const int column : columns)
    if (const auto& output = problem.outputs[static_cast<std::size_t>(column)]; output.unit == "Hz")
      result.frequencies.push_back(output.name);
  const auto by = derivative_variables(file);
  study::DesignModel model(problem, machine.pose, columns);
  std::vector<double> outputs(problem.outputs.size());
  model.outputs(given.values, outputs);
  if (outputs.front() != 0.0) return fail(status_words(outputs.front()));
  for (const int column : columns)
    if (!std::isfinite(outputs[static_cast<std::size_t>(column)]))
      return fail(problem.outputs[static_cast<std::size_t>(column)].name + " has no value");
  std::optional<study::DesignModel::Derivatives> derivatives;
  if (asks(file, 2)) derivatives = model.derivatives(given.values, outputs);
  for (std::size_t k = 0; k < columns.size(); ++k)
    if ((count_in(file.path, file.requests[k]) & 1U) != 0)
      result.text += fmt::format("{:.17e} {}\n", outputs[static_cast<std::size_t>(columns[k])],
                                 after_colon(file.requests[k].label));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if ((count_in(file.path, file.requests[k]) & 2U) == 0) continue;
    result.text += "[";
    for (const std::size_t j : by)
      result.text += fmt::format(" {:.17e}", derivatives->by_change(static_cast<Eigen::Index>(k),
                                                                    static_cast<Eigen::Index>(j)) *
                                                 given.factors[j]);
    result.text += " ]\n";
    if (!derivatives->of_mode[k])
      result.by_differences.push_back(problem.outputs[static_cast<std::size_t>(columns[k])].name);
  }
  return result;
}

}  // namespace hydrapod::tasks
