#include "record_comments.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "channel_units.hpp"
#include "formats.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"

namespace hydrapod::data {

namespace {

/// Carriage returns as \\r and backslashes as \\\\, so that they survive in a comment line.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) out += c == '\\' ? "\\\\" : c == '\r' ? "\\r" : std::string(1, c);
  return out;
}

std::string unescaped(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char next = text[i] == '\\' && i + 1 < text.size() ? text[i + 1] : ' ';
    if (next == 'r' || next == '\\') ++i;
    out += next == 'r' ? '\r' : next == '\\' ? '\\' : text[i];
  }
  return out;
}

/// One comment line per line of `text`, so that notes and machine files stay legible.
void add_lines(std::string& out, const char* key, const std::string& text) {
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    out += fmt::format("# {}: {}\n", key, escaped(text.substr(begin, end - begin)));
    begin = end + 1;
  }
}

std::string mark() { return fmt::format("{} {}", record_mark, record_version); }

}  // namespace

std::string comment_lines(const RecordHeader& header) {
  std::string out = fmt::format("# {}\n", mark());
  out += fmt::format("# sample_rate_hz: {}\n# start_s: {}\n# repeat: {}\n", header.sample_rate,
                     header.start, header.repeat);
  if (!header.title.empty()) add_lines(out, "title", header.title);
  if (!header.date.empty()) add_lines(out, "date", header.date);
  if (!header.notes.empty()) add_lines(out, "notes", header.notes);
  const auto experiment = experiment_json(header.experiment);
  if (!experiment.empty()) add_lines(out, "experiment", experiment);
  if (!header.experiment.machine.empty()) add_lines(out, "machine", header.experiment.machine);
  for (const auto& [key, text] :
       {std::pair{geometry_name, geometry_json(header.geometry)},
        std::pair{channel_texts_name, channel_texts_json(header.channels)}})
    if (!text.empty()) add_lines(out, key, text);
  out += "# channel: name,unit,direction,role,point\n";
  for (const Channel& c : header.channels)
    out += fmt::format("# channel: {},{},{},{},{}\n", base::quoted_cell(c.name),
                       base::quoted_cell(c.unit), direction_text(c.direction), role_text(c.role),
                       c.point);
  return out;
}

void RecordComments::take(std::string_view line, unsigned number) {
  const std::size_t begin = line.find_first_not_of(" \t#%/");
  if (begin == line.npos) return;
  line.remove_prefix(begin);
  const std::size_t colon = line.find(':');
  if (colon == line.npos) {
    lines_[std::string(base::trimmed(line))].push_back({"", number});
    return;
  }
  std::string_view value = line.substr(colon + 1);
  if (value.starts_with(' ')) value.remove_prefix(1);
  lines_[std::string(line.substr(0, colon))].push_back({std::string(value), number});
}

bool RecordComments::by_hydrapod(const Notes& notes) const {
  const std::string any = std::string(record_mark) + " ";
  for (const auto& [text, lines] : lines_)
    if (text.starts_with(any) && text != mark())
      notes.fail(fmt::format("the file is a {}; this program reads version {}",
                             base::printable(text), record_version),
                 lines.front().number);
  return lines_.contains(mark());
}

double RecordComments::number_of(const std::string& key, double otherwise,
                                 const Notes& notes) const {
  const auto at = lines_.find(key);
  if (at == lines_.end()) return otherwise;
  const Line& line = at->second.back();
  const auto value = base::table_number(base::trimmed(line.text), false);
  if (value && std::isfinite(*value)) return *value;
  notes.fail(fmt::format("{}: \"{}\" is not a finite number", key, base::printable(line.text)),
             line.number);
}

std::string RecordComments::text_of(const std::string& key) const {
  const auto at = lines_.find(key);
  if (at == lines_.end()) return {};
  std::string text;
  for (const Line& line : at->second) {
    if (&line != &at->second.front()) text += '\n';
    text += unescaped(line.text);
  }
  return clean_text(text, true);
}

/// "name,unit,direction,role,point".
Channel RecordComments::channel_of(const Line& line, const Notes& notes) {
  const auto fields = base::table_cells(line.text, ',');
  if (fields.size() != 5)
    notes.fail(fmt::format("a channel is described by name,unit,direction,role,point; found {} "
                           "fields",
                           fields.size()),
               line.number);
  Channel channel{.name = fields[0].text, .unit = fields[1].text};
  const auto direction = direction_from_text(fields[2].text);
  const auto role = role_from_text(fields[3].text);
  if (!direction)
    notes.fail(fmt::format("direction \"{}\" is unknown; accepted are x, y, z, rx, ry, rz, these "
                           "with a -, leg 1 … leg 6 and nothing",
                           base::printable(fields[2].text)),
               line.number);
  if (!role)
    notes.fail(fmt::format("role \"{}\" is unknown; accepted are excitation, drive, response and "
                           "other",
                           base::printable(fields[3].text)),
               line.number);
  channel.direction = *direction;
  channel.role = *role;
  const char* end_of_text = fields[4].text.data() + fields[4].text.size();
  const auto [end, status] = std::from_chars(fields[4].text.data(), end_of_text, channel.point);
  if (status != std::errc{} || end != end_of_text)
    notes.fail(fmt::format("point \"{}\" is not a whole number", base::printable(fields[4].text)),
               line.number);
  return channel;
}

RecordHeader RecordComments::header(Notes& notes) const {
  RecordHeader record;
  record.sample_rate = number_of("sample_rate_hz", 0.0, notes);
  if (lines_.contains("sample_rate_hz") && !(record.sample_rate > 0.0))
    notes.fail("sample_rate_hz must be positive");
  record.start = number_of("start_s", 0.0, notes);
  const double repeat = number_of("repeat", 1.0, notes);
  if (!(repeat >= 1.0) || repeat > 1e9 || repeat != std::floor(repeat))
    notes.fail("repeat must be a whole number, 1 or more");
  record.repeat = static_cast<int>(repeat);
  record.title = clean_text(text_of("title"));
  record.date = clean_text(text_of("date"));
  record.notes = text_of("notes");
  record.experiment.machine = text_of("machine");
  settle_experiment(text_of("experiment"), notes, record);
  const auto at = lines_.find("channel");
  const std::size_t count = at == lines_.end() ? 0 : at->second.size();
  for (std::size_t i = 1; i < count; ++i)  // the first names the fields
    record.channels.push_back(channel_of(at->second[i], notes));
  settle_geometry(text_of(geometry_name), text_of(channel_texts_name), notes, record);
  return record;
}

}  // namespace hydrapod::data
