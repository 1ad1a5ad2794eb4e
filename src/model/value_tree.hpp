#pragma once
/// A machine file as a tree of values that know where they came from. Private to the reader.
///
/// toml++ parses; its tables are sorted by key and forget places when they are copied. Here the
/// order of the file is kept, and a value laid over the file by an override knows the override.

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace hydrapod::model {

/// Where a value stands. `source` is 0 for the file, i for the i-th override; lines and columns
/// count from 1, and an override has line 0.
struct Place {
  int source{};
  unsigned line{};
  unsigned column{};
};

struct Node {
  enum class Kind { table, array, text, integer, real, boolean, date };

  Kind kind{Kind::table};
  Place place{};                 ///< of the value
  Place key_place{};             ///< of the key, where it has one
  std::string key{};             ///< in the parent table
  std::string text{};            ///< Kind::text
  double number{};               ///< Kind::integer, Kind::real
  std::vector<Node> children{};  ///< of a table in the order of the file, or of an array

  [[nodiscard]] bool is_table() const { return kind == Kind::table; }
  [[nodiscard]] bool is_number() const { return kind == Kind::integer || kind == Kind::real; }
  [[nodiscard]] const Node* find(std::string_view name) const;
  Node* find(std::string_view name);
};

/// What a value is, with its article, for messages: "the number 3", "a table".
std::string described(const Node& node);

/// A TOML syntax error.
struct SyntaxError {
  Place place{};
  std::string message{};
};

/// The tree of a TOML text whose places are of `source`. Text that is not UTF-8, or nested so
/// deeply that no machine can be meant, is a syntax error too.
std::variant<Node, SyntaxError> parse_tree(std::string_view text, int source);

}  // namespace hydrapod::model
