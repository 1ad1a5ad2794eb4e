#include "hydrapod/model/machine_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "finding_place.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/model/section.hpp"
#include "machine_reader.hpp"
#include "machine_schema.hpp"
#include "overrides.hpp"
#include "validate_values.hpp"

namespace hydrapod::model {

namespace {

constexpr std::size_t largest_file = std::size_t{1} << 20;  // toml++ may need seconds beyond
constexpr const char* expected = "a machine file";

[[noreturn]] void reject(const std::string& file, std::string message, unsigned line = 0,
                         unsigned column = 0) {
  throw base::InputError({{base::Severity::error, file, line, column, "", std::move(message)}});
}

std::vector<std::string> source_names(const std::string& file,
                                      const std::vector<std::string>& overrides) {
  std::vector<std::string> names{file};
  for (const auto& text : overrides) names.push_back(source_name(text));
  return names;
}

Node parsed_file(const std::string& text, const std::string& file) {
  if (text.size() > largest_file) {
    reject(file, fmt::format("is larger than 1 MiB, expected {} of some kilobytes", expected));
  }
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) {
    reject(file, "is empty; `hydrapod init` writes a machine file to start from");
  }
  auto parsed = parse_tree(text, 0);
  if (const auto* error = std::get_if<SyntaxError>(&parsed)) {
    reject(file, error->message, error->place.line, error->place.column);
  }
  return std::move(std::get<Node>(parsed));
}

/// Adds the findings at their places. What several legs share is one mistake if it stands in one
/// place of the file: its key is then the path there.
void add_findings(const std::vector<Finding>& findings, const Node& root, Faults& faults) {
  using Cause = std::tuple<std::string, std::string, base::Severity>;
  std::map<Cause, std::size_t> legs_sharing;
  std::vector<FindingPlace> places;
  for (const auto& finding : findings) {
    places.push_back(find_place(root, finding.key));
    ++legs_sharing[{places.back().path, finding.message, finding.severity}];
  }
  for (std::size_t i = 0; i < findings.size(); ++i) {
    const auto& finding = findings[i];
    const auto& place = places[i];
    const bool shared = legs_sharing[{place.path, finding.message, finding.severity}] > 1;
    faults.add(place.place, shared && !place.path.empty() ? place.path : finding.key,
               finding.message, finding.severity);
  }
}

/// A machine with unread values can be judged only by what was read, and not by others' checks.
std::vector<Finding> findings_of(const Machine& machine, const Check& check, bool incomplete) {
  if (incomplete) return validate_values(machine, NonFinite::ignore);
  std::vector<Finding> findings = validate(machine);
  if (!check) return findings;
  for (auto& finding : check(machine)) {
    const auto same = [&](const Finding& known) {
      return std::tie(known.key, known.message) == std::tie(finding.key, finding.message);
    };
    if (std::none_of(findings.begin(), findings.end(), same)) {
      findings.push_back(std::move(finding));
    }
  }
  return findings;
}

}  // namespace

MachineFile parse_machine(const std::string& text, const std::string& file_name,
                          const std::vector<std::string>& overrides, const Check& check) {
  Node root = parsed_file(text, file_name);
  Faults faults(source_names(file_name, overrides));
  lay_over(root, overrides, faults);
  check_keys(root, faults);
  auto [machine, given] = read_machine(root, faults);
  add_findings(findings_of(machine, check, faults.incomplete()), root, faults);
  if (faults.any_error()) {
    throw base::InputError(faults.diagnostics(base::Severity::error));
  }
  return {std::move(machine), faults.diagnostics(base::Severity::warning), std::move(given), text,
          overrides};
}

MachineFile read_machine_file(const std::string& path, const std::vector<std::string>& overrides,
                              const Check& check) {
  return parse_machine(base::read_file(path, largest_file, expected),
                       path == "-" ? "<stdin>" : path, overrides, check);
}

}  // namespace hydrapod::model
