/// Descriptions of layouts, in TOML.

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/model/section.hpp"
#include "names.hpp"

namespace hydrapod::realtime {

namespace {

using model::Node;
using Role = Field::Role;

constexpr std::size_t largest_file = std::size_t{1} << 18;
constexpr double exact_whole = 9007199254740992.0;  // 2^53: whole numbers are exact up to here

class Reader {
 public:
  Reader(Kind kind, model::Faults& faults) : kind_(kind), faults_(faults) {}

  PacketLayout read(const Node& array, const std::string& key) {
    for (std::size_t i = 0; i < array.children.size(); ++i) {
      path_ = fmt::format("{}[{}]", key, i);
      if (array.children[i].is_table())
        read_entry(array.children[i]);
      else
        fault(array.children[i],
              "expected a table such as { name = \"sequence\", type = \"u64\" }");
    }
    path_ = key;
    const std::size_t limit = largest_packet;
    if (layout_.size > limit)
      fault(array, fmt::format("is {} bytes, expected at most {}", layout_.size, limit));
    return layout_;
  }

 private:
  void fault(const Node& at, const std::string& message, const std::string& key = {}) {
    faults_.add(at.place, key.empty() ? path_ : path_ + '.' + key, message);
  }

  /// A text; reported and empty where it is none.
  std::string text(const Node& table, const char* key, const char* example) {
    const Node* node = table.find(key);
    if (node != nullptr && node->kind == Node::Kind::text) return node->text;
    fault(node != nullptr ? *node : table,
          fmt::format("{}, expected a text such as \"{}\"",
                      node != nullptr ? "is " + model::described(*node) : "is missing", example),
          key);
    return {};
  }

  double number(const Node& table, const char* key, double fallback, double least, double most,
                bool whole) {
    const Node* node = table.find(key);
    if (node == nullptr) return fallback;
    const double value = node->is_number() ? node->number : std::nan("");
    if (value >= least && value <= most && (!whole || value == std::floor(value))) return value;
    fault(*node,
          fmt::format("is {}, expected a {}number from {} to {}", model::described(*node),
                      whole ? "whole " : "", least, most),
          key);
    return fallback;
  }

  std::optional<ValueType> type(const Node& table) {
    const std::string word = text(table, "type", "f64");
    if (word.empty()) return std::nullopt;
    std::vector<std::string_view> known;
    for (const ValueType one : all_types) {
      if (type_name(one) == word) return one;
      known.push_back(type_name(one));
    }
    fault(
        *table.find("type"),
        fmt::format("is \"{}\", expected one of {}", base::printable(word), fmt::join(known, ", ")),
        "type");
    return std::nullopt;
  }

  void check_keys(const Node& table, const std::set<std::string_view>& known) {
    for (const Node& child : table.children)
      if (!known.contains(child.key))
        faults_.add(child.key_place, path_ + '.' + base::printable(child.key),
                    fmt::format("unknown key, expected {}", fmt::join(known, ", ")));
  }

  void read_entry(const Node& table) {
    const std::string word = text(table, "name", "displacement");
    const auto of_type = type(table);
    if (word.empty() || !of_type) return;
    if (word == "constant") return read_constant(table, *of_type);
    if (word == "ignored") {
      check_keys(table, {"name", "type"});
      return add({.role = Role::ignored, .type = *of_type});
    }
    if (word == "crc32" || word == "crc16") return read_checksum(table, word == "crc32", *of_type);
    read_value(table, word, *of_type);
  }

  void read_constant(const Node& table, ValueType of_type) {
    check_keys(table, {"name", "type", "value"});
    if (of_type > ValueType::u64)
      return fault(table, "of a constant must be u8, u16, u32 or u64", "type");
    const double most =
        std::min(std::ldexp(1.0, static_cast<int>(8 * size_of(of_type))) - 1.0, exact_whole);
    if (table.find("value") == nullptr) return fault(table, "is missing: a whole number", "value");
    const double value = number(table, "value", 0.0, 0.0, most, true);
    add({.role = Role::constant, .type = of_type, .number = static_cast<std::uint64_t>(value)});
  }

  void read_checksum(const Node& table, bool is_32, ValueType of_type) {
    check_keys(table, {"name", "type", "from", "extra"});
    const ValueType needed = is_32 ? ValueType::u32 : ValueType::u16;
    if (of_type != needed)
      return fault(table, fmt::format("must be {}", type_name(needed)), "type");
    Field field{.role = is_32 ? Role::crc32 : Role::crc16, .type = of_type};
    field.from = static_cast<std::size_t>(
        number(table, "from", 0.0, 0.0, static_cast<double>(layout_.size), true));
    const double extra = number(table, "extra", -1.0, 0.0, 255.0, true);
    if (extra >= 0.0 && is_32) return fault(table, "belongs to crc16 only", "extra");
    field.number = static_cast<std::uint64_t>(extra + 1.0);
    add(field);
  }

  /// "displacement": all six; "displacement.x": one.
  void read_value(const Node& table, const std::string& word, ValueType of_type) {
    check_keys(table, {"name", "type", "unit", "factor", "offset"});
    const auto dot = word.find('.');
    const auto name = find_name(kind_, std::string_view(word).substr(0, dot));
    if (!name) return unknown(table, word);
    int first = 0, last = name->count - 1;
    if (dot != std::string::npos) {
      first = last = 0;
      while (first < name->count && name->component(first) != word) ++first;
      last = first;
      if (first == name->count || name->count == 1) return unknown(table, word);
    }
    for (int i = first; i <= last; ++i) add_value(table, *name, i, of_type, first != last);
  }

  void unknown(const Node& table, const std::string& word) {
    auto names = names_of(kind_);
    for (const char* more : {"constant", "ignored", "crc32", "crc16"}) names.emplace_back(more);
    const auto near = base::nearest(std::string_view(word).substr(0, word.find('.')), names);
    const std::string advice =
        near ? fmt::format("did you mean \"{}\"?", *near)
             : fmt::format(
                   "expected one of {}, or one component such as "
                   "\"{}\"",
                   fmt::join(names, ", "), kind_ == Kind::command ? "displacement.x" : "length.1");
    fault(*table.find("name"), fmt::format("is \"{}\"; {}", base::printable(word), advice), "name");
  }

  void add_value(const Node& table, const Name& name, int component, ValueType of_type, bool all) {
    Field field{.entry = name.entry, .component = component, .type = of_type};
    if (!used_.insert({name.entry, component}).second)
      return fault(*table.find("name"), "\"" + name.component(component) + "\" stands twice",
                   "name");
    if (name.whole) {
      for (const char* key : {"unit", "factor", "offset"})
        if (const Node* node = table.find(key))
          return fault(*node, fmt::format("\"{}\" is a whole number without it", name.name), key);
      return add(field);
    }
    field.factor = number(table, "factor", 1.0, -1e30, 1e30, false);
    field.offset = number(table, "offset", 0.0, -1e30, 1e30, false);
    if (field.factor == 0.0) return fault(*table.find("factor"), "is 0", "factor");
    if (table.find("unit") != nullptr) {
      const double unit = unit_factor(table, name, component, all);
      field.factor *= unit;
      field.offset *= unit;
    }
    if (!(std::abs(field.factor) >= 1e-30 && std::abs(field.factor) <= 1e30 &&
          std::abs(field.offset) <= 1e30))
      return fault(table, "with its unit the factor or offset is beyond 1e-30 … 1e30 of SI");
    add(field);
  }

  double unit_factor(const Node& table, const Name& name, int component, bool all) {
    const Node& node = *table.find("unit");
    const std::string word = text(table, "unit", "mm");
    if (word.empty()) return 1.0;
    const auto needed = name.unit_of(component);
    const auto read = base::read_quantity("1 " + word, needed);
    if (read.ok()) return read.value;
    if (all && name.directions)
      fault(
          node,
          fmt::format("is \"{}\", and \"{}\" has components in {} and in {}: name the components "
                      "one by one (\"{}\")",
                      base::printable(word), name.name, name.unit, name.angular, name.component(0)),
          "unit");
    else
      fault(node, read.problem, "unit");
    return 1.0;
  }

  void add(Field field) {
    field.at = layout_.size;
    layout_.size += size_of(field.type);
    layout_.fields.push_back(field);
  }

  Kind kind_;
  model::Faults& faults_;
  std::string path_{};
  PacketLayout layout_{};
  std::set<std::pair<int, int>> used_{};
};

PacketLayout read_packet(Kind kind, const Node& root, const char* key, model::Faults& faults) {
  const Node* array = root.find(key);
  if (array == nullptr || array->kind != Node::Kind::array || array->children.empty()) {
    faults.add(array != nullptr ? array->place : root.place, key,
               "expected an array of tables, one for each field: [{ name = \"sequence\", type = "
               "\"u64\" }, …]");
    return {};
  }
  return Reader(kind, faults).read(*array, key);
}

}  // namespace

Layout parse_layout(const std::string& text, const std::string& file) {
  auto parsed = model::parse_tree(text, 0);
  if (const auto* error = std::get_if<model::SyntaxError>(&parsed))
    throw base::InputError({{base::Severity::error, file, error->place.line, error->place.column,
                             "", error->message}});
  const Node& root = std::get<Node>(parsed);
  model::Faults faults({file});
  Layout layout;
  for (const Node& child : root.children)
    if (child.key != "byte_order" && child.key != "command" && child.key != "sensors")
      faults.add(child.key_place, base::printable(child.key),
                 "unknown key, expected byte_order, command, sensors");
  if (const Node* order = root.find("byte_order")) {
    layout.big_endian = order->text == "big";
    if (order->kind != Node::Kind::text || (order->text != "big" && order->text != "little"))
      faults.add(order->place, "byte_order",
                 "is " + model::described(*order) + ", expected \"little\" or \"big\"");
  }
  layout.command = read_packet(Kind::command, root, "command", faults);
  layout.sensors = read_packet(Kind::sensors, root, "sensors", faults);
  if (!faults.any_error() && !layout.command.has(Kind::command, "displacement") &&
      !layout.command.has(Kind::command, "drive"))
    faults.add(root.place, "command", "has neither displacement nor drive: it moves nothing");
  if (faults.any_error()) throw base::InputError(faults.diagnostics(base::Severity::error));
  return layout;
}

Layout read_layout(const std::string& path) {
  return parse_layout(base::read_file(path, largest_file, "the description of a layout"), path);
}

}  // namespace hydrapod::realtime
