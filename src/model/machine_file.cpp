#include "hydrapod/model/machine_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <map>
#include <tuple>
#include <utility>

#include "hydrapod/base/file.hpp"
#include "hydrapod/model/section.hpp"
#include "machine_reader.hpp"
#include "overrides.hpp"
#include "value_checks.hpp"

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

// ---- Where a finding of validation belongs --------------------------------------------------

struct FindingPlace {
  Place place{};
  std::string path{};  ///< of the value or table found; empty for the top level
};

KeyPath path_below(std::initializer_list<std::string> front, const KeyPath& path,
                   std::size_t first) {
  KeyPath joined;
  for (const auto& key : front) joined.push_back({key, std::nullopt});
  joined.insert(joined.end(), path.begin() + static_cast<std::ptrdiff_t>(first), path.end());
  return joined;
}

/// Number of the leg (1…6) that `path` is about, 0 if it is not about a single leg.
int leg_number(const KeyPath& path) {
  if (path.size() < 2 || path[0].key != "leg" || path[1].key.size() != 1) return 0;
  const int number = path[1].key[0] - '0';
  return number >= 1 && number <= leg_count ? number : 0;
}

/// Where the joint of a leg may stand instead of in its own table.
std::vector<KeyPath> joint_places(const std::string& key, int leg) {
  std::string owner;
  if (key == "base_joint") owner = "base";
  if (key == "platform_joint") owner = "platform";
  if (owner.empty()) return {};
  KeyPath points = path_below({owner, "joints", "points"}, {}, 0);
  points.push_back({"", static_cast<std::size_t>(leg - 1)});
  return {points, path_below({owner, "joints", "circle"}, {}, 0),
          path_below({owner, "joints"}, {}, 0)};
}

/// The paths under which the same value may stand, the likeliest first.
std::vector<KeyPath> equal_paths(const KeyPath& path) {
  std::vector<KeyPath> paths{path};
  if (const int leg = leg_number(path)) {
    if (path.size() > 2) {
      for (auto& place : joint_places(path[2].key, leg)) paths.push_back(std::move(place));
    }
    paths.push_back(path_below({"legs"}, path, 2));
  } else if (!path.empty() && path[0].key == "legs") {
    for (int number = 1; number <= leg_count; ++number) {
      paths.push_back(path_below({"leg", std::to_string(number)}, path, 1));
    }
  }
  return paths;
}

/// The pose that `key` names, even where its name would need quotes in a path ("poses.far left").
const Node* named_pose(const Node& root, std::string_view key) {
  constexpr std::string_view front = "poses.";
  const Node* poses = root.find("poses");
  if (poses == nullptr || !key.starts_with(front)) return nullptr;
  return poses->find(key.substr(front.size()));
}

/// The place to look at for a fault in `node`: a part that an override has put there before the
/// rest.
Place suspect_place(const Node& node) {
  Place suspect = node.place;
  for (const auto& child : node.children) {
    const Place place = suspect_place(child);
    if (place.source > suspect.source) suspect = place;
  }
  return suspect;
}

/// The value that `key` of a Finding names, or the nearest thing above it that is in the file.
/// `leg.3.rod.length` may stand in `legs.rod.length`, and what all legs share (`legs.rod.length`)
/// in the legs' own tables; a leg's joint may stand in `base.joints` or `platform.joints`.
FindingPlace find_place(const Node& root, const std::string& key) {
  KeyPath path = parse_path(key).value_or(KeyPath{});
  if (const auto* pose = named_pose(root, key)) path = path_below({"poses", pose->key}, {}, 0);
  for (; !path.empty(); path.pop_back()) {
    for (const auto& candidate : equal_paths(path)) {
      if (const Node* node = find_node(root, candidate))
        return {suspect_place(*node), to_string(candidate)};
    }
  }
  return {root.place, ""};
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
std::vector<Finding> findings_of(const ReadMachine& read, const Check& check, bool incomplete) {
  const auto& machine = read.machine;
  if (incomplete) return validate_values(machine, NonFinite::ignore);
  std::vector<Finding> findings = validate(machine);
  for (const auto& more : {read.findings, without_effect(read)})
    findings.insert(findings.end(), more.begin(), more.end());
  if (!check) return findings;
  auto more = check(machine);
  if (std::ranges::any_of(more, &Finding::unusual)) return more;  // it names causes
  for (auto& finding : more) {
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
  auto read = read_machine(root, faults);
  add_findings(findings_of(read, check, faults.incomplete()), root, faults);
  if (faults.any_error()) {
    throw base::InputError(faults.diagnostics(base::Severity::error));
  }
  return {std::move(read.machine), faults.diagnostics(base::Severity::warning),
          std::move(read.given), text, overrides};
}

MachineFile read_machine_file(const std::string& path, const std::vector<std::string>& overrides,
                              const Check& check) {
  return parse_machine(base::read_file(path, largest_file, expected),
                       path == "-" ? "<stdin>" : path, overrides, check);
}

}  // namespace hydrapod::model
