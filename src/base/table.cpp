#include "hydrapod/base/file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <limits>

#include "hydrapod/base/text.hpp"

namespace hydrapod::base {

namespace {

constexpr std::size_t longest_line = 16U << 20U;  // bytes
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

std::optional<double> parsed(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status == std::errc::result_out_of_range) {
    // beyond the range of double: what the number tends to
    const bool small = text.find("e-") != text.npos || text.find("E-") != text.npos;
    const double size = small ? 0.0 : std::numeric_limits<double>::infinity();
    return text.starts_with('-') ? -size : size;
  }
  if (status != std::errc{} || end != text.data() + text.size()) return {};
  return value;
}

}  // namespace

TableReader::TableReader(const std::string& path)
    : name_(path), file_(std::fopen(path.c_str(), "rb")), buffer_(1U << 16U) {
  if (!file_) refuse(path, fmt::format("cannot read the file: {}", std::strerror(errno)));
}

TableReader::TableReader(std::string text, std::string name)
    : name_(std::move(name)),
      buffer_(text.begin(), text.end()),
      end_(buffer_.size()),
      at_end_(true) {}

/// More bytes behind what is left; false at the end of the file.
bool TableReader::refill() {
  if (at_end_) return false;
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  if (end_ == buffer_.size()) {
    if (buffer_.size() >= longest_line)
      throw InputError(
          {{.file = name_,
            .line = line_ + 1,
            .message = fmt::format("the line is longer than {} MiB", longest_line >> 20U)}});
    buffer_.resize(2 * buffer_.size());
  }
  const std::size_t got = std::fread(buffer_.data() + end_, 1, buffer_.size() - end_, file_.get());
  end_ += got;
  at_end_ = got == 0;
  return got > 0;
}

bool TableReader::next_raw_line(std::string_view& line) {
  std::size_t searched = 0;
  for (;;) {
    const std::string_view rest(buffer_.data() + begin_, end_ - begin_);
    std::size_t at = rest.find_first_of("\n\r", searched);
    // a CR at the very end may be the first half of CR LF
    const bool undecided = at != rest.npos && rest[at] == '\r' && at + 1 == rest.size() && !at_end_;
    if (at == rest.npos || undecided) {
      searched = undecided ? at : rest.size();
      if (refill()) continue;
      if (rest.empty()) return false;
      ended_ = at != rest.npos;
      if (!ended_) at = rest.size();
    } else {
      ended_ = true;
    }
    const bool pair = at + 1 < rest.size() && rest[at] == '\r' && rest[at + 1] == '\n';
    line = std::string_view(buffer_.data() + begin_, at);
    const std::size_t used = std::min(at + (pair ? 2U : 1U), rest.size());
    line_begin_ = taken_;
    taken_ += used;
    begin_ += used;
    if (++line_ == 1 && line.starts_with(byte_order_mark))
      line.remove_prefix(byte_order_mark.size());
    return true;
  }
}

bool TableReader::next_line(std::string_view& line, bool with_comments) {
  while (next_raw_line(line)) {
    const std::size_t first = line.find_first_not_of(" \t");
    if (first == line.npos || (!with_comments && is_table_comment(line.substr(first)))) continue;
    return true;
  }
  return false;
}

void TableReader::go_to(const Place& place) {
  if (file_) {
    std::fseek(file_.get(), static_cast<long>(place.offset), SEEK_SET);
    begin_ = end_ = 0;
    at_end_ = false;
  } else {
    begin_ = place.offset;
  }
  taken_ = place.offset;
  line_ = place.line;
}

std::vector<TableTitle> TableReader::titles() {
  std::string_view line;
  if (!next_line(line)) return {};
  for (const char separator : {';', '\t', ','}) {
    style = {separator, separator != ','};
    if (line.find(separator) != line.npos) break;
  }
  std::vector<TableTitle> found;
  for (const TableCell& cell : table_cells(line, style.separator))
    found.push_back(table_title(cell));
  return found;
}

bool TableReader::row(std::vector<TableCell>& cells) {
  for (std::string_view line; next_line(line);) {
    cells = table_cells(line, style.separator);
    if (std::ranges::any_of(cells, [](const TableCell& cell) { return !cell.text.empty(); }))
      return true;
  }
  return false;
}

Diagnostic TableReader::fault(unsigned column, std::string key, std::string message) const {
  return {.file = name_,
          .line = column == 0 ? 0 : line_,
          .column = column,
          .key = std::move(key),
          .message = std::move(message)};
}

bool TableCells::next(std::string_view& cell) {
  if (done_) return false;
  const char separator = separator_;
  const auto is_blank = [separator](char c) {
    return c == ' ' || (c == '\t' && separator != '\t');
  };
  std::size_t begin = at_;
  while (begin < line_.size() && is_blank(line_[begin])) ++begin;
  const bool quoted = begin < line_.size() && line_[begin] == '"';
  std::size_t from = begin, search = begin;
  if (quoted) {
    do {  // to the quote that closes it
      search = line_.find('"', search + 1);
    } while (search != line_.npos && search + 1 < line_.size() && line_[search + 1] == '"' &&
             ++search < line_.size());
    search = std::min(search, line_.size());
  }
  std::size_t end =
      separator == ' ' ? line_.find_first_of(" \t", search) : line_.find(separator, search);
  done_ = end == line_.npos;
  end = std::min(end, line_.size());
  at_ = end + 1;
  while (end > from && (is_blank(line_[end - 1]) || line_[end - 1] == '\r')) --end;
  column_ = static_cast<unsigned>(begin) + 1;
  if (quoted && end > from + 1 && line_[end - 1] == '"') {
    ++from;
    --end;
  }
  cell = line_.substr(from, end - from);
  if (separator == ' ' && !done_) done_ = line_.find_first_not_of(" \t", at_) == line_.npos;
  return true;
}

std::vector<TableCell> table_cells(std::string_view line, char separator) {
  std::vector<TableCell> cells;
  TableCells rest(line, separator);
  for (std::string_view cell; rest.next(cell);) {
    cells.push_back({std::string(cell), rest.column()});
    TableCell& made = cells.back();
    for (auto at = made.text.find("\"\""); at != made.text.npos;
         at = made.text.find("\"\"", at + 1))
      made.text.erase(at, 1);
  }
  return cells;
}

std::optional<double> table_number(std::string_view cell, bool decimal_comma) {
  if (!decimal_comma)
    if (const auto value = parsed(cell)) return value;
  constexpr std::array<std::string_view, 5> missing{"", "nan", "na", "n/a", "-nan"};
  if (cell.size() <= 4 && std::ranges::find(missing, lower_case(cell)) != missing.end())
    return std::numeric_limits<double>::quiet_NaN();
  std::array<char, 64> buffer{};
  if (!decimal_comma || cell.size() > buffer.size()) return parsed(cell);
  std::replace_copy(cell.begin(), cell.end(), buffer.begin(), ',', '.');
  return parsed({buffer.data(), cell.size()});
}

std::string with_decimal_point(std::string cell) {
  const auto digit = [&](std::size_t at) {
    return at < cell.size() && std::isdigit(static_cast<unsigned char>(cell[at])) != 0;
  };
  const auto comma = cell.find(',');
  const bool alone = comma != cell.npos && cell.find_first_of(",.", comma + 1) == cell.npos;
  if (alone && comma > 0 && digit(comma - 1) && cell.find_first_not_of("+-0123456789") == comma)
    cell[comma] = '.';
  return cell;
}

TableTitle table_title(const TableCell& cell) {
  const std::string_view text = cell.text;
  const auto name_until = [&](std::size_t at) { return std::string(trimmed(text.substr(0, at))); };
  for (const char* pair : {"[]", "()"}) {
    const std::size_t open = text.rfind(pair[0]);
    if (open == text.npos || open == 0 || text.back() != pair[1]) continue;
    return {name_until(open), std::string(trimmed(text.substr(open + 1, text.size() - open - 2))),
            cell.column, cell.column + static_cast<unsigned>(open) + 1};
  }
  if (const std::size_t slash = text.rfind(" / "); slash != text.npos && slash > 0)
    return {name_until(slash), std::string(trimmed(text.substr(slash + 3))), cell.column,
            cell.column + static_cast<unsigned>(slash) + 3};
  return {cell.text, "", cell.column, cell.column};
}

bool is_table_comment(std::string_view line) {
  return line.starts_with('#') || line.starts_with('%') || line.starts_with("//");
}

std::string quoted_cell(std::string_view text) {
  if (text.find_first_of(",;\"\n\r") == text.npos && trimmed(text) == text)
    return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace hydrapod::base
