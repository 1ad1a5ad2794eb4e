#include "hydrapod/model/machine_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/model/section.hpp"
#include "overrides.hpp"

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

/// Adds `line` to the top table: before the first table, below the first values.
void add_at_the_top(std::string& text, const Node& root, const std::string& line) {
  const auto first = std::find_if(root.children.begin(), root.children.end(),
                                  [](const Node& n) { return !n.is_table(); });
  if (first == root.children.end()) {
    text.insert(0, line + "\n");
  } else {
    text.insert(line_end(text, past_value(text, offset_of(text, first->place))), "\n" + line);
  }
}

/// `text` with a table [header] and `line` in it at the end.
std::string with_table(std::string text, const KeyPath& header, const std::string& line) {
  if (!text.ends_with('\n')) text += '\n';
  return text + fmt::format("\n[{}]\n{}\n", to_string(header), line);
}

/// The steps number `from` to `to`, without `to`, of a path.
KeyPath part_of(const KeyPath& path, std::size_t from, std::size_t to) {
  return {path.begin() + static_cast<long>(from), path.begin() + static_cast<long>(to)};
}

KeyPath longer(KeyPath path, PathStep step) {
  path.push_back(std::move(step));
  return path;
}

/// Is `text` TOML that has something at `path`?
bool reads(const std::string& text, const KeyPath& path) {
  const auto parsed = parse_tree(text, 0);
  const auto* root = std::get_if<Node>(&parsed);
  return root != nullptr && find_node(*root, path) != nullptr;
}

/// Adds `path` to a table that has no header and no braces: other keys or tables name it on their
/// way. TOML lets it be continued in one of three ways, depending on what these are.
void add_to_implicit_table(std::string& text, const Node& root, const KeyPath& path,
                           std::size_t known, const std::string& value) {
  const auto line_from = [&](std::size_t from) {
    return fmt::format("{} = {}", to_string(part_of(path, from, path.size())), value);
  };
  const std::size_t header = known + 1 < path.size() ? known + 1 : known;
  std::vector<std::string> ways{with_table(text, part_of(path, 0, header), line_from(header)),
                                with_table(text, part_of(path, 0, known), line_from(known))};
  for (std::size_t above = known; above-- > 1;) {
    const auto front = part_of(path, 0, above);
    const auto at = header_of(text, *find_node(root, front), front);
    if (at == std::string::npos) continue;
    ways.push_back(text);
    add_line(ways.back(), at, *find_node(root, front), line_from(above));
  }
  ways.push_back(text);
  add_at_the_top(ways.back(), root, line_from(0));
  const auto way =
      std::find_if(ways.begin(), ways.end(), [&](const auto& t) { return reads(t, path); });
  if (way == ways.end())
    throw base::ComputationError(fmt::format("`{}` cannot be added to the file", to_string(path)));
  text = *way;
}

void add_value(std::string& text, const Node& root, const KeyPath& path, const std::string& value) {
  std::size_t known = 0;
  while (known < path.size() && find_node(root, part_of(path, 0, known + 1))) ++known;
  const KeyPath above = part_of(path, 0, known), below = part_of(path, known, path.size());
  const Node& table = *find_node(root, above);
  const std::string line = fmt::format("{} = {}", to_string(below), value);
  if (!table.is_table())
    throw base::ComputationError(fmt::format("`{}` cannot be added to the file: `{}` is {}",
                                             to_string(path), to_string(above), described(table)));
  if (above.empty() && below.size() == 1) return add_at_the_top(text, root, line);
  if (above.empty()) return add_to_implicit_table(text, root, path, 0, value);
  const std::size_t at = offset_of(text, table.place);
  if (const auto header = header_of(text, table, above); header != std::string::npos) {
    add_line(text, header, table, line);
  } else if (text[at] == '{') {
    text.insert(at + 1, " " + line + (table.children.empty() ? " " : ","));
  } else {
    add_to_implicit_table(text, root, path, known, value);
  }
}

/// Makes comments of the lines from the one with `begin` to the one with `end`.
void comment_out(std::string& text, std::size_t begin, std::size_t end) {
  begin = begin == 0 ? 0 : text.rfind('\n', begin - 1) + 1;
  for (std::size_t at = begin; at != std::string::npos && at <= end;) {
    text.insert(at, "# ");
    end += 2;
    at = text.find('\n', at);
    if (at != std::string::npos) ++at;
  }
}

/// Takes the key at `path` and its value out of the inline table they stand in, or makes their
/// lines comments.
void take_value_out(std::string& text, const Node& node, const KeyPath& path) {
  std::size_t begin = offset_of(text, node.key_place);
  std::size_t end = past_value(text, offset_of(text, node.place));
  const std::size_t start = begin == 0 ? 0 : text.rfind('\n', begin - 1) + 1;
  const auto alone = text.substr(start, begin - start).find_first_of("{[=,") == std::string::npos;
  if (alone) return comment_out(text, start, end - 1);
  if (path.back().index)
    throw base::ComputationError(
        fmt::format("`{}` cannot be taken out of its array", to_string(path)));
  begin = text.find_last_of("{,", begin - 1) + 1;
  end = text.find_first_not_of(" \t", end);
  if (text[end] == ',') {
    ++end;
  } else if (text[begin - 1] == ',') {
    --begin;
  }
  text.erase(begin, end - begin);
}

/// Makes comments of everything that stands at `path`.
void take_out(std::string& text, const KeyPath& path) {
  const Node root = tree_of(text);
  const Node* node = find_node(root, path);
  if (node == nullptr) return;
  const std::size_t at = offset_of(text, node->place);
  if (!node->is_table() || text[at] == '{') return take_value_out(text, *node, path);
  for (const auto& child : node->children) take_out(text, longer(path, {child.key, {}}));
  const Node left = tree_of(text);
  const Node* empty = find_node(left, path);
  if (empty == nullptr) return;
  const auto header = header_of(text, *empty, path);
  if (header != std::string::npos) comment_out(text, header, header);
}

/// A string as TOML.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += std::string{'\\', c};
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
      result += fmt::format("\\u{:04X}", static_cast<int>(c));
    } else {
      result += c;
    }
  }
  return result + '"';
}

/// A value as TOML.
std::string toml_of(const Node& node) {
  std::vector<std::string> parts;
  for (const auto& child : node.children)
    parts.push_back(node.is_table() ? written_key(child.key) + " = " + toml_of(child)
                                    : toml_of(child));
  switch (node.kind) {
    case Node::Kind::table:
      return parts.empty() ? "{}" : fmt::format("{{ {} }}", fmt::join(parts, ", "));
    case Node::Kind::array:
      return fmt::format("[{}]", fmt::join(parts, ", "));
    case Node::Kind::text:
      return quoted(node.text);
    case Node::Kind::integer:
    case Node::Kind::real:
      return fmt::format("{}", node.number);
    case Node::Kind::boolean:
    case Node::Kind::date:
      break;
  }
  throw base::ComputationError("a value that no machine file has cannot be written");
}

/// Are these one and the same number or string?
bool same(const Node& a, const Node& b) {
  return a.kind == b.kind && a.text == b.text && a.number == b.number && a.children.empty() &&
         b.children.empty();
}

/// Edits that make `before` into `after`, both at `path`.
void compare(const Node& before, const Node& after, const KeyPath& path,
             std::vector<FileEdit>& edits) {
  const auto below = [&](const std::string& key) { return longer(path, {key, {}}); };
  if (before.is_table() && after.is_table()) {
    for (const auto& child : before.children)
      if (after.find(child.key) == nullptr)
        edits.push_back({.path = to_string(below(child.key)), .taken_out = true});
    for (const auto& child : after.children) {
      const auto* earlier = before.find(child.key);
      if (earlier != nullptr) {
        compare(*earlier, child, below(child.key), edits);
      } else if (child.is_table()) {
        compare(Node{}, child, below(child.key), edits);
      } else {
        edits.push_back({.path = to_string(below(child.key)), .value = toml_of(child)});
      }
    }
  } else if (before.kind == Node::Kind::array && after.kind == Node::Kind::array &&
             before.children.size() == after.children.size()) {
    for (std::size_t k = 0; k < after.children.size(); ++k)
      compare(before.children[k], after.children[k], longer(path, {"", k}), edits);
  } else if (after.place.source != 0 && !same(before, after)) {
    edits.push_back({.path = to_string(path), .value = toml_of(after)});
  }
}

void put(std::string& text, const FileEdit& edit) {
  const auto path = parse_path(edit.path);
  if (!path) throw base::ComputationError("not a path: " + edit.path);
  if (edit.taken_out) return take_out(text, *path);
  const Node root = tree_of(text);
  const Node* node = find_node(root, *path);
  if (node == nullptr) {
    const auto all = spelt_out(root, *path, {}, Faults({"machine file"}));
    if (!all) return add_value(text, root, *path, edit.value);
    put(text, {.path = to_string(all->path), .value = toml_of(all->value)});
    return put(text, edit);
  }
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
    if (edit.remark.empty() || edit.taken_out) continue;
    const Node* node = find_node(root, *parse_path(edit.path));
    auto& line = remarks[node->place.line];
    line += (line.empty() ? "" : ", ") + edit.remark;
  }
  for (const auto& [line, what] : remarks) remark(result, line, what, label);
  return result;
}

std::vector<FileEdit> edits_of_overrides(const std::string& text,
                                         const std::vector<std::string>& overrides) {
  const Node before = tree_of(text);
  Node after = before;
  std::vector<std::string> sources{"machine file"};
  for (const auto& override_text : overrides) sources.push_back(source_name(override_text));
  Faults faults(sources);
  lay_over(after, overrides, faults);
  if (faults.any_error())
    throw base::ComputationError(faults.diagnostics(base::Severity::error).front().text());
  std::vector<FileEdit> edits;
  compare(before, after, {}, edits);
  return edits;
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
