#include "hydrapod/model/file_edit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "key_path.hpp"
#include "value_tree.hpp"

namespace hydrapod::model {

namespace {

Node tree_of(const std::string& text) {
  auto parsed = parse_tree(text, 0);
  if (const auto* error = std::get_if<SyntaxError>(&parsed))
    throw base::ComputationError("the edited file is not valid TOML: " + error->message);
  return std::move(std::get<Node>(parsed));
}

std::size_t line_start(const std::string& text, unsigned line) {
  std::size_t at = 0;
  for (unsigned k = 1; k < line; ++k) at = text.find('\n', at) + 1;
  return at;
}

std::size_t line_end(const std::string& text, std::size_t from) {
  std::size_t end = std::min(text.find('\n', from), text.size());
  if (end > from && text[end - 1] == '\r') --end;
  return end;
}

/// Byte at which a place stands; its column counts characters.
std::size_t offset_of(const std::string& text, const Place& place) {
  std::size_t at = line_start(text, place.line);
  for (unsigned column = 1; column < place.column; ++at) {
    ++column;
    while (at + 1 < text.size() && (static_cast<unsigned char>(text[at + 1]) & 0xC0) == 0x80) ++at;
  }
  return at;
}

/// Past the string that begins at `at`; strings of several lines included.
std::size_t past_string(const std::string& text, std::size_t at) {
  const char quote = text[at];
  const std::string triple(3, quote);
  if (text.compare(at, 3, triple) == 0) return text.find(triple, at + 3) + 3;
  for (++at; at < text.size() && text[at] != quote; ++at)
    if (quote == '"' && text[at] == '\\') ++at;
  return at + 1;
}

/// Past the value that begins at `at`.
std::size_t past_value(const std::string& text, std::size_t at) {
  if (text[at] == '"' || text[at] == '\'') return past_string(text, at);
  if (text[at] != '[' && text[at] != '{')
    return std::min(text.find_first_of(",]}# \t\r\n", at), text.size());
  int depth = 0;
  while (at < text.size()) {
    const char c = text[at];
    if (c == '"' || c == '\'') {
      at = past_string(text, at);
      continue;
    }
    if (c == '#') {
      at = line_end(text, at);
      continue;
    }
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    ++at;
    if (depth == 0) break;
  }
  return at;
}

/// Where the comment of the line that begins at `start` begins; its end where there is none.
std::size_t comment_start(const std::string& text, std::size_t start) {
  const std::size_t end = line_end(text, start);
  for (std::size_t at = start; at < end;) {
    if (text[at] == '#') return at;
    at = text[at] == '"' || text[at] == '\'' ? past_string(text, at) : at + 1;
  }
  return end;
}

/// The header line of the table at `path`, or npos where it has none of its own.
std::size_t header_of(const std::string& text, const Node& table, const KeyPath& path) {
  const std::size_t start = line_start(text, table.place.line);
  const auto open = text.find_first_not_of(" \t", start);
  const std::size_t end = line_end(text, start);
  if (open >= end || text[open] != '[') return std::string::npos;
  const auto named = parse_path(text.substr(open + 1, text.find(']', open) - open - 1));
  return named && to_string(*named) == to_string(path) ? start : std::string::npos;
}

/// Adds a line below the last plain value of the table whose lines begin at `from`.
void add_line(std::string& text, std::size_t from, const Node& table, const std::string& line) {
  std::size_t after = from;
  for (const auto& child : table.children)
    if (!child.is_table() && child.place.line > 0)
      after = std::max(after, past_value(text, offset_of(text, child.place)));
  std::size_t at = line_end(text, after);
  if (after == 0 && table.children.empty()) at = 0;
  at = std::min(text.find('\n', at), text.size());
  text.insert(at, "\n" + line);
}

void add_value(std::string& text, const Node& root, const KeyPath& path, const std::string& value) {
  std::size_t known = 0;
  while (known < path.size() &&
         find_node(root, KeyPath(path.begin(), path.begin() + static_cast<long>(known) + 1)))
    ++known;
  const KeyPath above(path.begin(), path.begin() + static_cast<long>(known));
  const KeyPath below(path.begin() + static_cast<long>(known), path.end());
  const Node& table = *find_node(root, above);
  const std::string line = fmt::format("{} = {}", to_string(below), value);
  if (!table.is_table())
    throw base::ComputationError(fmt::format("`{}` cannot be added to the file: `{}` is {}",
                                             to_string(path), to_string(above), described(table)));
  if (above.empty()) {
    // before the first table, below the first values
    const auto first = std::find_if(root.children.begin(), root.children.end(),
                                    [](const Node& n) { return !n.is_table(); });
    if (first == root.children.end()) {
      text.insert(0, line + "\n");
    } else {
      text.insert(line_end(text, past_value(text, offset_of(text, first->place))), "\n" + line);
    }
    return;
  }
  const std::size_t at = offset_of(text, table.place);
  if (const auto header = header_of(text, table, above); header != std::string::npos) {
    add_line(text, header, table, line);
  } else if (text[at] == '{') {
    text.insert(at + 1, " " + line + (table.children.empty() ? " " : ","));
  } else {
    if (!text.ends_with('\n')) text += '\n';
    text += fmt::format("\n[{}]\n{}\n", to_string(above), line);
  }
}

void put(std::string& text, const FileEdit& edit) {
  const auto path = parse_path(edit.path);
  if (!path) throw base::ComputationError("not a path: " + edit.path);
  const Node root = tree_of(text);
  const Node* node = find_node(root, *path);
  if (node == nullptr) return add_value(text, root, *path, edit.value);
  const std::size_t at = offset_of(text, node->place);
  const bool is_value = !node->is_table() || text[at] == '{';
  if (!is_value)
    throw base::ComputationError(
        fmt::format("`{}` is a table of several lines and cannot be replaced", edit.path));
  text.replace(at, past_value(text, at) - at, edit.value);
}

void remark(std::string& text, unsigned line, const std::string& what, const std::string& label) {
  const std::size_t start = line_start(text, line);
  std::size_t comment = comment_start(text, start);
  std::size_t end = line_end(text, start);
  const auto earlier = text.find(label + ": ", comment);
  if (earlier < end) {  // of an earlier run
    std::size_t cut = earlier;
    while (cut > comment && std::string_view("; #\t").find(text[cut - 1]) != std::string_view::npos)
      --cut;
    text.erase(cut, end - cut);
    while (cut > start && (text[cut - 1] == ' ' || text[cut - 1] == '\t')) text.erase(--cut, 1);
    comment = comment_start(text, start);
    end = line_end(text, start);
  }
  text.insert(end, fmt::format("{}{}: {}", comment < end ? "; " : "  # ", label, what));
}

}  // namespace

std::string edited_file(const std::string& text, const std::vector<FileEdit>& edits,
                        const std::string& label) {
  std::string result = text;
  for (const auto& edit : edits) put(result, edit);
  std::map<unsigned, std::string> remarks;
  const Node root = tree_of(result);
  for (const auto& edit : edits) {
    if (edit.remark.empty()) continue;
    const Node* node = find_node(root, *parse_path(edit.path));
    auto& line = remarks[node->place.line];
    line += (line.empty() ? "" : ", ") + edit.remark;
  }
  for (const auto& [line, what] : remarks) remark(result, line, what, label);
  return result;
}

WrittenUnit written_unit(const std::string& text, const std::string& path, const std::string& si) {
  const Node root = tree_of(text);
  const auto parsed = parse_path(path);
  const Node* node = parsed ? find_node(root, *parsed) : nullptr;
  if (node == nullptr || node->kind != Node::Kind::text) return {};
  const auto begin = node->text.find_first_not_of("0123456789.+-eE \t_");
  if (begin == std::string::npos) return {};
  const std::string name = node->text.substr(begin);
  const auto size = base::read_quantity("1 " + name, si);
  return size.ok() ? WrittenUnit{name, size.value} : WrittenUnit{};
}

std::string written(double value, const WrittenUnit& unit, int digits) {
  if (unit.name.empty()) return fmt::format("{:.{}g}", value, digits);
  return fmt::format("\"{:.{}g} {}\"", value / unit.size, digits, unit.name);
}

}  // namespace hydrapod::model
