// The starter file and the tables of the manual, both written from the table of parameters.
#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "hydrapod/base/text.hpp"
#include "hydrapod/model/machine_file.hpp"

namespace hydrapod::model {

namespace {

constexpr std::size_t comment_column = 40;
constexpr std::size_t line_length = 100;

constexpr std::string_view introduction =
    R"(# A hydraulic hexapod for hydrapod: six cylinders between a fixed base and a platform.
#
# Change the numbers to those of your machine, then try
#     hydrapod check FILE
#     hydrapod modes FILE
#
# Quantities are plain numbers in SI units and radians, or strings with a unit: 0.25, "250 mm",
# "12 deg", "1.4 GPa". Lines that begin with "#" are comments; keys that are commented out are
# optional and show their default, or an example where there is none.
#
# Frames. Base frame: origin at the centre of the base joint circle, z up towards the platform.
# Platform frame: origin at the centre of the platform joint circle, parallel to the base frame in
# the neutral pose.

)";

std::vector<const ParameterRow*> rows_in(std::string_view table) {
  std::vector<const ParameterRow*> keys;
  for (const auto& row : parameter_table())
    if (row.kind != Kind::table && table_of(row.path) == table) keys.push_back(&row);
  return keys;
}

/// 7e6 rather than 7e+06 or 7000000.
std::string short_number(double value) {
  std::string text = fmt::format("{}", value);
  const std::string scientific = fmt::format("{:.3g}", value);
  if (text.size() > scientific.size() && std::stod(scientific) == value) text = scientific;
  const auto e = text.find('e');
  if (e == std::string::npos) return text;
  const std::string sign = text[e + 1] == '-' ? "-" : "";
  return text.substr(0, e + 1) + sign + text.substr(text.find_first_not_of("+-0", e + 1));
}

/// The default of the structs, as TOML; empty where a key has none.
std::string default_of(const ParameterRow& row) {
  Machine machine;
  if (row.kind == Kind::word)
    return fmt::format("\"{}\"", row.words[static_cast<std::size_t>(row.word(machine, 0))]);
  if (row.required || row.optional || row.make == nullptr || row.in_code) return "";
  std::vector<double> numbers;
  for (int k = 0; k < row.numbers; ++k) numbers.push_back(*row.make(machine, 0, k));
  const bool alike = std::all_of(numbers.begin(), numbers.end(),
                                 [&](double number) { return number == numbers.front(); });
  if (row.numbers == 1 || (row.kind == Kind::six && alike)) return short_number(numbers.front());
  std::vector<std::string> texts;
  for (const double number : numbers) texts.push_back(short_number(number));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

// ---- Starter file ----------------------------------------------------------------------------

bool is_plain_number(std::string_view value) {
  return value.find_first_not_of("0123456789.+-e") == std::string_view::npos;
}

std::string value_text(const ParameterRow& row) {
  if (row.example.empty()) return default_of(row);
  const bool toml = is_plain_number(row.example) || row.example[0] == '[' || row.example[0] == '{';
  return toml ? std::string{row.example} : fmt::format("\"{}\"", row.example);
}

std::string comment_of(const ParameterRow& row, std::string_view value) {
  std::string comment;
  const bool plain = is_plain_number(value) || value[0] == '[' || value[0] == '{';
  if (plain && value.find('"') == std::string_view::npos && row.unit != "1" && !row.unit.empty())
    comment = fmt::format("{}; ", row.unit);
  comment += row.meaning;
  const bool is_shown = value.find(row.otherwise) != std::string_view::npos;
  if (!row.otherwise.empty() && !is_shown && row.kind != Kind::text)
    comment += fmt::format("; default: {}", row.otherwise);
  else if (row.in_use && !default_of(row).empty())
    comment += fmt::format("; default {}", default_of(row));
  std::erase(comment, '`');
  return comment;
}

/// `text`, then the comment beside it, on as many lines as it needs.
std::string with_comment(std::string text, std::string_view comment) {
  std::string result;
  while (!comment.empty()) {
    const std::size_t column = std::max(base::characters(text) + 1, comment_column);
    std::size_t end = comment.size();
    while (column + 2 + base::characters(comment.substr(0, end)) > line_length)
      end = comment.rfind(' ', end - 1);
    result += fmt::format("{}{}# {}\n", text, std::string(column - base::characters(text), ' '),
                          comment.substr(0, end));
    comment.remove_prefix(std::min(end + 1, comment.size()));
    text.clear();
  }
  return result.empty() ? text + '\n' : result;
}

std::string starter_key(const ParameterRow& row) {
  const std::string value = value_text(row);
  if (value.empty()) return "";
  return with_comment(fmt::format("{}{} = {}", row.in_use ? "" : "# ", last_key(row.path), value),
                      comment_of(row, value));
}

std::string starter_table(const ParameterRow& table) {
  std::string keys;
  bool in_use = false;
  for (const auto* row : rows_in(table.path)) {
    keys += starter_key(*row);
    in_use |= row->in_use;
  }
  std::string text;
  if (!table.heading.empty()) text = fmt::format("\n{}", table.heading);
  const bool other_leg = !belongs_to(LegType::cylinder, table.path);
  if (keys.empty() || other_leg) return text;
  return text + '\n' +
         with_comment(fmt::format("{}[{}]", in_use ? "" : "# ", table.path), table.meaning) + keys;
}

// ---- Tables of the manual --------------------------------------------------------------------

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

std::string unit_cell(const ParameterRow& row) {
  if (row.kind == Kind::word) return "word";
  if (row.kind == Kind::text) return "text";
  if (row.kind == Kind::rows) return "rows";
  if (row.unit == "1") return "–";
  return replaced(replaced(std::string{row.unit}, "^2", "²"), "^3", "³");
}

std::string default_cell(const ParameterRow& row) {
  if (!row.otherwise.empty()) return std::string{row.otherwise};
  const std::string value = default_of(row);
  if (value.empty()) return "–";
  return is_plain_number(value) ? value : fmt::format("`{}`", value);
}

std::string reference_table(std::string_view table) {
  std::string rows;
  for (const auto* row : rows_in(table))
    rows += fmt::format("| `{}` | {} | {} | {} |\n", last_key(row->path), unit_cell(*row),
                        default_cell(*row), row->meaning);
  if (rows.empty()) return "";
  return "| key | unit | default | meaning |\n| --- | --- | --- | --- |\n" + rows;
}

}  // namespace

std::string starter_machine_file() {
  std::string text{introduction};
  for (const auto& row : parameter_table()) {
    if (row.kind == Kind::table) text += starter_table(row);
    if (row.kind == Kind::text) text += starter_key(row);
  }
  return text;
}

std::string parameter_reference() {
  std::string text = "Top level\n\n" + reference_table("");
  for (const auto& row : parameter_table()) {
    if (row.kind != Kind::table) continue;
    const auto table = reference_table(row.path);
    if (table.empty()) continue;
    text += fmt::format("\n`[{}]`{}{}\n\n{}",
                        replaced(replaced(std::string{row.path}, "leg.*", "leg.1"), "*", "NAME"),
                        row.meaning.empty() ? "" : ": ", row.meaning, table);
  }
  return text;
}

}  // namespace hydrapod::model
