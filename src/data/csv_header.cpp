#include "csv_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "channel_units.hpp"
#include "csv_text.hpp"
#include "hydrapod/base/printable.hpp"
#include "record_comments.hpp"

namespace hydrapod::data {

namespace {

constexpr unsigned most_header_lines = 1'000'000;  // machine files stand in them
constexpr std::size_t most_columns = 100'000;

struct TextLine {
  std::string text{};
  unsigned number{};
};

/// Lines above the numbers, sorted out.
struct Preamble {
  RecordComments comments{};
  std::vector<TextLine> texts{};  ///< others, the last few of them
};

/// How the fields of a line of numbers are apart, if it is one.
struct RowStyle {
  char separator{};
  bool decimal_comma{};
  std::size_t fields{};
};

bool all_numbers(const std::vector<std::string>& fields, bool decimal_comma) {
  bool any = false;
  for (const auto& field : fields) {
    const auto value = field_number(field, decimal_comma);
    if (!value) return false;
    any = any || !trimmed_view(field).empty();
  }
  return any;
}

std::optional<RowStyle> row_style(std::string_view line) {
  struct Candidate {
    char separator;
    bool decimal_comma;
  };
  constexpr std::array candidates{
      Candidate{';', false}, Candidate{';', true},  Candidate{'\t', false}, Candidate{'\t', true},
      Candidate{',', false}, Candidate{' ', false}, Candidate{' ', true}};
  for (const auto& candidate : candidates) {
    if (candidate.separator != ' ' && line.find(candidate.separator) == line.npos) continue;
    const auto fields = split_fields(line, candidate.separator);
    if (all_numbers(fields, candidate.decimal_comma))
      return RowStyle{candidate.separator, candidate.decimal_comma, fields.size()};
  }
  return {};
}

bool is_time_name(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array<std::string_view, 5> words{"time", "t", "zeit", "temps", "tiempo"};
  return std::find(words.begin(), words.end(), name) != words.end();
}

/// The factor of a unit of time to seconds, if it is one.
std::optional<double> seconds(const std::string& unit) {
  const ChannelUnit found = channel_unit(unit);
  if (found.unit != "s") return {};
  return found.factor;
}

/// Titles (and a row of units below them, if there is one) from the texts above the numbers.
std::vector<NameAndUnit> titles(const Preamble& preamble, const CsvHeader& header, Notes& notes) {
  std::vector<std::vector<std::string>> rows;
  for (const TextLine& line : preamble.texts) {
    auto fields = split_fields(line.text, header.separator);
    if (fields.size() == header.columns) {
      rows.push_back(std::move(fields));
    } else {
      rows.clear();
      notes.add(fmt::format("skipped \"{}\"", base::printable(line.text)), line.number, 0, "text");
    }
  }
  std::vector<NameAndUnit> found(header.columns);
  if (rows.empty()) return found;
  const auto& names = rows.size() > 1 ? rows[rows.size() - 2] : rows.back();
  for (std::size_t c = 0; c < header.columns; ++c) {
    found[c] = name_and_unit(names[c]);
    if (rows.size() < 2) continue;
    std::string unit = rows.back()[c];
    if (unit.size() > 1 && (unit.front() == '[' || unit.front() == '('))
      unit = unit.substr(1, unit.size() - 2);
    found[c].unit = unit;
  }
  return found;
}

void find_time_column(CsvHeader& header, const std::vector<NameAndUnit>& found) {
  if (header.columns < 2 && !header.by_hydrapod) return;
  for (std::size_t c = 0; c < header.columns; ++c) {
    const auto factor = found[c].unit.empty() ? std::optional(1.0) : seconds(found[c].unit);
    if (!factor || (!is_time_name(found[c].name) && (c > 0 || found[c].unit.empty()))) continue;
    header.time_column = c;
    header.time_factor = *factor;
    return;
  }
}

/// Takes lines up to the first one of numbers.
Preamble read_preamble(LineReader& lines, CsvHeader& header, Notes& notes) {
  Preamble preamble;
  constexpr std::size_t kept = 8;  // lines of text that may be titles
  for (std::string_view line; lines.number() < most_header_lines && lines.next(line);) {
    if (lines.number() == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
    const std::string_view text = trimmed_view(line);
    if (text.empty()) continue;
    if (RecordComments::is_comment(text)) {
      preamble.comments.take(line, lines.number());
    } else if (const auto style = row_style(line)) {
      header.separator = style->separator;
      header.decimal_comma = style->decimal_comma;
      header.columns = style->fields;
      header.first_row = line;
      header.first_row_number = lines.number();
      header.first_row_ended = lines.line_was_ended();
      break;
    } else {
      if (preamble.texts.size() == kept) preamble.texts.erase(preamble.texts.begin());
      preamble.texts.push_back({std::string(line.substr(0, 1U << 16U)), lines.number()});
    }
  }
  if (header.columns > most_columns)
    notes.fail(
        fmt::format("{} columns are more than the {} that are read", header.columns, most_columns),
        header.first_row_number);
  return preamble;
}

void require_columns_of_channels(const CsvHeader& header, const Notes& notes) {
  const std::size_t described = header.record.channels.size();
  if (header.first_row_number == 0 || described == 0 || described + 1 == header.columns) return;
  notes.fail(fmt::format("{} channels are described, but the lines of numbers have a time and {}",
                         described, header.columns - 1),
             header.first_row_number);
}

}  // namespace

CsvHeader read_csv_header(LineReader& lines, Notes& notes) {
  CsvHeader header;
  const Preamble preamble = read_preamble(lines, header, notes);
  header.by_hydrapod = preamble.comments.by_hydrapod();
  if (header.by_hydrapod) {
    header.record = preamble.comments.header(notes);
    require_columns_of_channels(header, notes);
    header.time_column = 0;
    if (header.columns == 0) header.columns = header.record.channels.size() + 1;
    if (!header.record.channels.empty()) return header;
  }
  if (header.first_row_number == 0)
    notes.fail(
        "no line of numbers was found; expected is a table of samples, one line each, the "
        "fields apart by comma, semicolon, tabulator or blanks");
  const auto found = titles(preamble, header, notes);
  if (!header.time_column) find_time_column(header, found);
  for (std::size_t c = 0; c < header.columns; ++c)
    if (c != header.time_column)
      header.record.channels.push_back({.name = found[c].name, .unit = found[c].unit});
  return header;
}

}  // namespace hydrapod::data
