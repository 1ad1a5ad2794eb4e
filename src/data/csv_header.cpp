#include "csv_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <map>

#include "channel_units.hpp"
#include "csv_text.hpp"
#include "formats.hpp"
#include "hydrapod/base/printable.hpp"
#include "hydrapod/base/units.hpp"

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
  std::map<std::string, std::vector<TextLine>> comments{};  ///< "# key: value" by key
  std::vector<TextLine> texts{};                            ///< others, the last few of them
};

bool is_comment(std::string_view line) {
  return line.starts_with('#') || line.starts_with('%') || line.starts_with("//");
}

void take_comment(Preamble& preamble, std::string_view line, unsigned number) {
  const std::size_t mark = line.find_first_not_of("#%/");
  if (mark == line.npos) return;
  line.remove_prefix(mark);
  if (line.starts_with(' ')) line.remove_prefix(1);
  const std::size_t colon = line.find(':');
  if (colon == line.npos) {
    preamble.comments[std::string(line)].push_back({"", number});
    return;
  }
  std::string_view value = line.substr(colon + 1);
  if (value.starts_with(' ')) value.remove_prefix(1);
  preamble.comments[std::string(line.substr(0, colon))].push_back({std::string(value), number});
}

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

/// A number of one of hydrapod's comment lines, if it is there and is one.
std::optional<double> number_of(const Preamble& preamble, const std::string& key, Notes& notes) {
  const auto at = preamble.comments.find(key);
  if (at == preamble.comments.end()) return {};
  const TextLine& line = at->second.back();
  const auto value = field_number(line.text, false);
  if (value && std::isfinite(*value)) return value;
  notes.fail(fmt::format("{}: \"{}\" is not a number", key, base::printable(line.text)),
             line.number);
}

std::string text_of(const Preamble& preamble, const std::string& key) {
  const auto at = preamble.comments.find(key);
  if (at == preamble.comments.end()) return {};
  std::string text;
  for (const TextLine& line : at->second) {
    if (&line != &at->second.front()) text += '\n';
    text += unescaped(line.text);
  }
  return clean_text(text, true);
}

/// "# channel: name,unit,direction,role,point".
Channel channel_of(const TextLine& line, Notes& notes) {
  const auto fields = split_fields(line.text, ',');
  if (fields.size() != 5)
    notes.fail("a channel is described by name,unit,direction,role,point; found " +
                   std::to_string(fields.size()) + " fields",
               line.number);
  Channel channel{.name = fields[0], .unit = fields[1]};
  const auto direction = direction_from_text(fields[2]);
  const auto role = role_from_text(fields[3]);
  if (!direction)
    notes.fail(fmt::format("direction \"{}\" is unknown; accepted are x, y, z, rx, ry, rz, these "
                           "with a -, leg 1 … leg 6 and nothing",
                           base::printable(fields[2])),
               line.number);
  if (!role)
    notes.fail(fmt::format("role \"{}\" is unknown; accepted are excitation, drive, response and "
                           "other",
                           base::printable(fields[3])),
               line.number);
  channel.direction = *direction;
  channel.role = *role;
  const auto [end, status] =
      std::from_chars(fields[4].data(), fields[4].data() + fields[4].size(), channel.point);
  if (status != std::errc{} || end != fields[4].data() + fields[4].size())
    notes.fail(fmt::format("point \"{}\" is not a whole number", base::printable(fields[4])),
               line.number);
  return channel;
}

void read_own_header(const Preamble& preamble, CsvHeader& header, Notes& notes) {
  RecordHeader& record = header.record;
  const auto rate = number_of(preamble, "sample_rate_hz", notes);
  if (rate && !(*rate > 0.0)) notes.fail("sample_rate_hz must be positive");
  record.sample_rate = rate.value_or(0.0);
  record.start = number_of(preamble, "start_s", notes).value_or(0.0);
  const double repeat = number_of(preamble, "repeat", notes).value_or(1.0);
  if (!(repeat >= 1.0) || repeat > 1e9 || repeat != std::floor(repeat))
    notes.fail("repeat must be a whole number, 1 or more");
  record.repeat = static_cast<int>(repeat);
  record.title = clean_text(text_of(preamble, "title"));
  record.date = clean_text(text_of(preamble, "date"));
  record.notes = text_of(preamble, "notes");
  record.machine = text_of(preamble, "machine");
  const auto at = preamble.comments.find("channel");
  if (at == preamble.comments.end()) return;
  for (std::size_t i = 1; i < at->second.size(); ++i)  // the first names the fields
    record.channels.push_back(channel_of(at->second[i], notes));
  if (header.first_row_number > 0 && record.channels.size() + 1 != header.columns)
    notes.fail(fmt::format("{} channels are described, but the lines of numbers have a time and {}",
                           record.channels.size(), header.columns - 1),
               header.first_row_number);
}

/// Takes lines up to the first one of numbers.
Preamble read_preamble(LineReader& lines, CsvHeader& header, Notes& notes) {
  Preamble preamble;
  constexpr std::size_t kept = 8;  // lines of text that may be titles
  for (std::string_view line; lines.number() < most_header_lines && lines.next(line);) {
    if (lines.number() == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
    const std::string_view text = trimmed_view(line);
    if (text.empty()) continue;
    if (is_comment(text)) {
      take_comment(preamble, line, lines.number());
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

}  // namespace

CsvHeader read_csv_header(LineReader& lines, Notes& notes) {
  CsvHeader header;
  const Preamble preamble = read_preamble(lines, header, notes);
  const std::string mark = fmt::format("{} {}", record_mark, record_version);
  header.by_hydrapod = preamble.comments.contains(mark);
  if (header.by_hydrapod) {
    read_own_header(preamble, header, notes);
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
