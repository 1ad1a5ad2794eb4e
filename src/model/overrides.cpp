#include "overrides.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "hydrapod/base/text.hpp"
#include "hydrapod/model/parameters.hpp"
#include "hydrapod/model/section.hpp"
#include "machine_reader.hpp"

namespace hydrapod::model {

namespace {

constexpr std::size_t longest_override = 4096;
constexpr const char* example_override = "legs.guide_sleeve.stiffness=2e6 N/m";

/// A number that TOML would spell differently (".5", "007").
std::optional<double> as_number(std::string_view text) {
  double number = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (status != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// The value as TOML, or as a plain string; a broken array or inline table is a syntax error.
std::variant<Node, SyntaxError> parse_value(std::string_view text, int source) {
  auto parsed = parse_tree(fmt::format("value = {}", text), source);
  if (auto* tree = std::get_if<Node>(&parsed); tree != nullptr && tree->children.size() == 1) {
    if (tree->children[0].key == "value") return std::move(tree->children[0]);
  }
  if (auto* error = std::get_if<SyntaxError>(&parsed)) {
    if (text.starts_with('[') || text.starts_with('{')) return std::move(*error);
  }
  Node node;
  node.place = {source, 0, 0};
  if (const auto number = as_number(text)) {
    node.kind = Node::Kind::real;
    node.number = *number;
  } else {
    node.kind = Node::Kind::text;
    node.text = text;
  }
  return node;
}

/// Puts values into the tree on behalf of one override.
class Overlay {
 public:
  Overlay(Node& root, int source, Faults& faults)
      : root_(root), place_{source, 0, 0}, faults_(faults) {}

  void apply(std::string_view text) {
    const auto equals = text.find('=');
    if (equals == std::string_view::npos) {
      return reject("", fmt::format("no \"=\", expected PATH=VALUE such as {}", example_override));
    }
    const auto path = parse_path(base::trimmed(text.substr(0, equals)));
    const std::string_view value = base::trimmed(text.substr(equals + 1));
    if (!path) {
      return reject("", fmt::format("the part before \"=\" is not a path, expected "
                                    "PATH=VALUE such as {}",
                                    example_override));
    }
    if (text.size() > longest_override) {
      return reject(to_string(*path), "longer than 4096 characters");
    }
    if (value.empty()) {
      return reject(to_string(*path), "no value after \"=\", write '\"\"' for an empty string");
    }
    auto parsed = parse_value(value, place_.source);
    if (auto* error = std::get_if<SyntaxError>(&parsed)) {
      return reject(to_string(*path), error->message);
    }
    // an element of an array that the file does not write is one of the machine all the same
    if (auto all = spelt_out(root_, *path, place_, faults_)) put(all->path, std::move(all->value));
    put(*path, std::move(std::get<Node>(parsed)));
  }

 private:
  void reject(std::string key, std::string message) {
    faults_.add(place_, std::move(key), std::move(message));
  }

  void put(const KeyPath& path, Node value) {
    const std::size_t known = known_steps(path);
    if (known < path.size() && !may_be_added(path, known)) return;
    Node* node = &root_;
    for (std::size_t i = 0; i < path.size(); ++i) {
      if (!path[i].index) remove_alternative(*node, i > 0 ? path[i - 1].key : "", path[i].key);
      node = i < known ? step(*node, path[i]) : added(*node, path[i].key);
    }
    value.key = node->key;
    value.key_place = place_;
    *node = std::move(value);
  }

  static Node* step(Node& parent, const PathStep& step) {
    if (!step.index) return parent.find(step.key);
    const bool there = parent.kind == Node::Kind::array && *step.index < parent.children.size();
    return there ? &parent.children[*step.index] : nullptr;
  }

  /// How many steps of the path lead to something that exists.
  std::size_t known_steps(const KeyPath& path) {
    Node* node = &root_;
    for (std::size_t i = 0; i < path.size(); ++i) {
      node = step(*node, path[i]);
      if (node == nullptr) return i;
    }
    return path.size();
  }

  /// Tables can be added below a table; arrays cannot be lengthened or begun element by element.
  bool may_be_added(const KeyPath& path, std::size_t known) {
    const KeyPath above(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(known));
    const Node& parent = *find_node(root_, above);
    const auto index = std::find_if(path.begin() + static_cast<std::ptrdiff_t>(known), path.end(),
                                    [](const PathStep& s) { return s.index.has_value(); });
    if (index == path.end() && parent.is_table()) return true;
    const std::string key = to_string(path);
    if (!path[known].index && !parent.is_table()) {
      reject(key, fmt::format("`{}` is {} and has no keys", to_string(above), described(parent)));
    } else if (!path[known].index) {
      const std::string array = to_string(KeyPath(path.begin(), index));
      reject(key,
             fmt::format("`{0}` is not in the file, which may give these numbers under another "
                         "path; give the whole array, \"{0}=[…]\"",
                         array));
    } else if (parent.kind == Node::Kind::array) {
      reject(key, fmt::format("`{}` is {}, counted from 0", to_string(above), described(parent)));
    } else {
      reject(key, fmt::format("`{}` is {}, not an array", to_string(above), described(parent)));
    }
    return false;
  }

  Node* added(Node& parent, const std::string& key) {
    Node node;
    node.key = key;
    node.place = place_;
    node.key_place = place_;
    return &parent.children.emplace_back(std::move(node));
  }

  static void remove_alternative(Node& table, std::string_view name, std::string_view key) {
    for (const auto& pair : alternatives()) {
      if (name != pair.table || (key != pair.first && key != pair.second)) continue;
      const std::string_view other = key == pair.first ? pair.second : pair.first;
      std::erase_if(table.children, [&](const Node& node) { return node.key == other; });
    }
  }

  Node& root_;
  Place place_;
  Faults& faults_;
};

}  // namespace

std::optional<SpeltOut> spelt_out(const Node& root, const KeyPath& path, const Place& place,
                                  Faults faults) {
  if (path.size() < 2 || find_node(root, path) != nullptr) return std::nullopt;
  const KeyPath above(path.begin(), path.end() - 1);
  const Node* written = find_node(root, above);
  const bool of_array = path.back().index.has_value();
  const bool is_array = written != nullptr && written->kind == Node::Kind::array;
  // what an array lacks it cannot have; keys of tensors are added, unless that is in rows
  if (of_array == is_array) return std::nullopt;
  const auto machine = read_machine(root, faults).machine;
  const std::string first = of_array ? to_string(above) + "[0]" : to_string(path);
  const auto id = find_parameter(machine, first);
  if (!id || (!of_array && row_of(*id).kind != Kind::tensor)) return std::nullopt;
  Node all;
  all.kind = of_array ? Node::Kind::array : Node::Kind::table;
  all.place = place;
  for (int k = 0; k < row_of(*id).numbers; ++k) {
    auto element = *id;
    element.element = static_cast<std::int16_t>(k);
    const auto number = value(machine, element);
    if (!number || !std::isfinite(*number)) return std::nullopt;
    auto& child = all.children.emplace_back();
    child.kind = Node::Kind::real;
    child.place = child.key_place = place;
    child.number = *number;
    if (!of_array) child.key = std::string(last_key(model::path(machine, element)));
  }
  return SpeltOut{above, std::move(all)};
}

void lay_over(Node& root, const std::vector<std::string>& overrides, Faults& faults) {
  for (std::size_t i = 0; i < overrides.size(); ++i) {
    Overlay(root, static_cast<int>(i) + 1, faults).apply(overrides[i]);
  }
}

std::string source_name(const std::string& override_text) {
  return "--set " + base::printable(override_text, 80);
}

}  // namespace hydrapod::model
