#include "hydrapod/model/section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "hydrapod/base/text.hpp"

namespace hydrapod::model {

namespace {

constexpr std::size_t most_steps = 32;

bool is_bare(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-';
}

/// Takes a key off the front of `text`: bare, or between quotes (without escapes).
std::optional<std::string> take_key(std::string_view& text) {
  if (text.starts_with('"') || text.starts_with('\'')) {
    const auto end = text.find(text[0], 1);
    if (end == std::string_view::npos) return std::nullopt;
    std::string key{text.substr(1, end - 1)};
    text.remove_prefix(end + 1);
    return key;
  }
  const auto end =
      static_cast<std::size_t>(std::find_if_not(text.begin(), text.end(), is_bare) - text.begin());
  if (end == 0) return std::nullopt;
  std::string key{text.substr(0, end)};
  text.remove_prefix(end);
  return key;
}

/// Takes "[2]" off the front of `text`.
std::optional<std::size_t> take_index(std::string_view& text) {
  std::size_t index = 0;
  const auto [end, status] = std::from_chars(text.data() + 1, text.data() + text.size(), index);
  const auto used = static_cast<std::size_t>(end - text.data());
  if (status != std::errc{} || used >= text.size() || text[used] != ']') return std::nullopt;
  text.remove_prefix(used + 1);
  return index;
}

}  // namespace

std::optional<KeyPath> parse_path(std::string_view text) {
  KeyPath path;
  bool key_expected = true;
  while (key_expected || !text.empty()) {
    if (path.size() == most_steps) return std::nullopt;
    if (key_expected) {
      auto key = take_key(text);
      if (!key) return std::nullopt;
      path.push_back({std::move(*key), std::nullopt});
      key_expected = false;
    } else if (text[0] == '.') {
      text.remove_prefix(1);
      key_expected = true;
    } else if (text[0] == '[') {
      const auto index = take_index(text);
      if (!index) return std::nullopt;
      path.push_back({"", index});
    } else {
      return std::nullopt;
    }
  }
  return path;
}

std::string written_key(std::string_view key) {
  if (!key.empty() && std::all_of(key.begin(), key.end(), is_bare)) return base::printable(key);
  return '"' + base::printable(key) + '"';
}

std::string joined_path(std::string_view parent, std::string_view key) {
  return parent.empty() ? written_key(key) : fmt::format("{}.{}", parent, written_key(key));
}

std::string to_string(const KeyPath& path) {
  std::string text;
  for (const auto& step : path) {
    text = step.index ? fmt::format("{}[{}]", text, *step.index) : joined_path(text, step.key);
  }
  return text;
}

const Node* find_node(const Node& root, const KeyPath& path) {
  const Node* node = &root;
  for (const auto& step : path) {
    if (!step.index) {
      node = node->find(step.key);
    } else if (node->kind == Node::Kind::array && *step.index < node->children.size()) {
      node = &node->children[*step.index];
    } else {
      return nullptr;
    }
    if (node == nullptr) return nullptr;
  }
  return node;
}

}  // namespace hydrapod::model
