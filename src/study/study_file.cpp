#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/model/section.hpp"
#include "hydrapod/study/study.hpp"

namespace hydrapod::study {

namespace {

using model::Node;

constexpr std::size_t largest_file = std::size_t{1} << 20U;

struct Reader {
  std::string file;
  model::Faults faults{std::vector<std::string>{file}};

  void fault(const Node& node, const std::string& key, const std::string& message) {
    faults.add(node.place, key, message);
  }
  [[nodiscard]] std::string place(const Node& node) const {
    return fmt::format("{}:{}:{}", file, node.place.line, node.place.column);
  }
  void check_keys(const Node& root) {
    constexpr std::array<std::string_view, 15> known{
        "machine", "set",     "pose",     "vary", "correlate", "want",    "samples", "seed",
        "design",  "indices", "buckling", "only", "also",      "command", "until"};
    for (const auto& child : root.children) {
      if (std::ranges::count(known, std::string_view(child.key)) > 0) continue;
      const auto near = base::nearest(child.key, known);
      faults.add(child.key_place, child.key,
                 near ? fmt::format("unknown key; did you mean `{}`?", *near)
                      : fmt::format("unknown key; known are {}", fmt::join(known, ", ")));
    }
  }
  std::optional<std::string> text(const Node& root, std::string_view key) {
    const Node* node = root.find(key);
    if (node == nullptr) return {};
    if (node->kind == Node::Kind::text) return node->text;
    fault(*node, std::string(key), fmt::format("is {}; expected a string", described(*node)));
    return {};
  }
  bool flag(const Node& root, std::string_view key) {
    const Node* node = root.find(key);
    if (node == nullptr) return false;
    if (node->kind == Node::Kind::boolean) return node->number != 0.0;
    fault(*node, std::string(key), fmt::format("is {}; expected true or false", described(*node)));
    return false;
  }
  std::optional<double> seconds(const Node& root, std::string_view key) {
    const Node* node = root.find(key);
    if (node == nullptr) return {};
    if (node->is_number() && node->number > 0.0) return node->number;
    fault(*node, std::string(key),
          fmt::format("is {}; expected a number of seconds above 0", described(*node)));
    return {};
  }
  std::optional<std::uint64_t> whole(const Node& root, std::string_view key, double least) {
    const Node* node = root.find(key);
    if (node == nullptr) return {};
    constexpr double most = 9007199254740992.0;  // 2⁵³: every whole number up to it is a double
    if (node->is_number() && node->number >= least && node->number <= most &&
        node->number == std::floor(node->number))
      return static_cast<std::uint64_t>(node->number);
    fault(*node, std::string(key),
          fmt::format("is {}; expected a whole number from {} to 2^53", described(*node), least));
    return {};
  }
  /// A list of strings.
  std::vector<StudyFile::Given> list(const Node& root, std::string_view key) {
    const Node* node = root.find(key);
    std::vector<StudyFile::Given> found;
    if (node == nullptr) return found;
    if (node->kind != Node::Kind::array)
      fault(*node, std::string(key),
            fmt::format("is {}; expected a list of strings", described(*node)));
    for (const auto& child : node->children) {
      if (child.kind == Node::Kind::text)
        found.push_back({"", child.text, place(child)});
      else
        fault(child, std::string(key), fmt::format("has {}; expected strings", described(child)));
    }
    return found;
  }
  /// The table `vary`: "path" = "distribution".
  std::vector<StudyFile::Given> table(const Node& root) {
    const Node* node = root.find("vary");
    std::vector<StudyFile::Given> found;
    if (node == nullptr) return found;
    constexpr const char* expected =
        "expected a distribution, \"legs.guide_sleeve.stiffness\" = \"normal ± 10 %\"";
    if (!node->is_table())
      fault(*node, "vary", fmt::format("is {}; {}", described(*node), expected));
    else
      collect(*node, "", found, expected);
    return found;
  }
  void collect(const Node& table, const std::string& above, std::vector<StudyFile::Given>& found,
               const char* expected) {
    for (const auto& child : table.children) {
      const std::string key = above.empty() ? child.key : above + "." + child.key;
      if (child.kind == Node::Kind::text)
        found.push_back({key, child.text, place(child)});
      else if (child.is_table())
        collect(child, key, found, expected);
      else
        fault(child, "vary." + key, fmt::format("is {}; {}", described(child), expected));
    }
  }
};

}  // namespace

StudyFile read_study_file(const std::string& path) {
  StudyFile study{.text = base::read_file(path, largest_file, "a study file")};
  auto parsed = model::parse_tree(study.text, 0);
  if (const auto* error = std::get_if<model::SyntaxError>(&parsed))
    throw base::InputError({{base::Severity::error, path, error->place.line, error->place.column,
                             "", error->message}});
  const auto& root = std::get<Node>(parsed);
  Reader reader{path};
  reader.check_keys(root);
  study.machine = reader.text(root, "machine");
  study.pose = reader.text(root, "pose");
  for (const auto& given : reader.list(root, "set")) study.set.push_back(given.text);
  study.vary = reader.table(root);
  study.want = reader.list(root, "want");
  study.correlate = reader.list(root, "correlate");
  for (const auto& given : reader.list(root, "only")) study.only.push_back(given.text);
  for (const auto& given : reader.list(root, "also")) study.also.push_back(given.text);
  for (const auto& given : reader.list(root, "command")) study.command.push_back(given.text);
  study.until = reader.seconds(root, "until");
  study.samples = reader.whole(root, "samples", 2);
  study.seed = reader.whole(root, "seed", 0);
  study.indices = reader.flag(root, "indices");
  study.buckling = reader.flag(root, "buckling");
  if (const auto word = reader.text(root, "design")) {
    constexpr std::array<std::string_view, 3> words{"random", "latin", "sobol"};
    const auto at = std::ranges::find(words, std::string_view(*word));
    if (at == words.end())
      reader.fault(*root.find("design"), "design",
                   fmt::format("is \"{}\"; accepted are {}", *word, fmt::join(words, ", ")));
    else
      study.design = static_cast<Design>(at - words.begin());
  }
  if (reader.faults.any_error())
    throw base::InputError(reader.faults.diagnostics(base::Severity::error));
  return study;
}

}  // namespace hydrapod::study
