#include "hydrapod/model/section.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <tuple>

#include "hydrapod/base/text.hpp"

namespace hydrapod::model {

namespace {

// toml++ limits nested arrays and inline tables, but builds one table per part of a dotted key and
// tears them down recursively: "a.a.a. …" a hundred thousand times overflows the stack. So text
// that nests without reason is refused before it is parsed.

struct NestingFault {
  std::size_t offset{};  ///< byte of the text
  std::string message{};
};

constexpr int deepest = 32;

/// Just enough of TOML's lexical rules to tell brackets and dots from the insides of strings and
/// comments. Malformed text may be judged either way: the parser has the last word on it.
class NestingScanner {
 public:
  explicit NestingScanner(std::string_view text) : text_(text) {}

  std::optional<NestingFault> scan() {
    while (at_ < text_.size()) {
      const std::size_t here = at_;
      step();
      if (brackets_ > deepest) return NestingFault{here, "brackets nested more than 32 deep"};
      if (dots_ > deepest) return NestingFault{here, "a dotted key of more than 32 parts"};
    }
    return std::nullopt;
  }

 private:
  void step() {
    const char c = text_[at_];
    if (c == '#') {
      skip_to_end_of_line();
    } else if (c == '"' || c == '\'') {
      skip_string(c);
    } else {
      ++at_;
      count(c);
    }
  }

  void count(char c) {
    if (c == '[' || c == '{') {
      ++brackets_;
    } else if (c == ']' || c == '}') {
      if (brackets_ > 0) --brackets_;
    } else if (c == '.') {
      ++dots_;
      return;
    }
    constexpr std::string_view ends_a_key = "[]{}=,\n";
    if (ends_a_key.find(c) != std::string_view::npos) dots_ = 0;
  }

  void skip_to_end_of_line() {
    const auto end = text_.find('\n', at_);
    at_ = end == std::string_view::npos ? text_.size() : end;
  }

  void skip_string(char quote) {
    const std::string triple(3, quote);
    const bool multiline = text_.substr(at_).starts_with(triple);
    const std::string_view closing = std::string_view(triple).substr(0, multiline ? 3 : 1);
    at_ += closing.size();
    while (at_ < text_.size() && !text_.substr(at_).starts_with(closing)) {
      if (!multiline && text_[at_] == '\n') return;
      at_ += quote == '"' && text_[at_] == '\\' ? 2 : 1;
    }
    at_ = at_ < text_.size() ? at_ + closing.size() : text_.size();
    // Up to two quotes before the closing three belong to the string.
    for (int i = 0; multiline && i < 2 && at_ < text_.size() && text_[at_] == quote; ++i) ++at_;
  }

  std::string_view text_;
  std::size_t at_{};
  int brackets_{};
  int dots_{};
};

/// The first place where brackets are nested, or a dotted key is composed, more than 32 deep.
std::optional<NestingFault> check_nesting(std::string_view text) {
  return NestingScanner(text).scan();
}

Place place_of(const toml::source_region& region, int source) {
  if (source != 0) return {source, 0, 0};
  return {0, region.begin.line, region.begin.column};
}

Node converted(const toml::node& value, int source);

void add_children(const toml::table& table, int source, Node& node) {
  node.kind = Node::Kind::table;
  for (const auto& [key, value] : table) {
    Node child = converted(value, source);
    child.key = key.str();
    child.key_place = place_of(key.source(), source);
    node.children.push_back(std::move(child));
  }
  std::stable_sort(node.children.begin(), node.children.end(), [](const Node& a, const Node& b) {
    return std::tie(a.key_place.line, a.key_place.column) <
           std::tie(b.key_place.line, b.key_place.column);
  });
}

void add_children(const toml::array& array, int source, Node& node) {
  node.kind = Node::Kind::array;
  for (const auto& value : array) node.children.push_back(converted(value, source));
}

/// The recursion is as deep as the nesting, which check_nesting has limited.
Node converted(const toml::node& value, int source) {
  Node node;
  node.place = place_of(value.source(), source);
  if (const auto* table = value.as_table()) {
    add_children(*table, source, node);
  } else if (const auto* array = value.as_array()) {
    add_children(*array, source, node);
  } else if (const auto* text = value.as_string()) {
    node.kind = Node::Kind::text;
    node.text = text->get();
  } else if (const auto* integer = value.as_integer()) {
    node.kind = Node::Kind::integer;
    node.number = static_cast<double>(integer->get());
  } else if (const auto* real = value.as_floating_point()) {
    node.kind = Node::Kind::real;
    node.number = real->get();
  } else {
    node.kind = value.is_boolean() ? Node::Kind::boolean : Node::Kind::date;
    if (const auto* boolean = value.as_boolean()) node.number = boolean->get() ? 1.0 : 0.0;
  }
  return node;
}

Place place_at(std::string_view text, std::size_t offset, int source) {
  if (source != 0) return {source, 0, 0};
  const std::string_view before = text.substr(0, offset);
  const auto lines = std::count(before.begin(), before.end(), '\n');
  const auto line_start = before.rfind('\n');
  const std::string_view line =
      line_start == std::string_view::npos ? before : before.substr(line_start + 1);
  const auto characters = base::characters(line);
  return {source, static_cast<unsigned>(lines) + 1, static_cast<unsigned>(characters) + 1};
}

/// The line of `text` up to the place of an error.
std::string_view line_before(std::string_view text, const toml::source_position& place) {
  for (unsigned line = 1; line < place.line; ++line) {
    const auto end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  // toml++ counts characters, and bytes are as good here: all that is looked at is ASCII.
  return text.substr(0, std::min<std::size_t>(text.find('\n'), place.column - 1));
}

/// What people most often mean by what TOML does not allow; empty where there is nothing to guess.
std::string advice(std::string_view description, std::string_view line) {
  if (description.find("unescaped control characters") != std::string_view::npos) {
    return "; is its closing quote missing?";
  }
  while (line.ends_with(' ')) line.remove_suffix(1);
  const bool after_digit = !line.empty() && line.back() >= '0' && line.back() <= '9';
  const bool saw_letter = description.ends_with('\'') && description.size() > 2 &&
                          std::isalpha(static_cast<unsigned char>(*(description.end() - 2))) != 0;
  if (after_digit && saw_letter && line.find('=') != std::string_view::npos) {
    return "; a number with a unit needs quotes, for instance \"0.5 m\"";
  }
  return "";
}

/// "Error while parsing array: encountered end-of-file" in our words.
std::string syntax_message(std::string_view description, std::string_view line) {
  constexpr std::string_view preamble = "Error while parsing ";
  const std::string more = advice(description, line);
  if (!description.starts_with(preamble)) {
    return fmt::format("not valid TOML: {}{}", description, more);
  }
  description.remove_prefix(preamble.size());
  return fmt::format("not valid TOML in {}{}", description, more);
}

}  // namespace

const Node* Node::find(std::string_view name) const {
  if (!is_table()) return nullptr;
  const auto found = std::find_if(children.begin(), children.end(),
                                  [&](const Node& child) { return child.key == name; });
  return found == children.end() ? nullptr : &*found;
}

Node* Node::find(std::string_view name) {
  return const_cast<Node*>(static_cast<const Node&>(*this).find(name));
}

std::string described(const Node& node) {
  switch (node.kind) {
    case Node::Kind::table:
      return "a table";
    case Node::Kind::array:
      return fmt::format("an array of {}", node.children.size());
    case Node::Kind::text:
      return fmt::format("the string \"{}\"", base::printable(node.text));
    case Node::Kind::integer:
    case Node::Kind::real:
      return fmt::format("the number {}", node.number);
    case Node::Kind::boolean:
      return "a boolean";
    case Node::Kind::date:
      return "a date or time";
  }
  return "";
}

std::variant<Node, SyntaxError> parse_tree(std::string_view text, int source) {
  if (base::is_utf16(text))
    return SyntaxError{place_at(text, 0, source), std::string(base::utf16_refused)};
  if (const auto at = base::first_invalid_utf8(text); at != std::string_view::npos) {
    return SyntaxError{place_at(text, at, source), "not UTF-8 text"};
  }
  if (const auto fault = check_nesting(text)) {
    return SyntaxError{place_at(text, fault->offset, source), fault->message};
  }
  try {
    const toml::table table = toml::parse(text, std::string_view{});
    Node root = converted(table, source);
    root.place = place_at(text, 0, source);
    return root;
  } catch (const toml::parse_error& error) {
    const auto line = line_before(text, error.source().begin);
    return SyntaxError{place_of(error.source(), source),
                       base::printable(syntax_message(error.description(), line), 250)};
  }
}

}  // namespace hydrapod::model
