#include "response_titles.hpp"

#include <algorithm>
#include <array>

#include "channel_units.hpp"
#include "hydrapod/base/text.hpp"
#include "response_comments.hpp"

namespace hydrapod::data {

namespace {

struct PartWord {
  std::string_view word;
  TablePart part;
};
constexpr std::array part_words{PartWord{"real", TablePart::real},
                                PartWord{"re", TablePart::real},
                                PartWord{"imaginary", TablePart::imaginary},
                                PartWord{"imag", TablePart::imaginary},
                                PartWord{"im", TablePart::imaginary},
                                PartWord{"magnitude", TablePart::magnitude},
                                PartWord{"mag", TablePart::magnitude},
                                PartWord{"abs", TablePart::magnitude},
                                PartWord{"amplitude", TablePart::magnitude},
                                PartWord{"amp", TablePart::magnitude},
                                PartWord{"modulus", TablePart::magnitude},
                                PartWord{"betrag", TablePart::magnitude},
                                PartWord{"phase", TablePart::phase},
                                PartWord{"arg", TablePart::phase},
                                PartWord{"angle", TablePart::phase},
                                PartWord{"deviation", TablePart::deviation},
                                PartWord{"coherence", TablePart::coherence},
                                PartWord{"coh", TablePart::coherence},
                                PartWord{"frequency", TablePart::frequency},
                                PartWord{"freq", TablePart::frequency},
                                PartWord{"frequenz", TablePart::frequency},
                                PartWord{"omega", TablePart::frequency},
                                PartWord{"ω", TablePart::frequency},
                                PartWord{"time", TablePart::time},
                                PartWord{"zeit", TablePart::time}};

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || static_cast<unsigned char>(c) >= 0x80;
}

/// Takes the word that names a part off `text`.
TablePart take_part(std::string& text) {
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t end = begin;
    while (end < text.size() && is_letter(text[end])) ++end;
    const std::string word = base::lower_case(text.substr(begin, end - begin));
    const auto found = std::ranges::find(part_words, word, &PartWord::word);
    if (found == part_words.end()) {
      begin = end + 1;
      continue;
    }
    std::string rest = text.substr(end);
    if (base::lower_case(rest.substr(0, 5)) == " part") rest.erase(0, 5);
    text = text.substr(0, begin) + rest;
    return found->part;
  }
  return TablePart::none;
}

/// Is one of the words of a title omega?
bool names_omega(std::string_view title) {
  const std::string lower = base::lower_case(std::string(title));
  for (std::size_t begin = 0; begin < lower.size();) {
    std::size_t end = begin;
    while (end < lower.size() && is_letter(lower[end])) ++end;
    const std::string_view word = std::string_view(lower).substr(begin, end - begin);
    if (word == "omega" || word == "ω") return true;
    begin = end + 1;
  }
  return false;
}

/// "H11 [m/N]", "H11 (m/N)"; "H11 (real)" and "Re(H11)" have no unit.
void take_unit(TableColumn& column) {
  const std::string& text = column.name;
  const bool square = text.ends_with(']');
  if (!square && !text.ends_with(')')) return;
  const std::size_t open = text.rfind(square ? '[' : '(');
  if (open == text.npos || open == 0) return;
  std::string inside = text.substr(open + 1, text.size() - open - 2);
  const std::string unit = inside;
  if (take_part(inside) != TablePart::none) return;
  if (!square && text[open - 1] != ' ' && text[open - 1] != '_') return;
  column.unit = base::trimmed(unit);
  column.name = text.substr(0, open);
}

constexpr std::array groups{std::pair{TableGroup::beside_axis, response_part::beside_axis},
                            std::pair{TableGroup::noise, response_part::noise},
                            std::pair{TableGroup::input_factor, response_part::input_factor}};

/// Takes "noise " off "noise re a1/a2"; another title is one of a response.
TableGroup take_group(std::string& title) {
  for (const auto& [group, name] : groups)
    for (const char* part : {" re ", " im "})
      if (title.starts_with(std::string(name) + part)) {
        title.erase(0, std::string_view(name).size() + 1);
        return group;
      }
  return TableGroup::response;
}

}  // namespace

std::string bare_name(std::string_view text) {
  constexpr std::string_view marks = " \t_-.:,|()[]{}<>";
  const std::size_t begin = text.find_first_not_of(marks);
  if (begin == text.npos) return {};
  return std::string(text.substr(begin, text.find_last_not_of(marks) - begin + 1));
}

TableColumn table_column(const base::TableCell& cell) {
  TableColumn column{.name = clean_text(cell.text), .column = cell.column};
  column.group = take_group(column.name);
  take_unit(column);
  column.circular = names_omega(column.name);
  column.part = take_part(column.name);
  column.name = std::string(base::trimmed(column.name));
  if (column.unit.empty() && column.name.ends_with(']')) take_unit(column);  // "d1 [m/N] re"
  column.name = bare_name(column.name);
  const std::string lower = base::lower_case(column.name);
  for (const std::string_view unit : {"degrees", "deg", "rad"})  // "phase_deg"
    if (column.part == TablePart::phase && column.unit.empty() && lower.ends_with(unit)) {
      column.unit = unit == "rad" ? "rad" : "deg";
      column.name = bare_name(column.name.substr(0, column.name.size() - unit.size()));
    }
  const std::string unit = base::lower_case(column.unit);
  const bool hertz = lower == "hz" || lower == "khz" || unit == "hz" || unit == "khz";
  const bool circular = lower == "w" && column.part == TablePart::none;
  column.circular = column.circular || circular;
  if (column.part == TablePart::none && (hertz || circular || lower == "f"))
    column.part = TablePart::frequency;
  if (column.part == TablePart::frequency && column.unit.empty())
    column.unit = lower == "hz" ? "Hz" : lower == "khz" ? "kHz" : lower == "rad_s" ? "rad/s" : "";
  return column;
}

TableColumn own_column(const base::TableCell& cell) {
  TableColumn column{.name = clean_text(cell.text), .column = cell.column};
  if (column.name == "frequency_hz") return {.part = TablePart::frequency, .unit = "Hz"};
  column.group = take_group(column.name);
  constexpr std::array parts{
      std::pair{"re ", TablePart::real}, std::pair{"im ", TablePart::imaginary},
      std::pair{"deviation ", TablePart::deviation}, std::pair{"coherence ", TablePart::coherence}};
  for (const auto& [word, part] : parts) {
    if (!column.name.starts_with(word)) continue;
    column.part = part;
    column.name.erase(0, std::string_view(word).size());
    break;
  }
  return column;
}

std::vector<PairColumns> pairs_of(const std::vector<TableColumn>& columns) {
  std::vector<bool> used(columns.size(), false);
  const auto partner = [&](std::size_t from, TablePart part) -> std::optional<std::size_t> {
    for (std::size_t c = 0; c < columns.size(); ++c)
      if (!used[c] && columns[c].part == part && columns[c].name == columns[from].name &&
          columns[c].group == columns[from].group) {
        used[c] = true;
        return c;
      }
    return {};
  };
  std::vector<PairColumns> pairs;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const bool polar = columns[c].part == TablePart::magnitude;
    if (used[c] || (!polar && columns[c].part != TablePart::real)) continue;
    const auto second = partner(c, polar ? TablePart::phase : TablePart::imaginary);
    if (!second) continue;
    used[c] = true;
    pairs.push_back(
        {columns[c].group, columns[c].name, c, *second, partner(c, TablePart::deviation), polar});
  }
  return pairs;
}

}  // namespace hydrapod::data
