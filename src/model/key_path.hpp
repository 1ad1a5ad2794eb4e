#pragma once
/// Dotted paths such as `legs.rod.length`, `platform.mass_center[2]`, `poses."far left".position`.
/// Private to the reader.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "value_tree.hpp"

namespace hydrapod::model {

/// A key of a table, or an element of an array.
struct PathStep {
  std::string key{};
  std::optional<std::size_t> index{};
};
using KeyPath = std::vector<PathStep>;

/// Reads a path; none when it is not one, or has more than 32 steps.
std::optional<KeyPath> parse_path(std::string_view text);

std::string to_string(const KeyPath& path);

/// `key` as it must be written in a path: bare, or in quotes.
std::string written_key(std::string_view key);

/// `parent.key`, or the key alone at the top level.
std::string joined_path(std::string_view parent, std::string_view key);

/// The node at `path` below `root`, or null.
const Node* find_node(const Node& root, const KeyPath& path);

}  // namespace hydrapod::model
