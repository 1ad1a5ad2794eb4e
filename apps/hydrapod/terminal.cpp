#include "hydrapod/terminal.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <span>
#include <stdexcept>

#include "hydrapod/base/file.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/progress.hpp"

namespace hydrapod::cli {

namespace {
constexpr std::string_view gap = "  ";  // between two columns of a table

bool piped = false;

bool is_terminal(std::FILE* stream) {
  return !(piped && stream == stdout) && ::isatty(::fileno(stream)) == 1;
}

bool is_set(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

const char* escape_code(Style style) {
  switch (style) {
    case Style::bold:
      return "\033[1m";
    case Style::dim:
      return "\033[2m";
    case Style::red:
      return "\033[1;31m";
    case Style::yellow:
      return "\033[1;33m";
    case Style::green:
      return "\033[32m";
    case Style::cyan:
      return "\033[36m";
  }
  return "";
}

/// Length of the escape sequence that begins at `text[0]`: ESC [ parameters letter.
std::size_t escape_length(std::string_view text) {
  if (text.size() < 2 || text[0] != '\033' || text[1] != '[') return 0;
  std::size_t end = 2;
  while (end < text.size() && (text[end] < '@' || text[end] > '~')) ++end;
  return std::min(end + 1, text.size());
}

/// The code point at the start of `text`, with its length; a stray byte counts as one character.
std::pair<char32_t, std::size_t> decode(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  const std::size_t length = lead < 0x80   ? 1
                             : lead < 0xC0 ? 1
                             : lead < 0xE0 ? 2
                             : lead < 0xF0 ? 3
                                           : 4;
  if (length == 1 || length > text.size()) return {lead, 1};
  char32_t point = lead & (0x7Fu >> length);
  for (std::size_t i = 1; i < length; ++i) {
    point = (point << 6) | (static_cast<unsigned char>(text[i]) & 0x3Fu);
  }
  return {point, length};
}

struct Range {
  char32_t first;
  char32_t last;
};

template <std::size_t n>
bool contains(const Range (&ranges)[n], char32_t point) {
  return std::any_of(std::begin(ranges), std::end(ranges),
                     [&](Range range) { return range.first <= point && point <= range.last; });
}

std::size_t width_of(char32_t point) {
  constexpr Range combining[] = {{0x0300, 0x036F}, {0x1AB0, 0x1AFF}, {0x1DC0, 0x1DFF},
                                 {0x200B, 0x200F}, {0x20D0, 0x20FF}, {0xFE00, 0xFE0F}};
  constexpr Range wide[] = {{0x1100, 0x115F},   {0x2E80, 0x303E},  {0x3041, 0xA4CF},
                            {0xAC00, 0xD7A3},   {0xF900, 0xFAFF},  {0xFF00, 0xFF60},
                            {0x1F300, 0x1FAFF}, {0x20000, 0x3FFFD}};
  if (contains(combining, point)) return 0;
  return contains(wide, point) ? 2 : 1;
}

std::string padded(const std::string& cell, std::size_t width, Align align) {
  const std::string blanks(width - std::min(width, display_width(cell)), ' ');
  return align == Align::left ? cell + blanks : blanks + cell;
}

void trim_right(std::string& line) { line.erase(line.find_last_not_of(' ') + 1); }

volatile std::sig_atomic_t interrupted = 0;  // the signal that came
volatile std::sig_atomic_t seen = 0;         // by the work that is to stop

void alarm_after(long milliseconds) {
  const itimerval timer{{}, {0, 1000 * milliseconds}};
  ::setitimer(ITIMER_REAL, &timer, nullptr);
}

extern "C" void note_interrupt(int signal) {
  interrupted = signal;
  std::signal(signal, SIG_DFL);
  alarm_after(250);
}

/// From a signal handler.
void say(std::string_view line) {
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, line.data(), line.size());
}

/// Whoever has pressed Ctrl-C must not wonder whether it was heard.
extern "C" void answer_interrupt(int) {
  if (seen != 0) return say("interrupted: what there is will be kept; Ctrl-C again ends at once\n");
  say("error: interrupted\n");
  std::signal(interrupted, SIG_DFL);
  std::raise(interrupted);
}
}  // namespace

bool has_colour(std::FILE* stream) {
  const char* terminal = std::getenv("TERM");
  const bool dumb = terminal != nullptr && std::string_view(terminal) == "dumb";
  return is_terminal(stream) && !is_set("NO_COLOR") && !dumb;
}

std::string styled(std::string_view text, Style style, bool colour) {
  if (!colour) return std::string(text);
  return fmt::format("{}{}\033[0m", escape_code(style), text);
}

std::size_t display_width(std::string_view text) {
  std::size_t width = 0;
  while (!text.empty()) {
    if (const std::size_t escape = escape_length(text); escape > 0) {
      text.remove_prefix(escape);
      continue;
    }
    const auto [point, length] = decode(text);
    width += width_of(point);
    text.remove_prefix(length);
  }
  return width;
}

namespace {

/// Of a sequence of styled() at the beginning of `text`; 0: there is none.
std::size_t own_sequence(std::string_view text) {
  constexpr std::string_view end = "\033[0m";
  if (text.starts_with(end)) return end.size();
  for (const Style style :
       {Style::bold, Style::dim, Style::red, Style::yellow, Style::green, Style::cyan})
    if (const std::string_view code = escape_code(style); text.starts_with(code))
      return code.size();
  return 0;
}

/// Bytes of a control character at the beginning of `text`: C0, DEL, C1 in UTF-8; 0: there is none.
std::size_t control_length(std::string_view text) {
  const auto c = static_cast<unsigned char>(text[0]);
  if ((c < 0x20 && c != '\n' && c != '\t') || c == 0x7F) return 1;
  const bool c1 = c == 0xC2 && text.size() > 1 && static_cast<unsigned char>(text[1]) < 0xA0;
  return c1 ? 2 : 0;
}

}  // namespace

std::string without_commands(std::string_view text) {
  std::string shown;
  shown.reserve(text.size());
  while (!text.empty()) {
    const std::size_t own = own_sequence(text), control = own > 0 ? 0 : control_length(text);
    if (control > 0)
      shown += '?';
    else
      shown += text.substr(0, std::max<std::size_t>(own, 1));
    text.remove_prefix(std::max({own, control, std::size_t{1}}));
  }
  return shown;
}

void print_text(std::string_view text) { base::write_file_whole("-", without_commands(text)); }

namespace {
bool quiet = false, silent = false;

bool as_lines() {
  static const bool asked = is_set(progress_variable);
  return asked;
}

void print_line(const std::string& line) {
  // that nobody can read it changes no result
  std::fputs((without_commands(line) + '\n').c_str(), stderr);
}
}  // namespace

void be_quiet() { quiet = true; }
void be_silent() { quiet = silent = true; }
void be_piped() { piped = true; }

void print_note(const std::string& line) {
  if (!quiet) print_line(line);
}

void print_diagnostics(const std::vector<base::Diagnostic>& diagnostics) {
  const bool colour = has_colour(stderr);
  for (const base::Diagnostic& diagnostic : diagnostics) {
    const bool is_error = diagnostic.severity == base::Severity::error;
    if (silent && !is_error) continue;
    const std::string word = is_error ? "error:" : "warning:";
    std::string line = diagnostic.text();
    if (const std::size_t at = line.find(word); at != std::string::npos) {
      line.replace(at, word.size(), styled(word, is_error ? Style::red : Style::yellow, colour));
    }
    print_line(line);
  }
}

void print_error(std::string_view message) {
  print_diagnostics({{.message = std::string(message)}});
}

void print_warning(const std::string& message, const std::string& file) {
  print_diagnostics({{.severity = base::Severity::warning, .file = file, .message = message}});
}

void print_written(const std::string& path) { print_note("wrote " + path); }

Column::Column(std::string text) : title(std::move(text)) {
  if (!title.starts_with('<')) return;
  title.erase(0, 1);
  align = Align::left;
}

bool close_output() {
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good()) return true;
  if (errno == EPIPE) return true;
  print_error(fmt::format("writing to the standard output failed: {}", std::strerror(errno)));
  return false;
}

void Table::add_row(std::vector<std::string> cells) {
  if (cells.size() > columns_.size()) {
    throw std::invalid_argument(
        fmt::format("Table::add_row: {} cells for {} columns", cells.size(), columns_.size()));
  }
  rows_.push_back(std::move(cells));
}

std::vector<std::size_t> Table::widths() const {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    widths.push_back(display_width(columns_[c].title));
    for (const auto& row : rows_) {
      if (c < row.size()) widths[c] = std::max(widths[c], display_width(row[c]));
    }
  }
  return widths;
}

std::string Table::part(const std::vector<std::size_t>& shown, bool colour,
                        std::size_t most_rows) const {
  const auto width = widths();
  const auto line_of = [&](const auto& cell_of) {
    std::string line;
    for (const std::size_t c : shown) {
      if (c != shown.front()) line += gap;
      line += padded(cell_of(c), width[c], columns_[c].align);
    }
    trim_right(line);
    return line;
  };
  std::string all =
      styled(line_of([&](std::size_t c) { return columns_[c].title; }), Style::bold, colour) + '\n';
  for (const auto& row : std::span(rows_).first(std::min(rows_.size(), most_rows)))
    all += line_of([&](std::size_t c) { return c < row.size() ? row[c] : std::string(); }) + '\n';
  return all;
}

std::string Table::text(const TableStyle& style) const {
  const auto wide = widths();
  std::string all;
  std::size_t next = 1;
  do {
    std::vector<std::size_t> shown{0};
    std::size_t used = wide[0];
    while (next < columns_.size() &&
           (shown.size() == 1 || used + gap.size() + wide[next] <= style.width)) {
      used += gap.size() + wide[next];
      shown.push_back(next++);
    }
    if (!all.empty()) all += '\n';
    all += part(shown, style.colour, style.rows);
  } while (next < columns_.size() && !style.brief);
  std::vector<std::string> left;
  const auto leave = [&left](std::size_t count, const char* what) {
    if (count > 0) left.push_back(fmt::format("{} more {}{}", count, what, count > 1 ? "s" : ""));
  };
  leave(rows_.size() - std::min(rows_.size(), style.rows), "row");
  leave(columns_.size() - std::min(columns_.size(), next), "column");
  if (!left.empty()) all += fmt::format("… and {}; --all shows them\n", fmt::join(left, " and "));
  return all;
}

std::string bold(std::string_view text, const TableStyle& style) {
  return styled(text, Style::bold, style.colour);
}

namespace {

Extent extent = Extent::all;

/// Of the terminal that stdout is; zeros where it is none.
winsize terminal_size() {
  winsize size{};
  if (!is_terminal(stdout) || ::ioctl(::fileno(stdout), TIOCGWINSZ, &size) != 0) return {};
  return size;
}

/// Rows of a table that leave room for the lines around it on a terminal of so many lines.
std::size_t rows_on(unsigned lines) {
  constexpr std::size_t brief = 10, around = 14, least = 10;
  if (extent == Extent::brief) return brief;
  if (extent == Extent::all || lines == 0) return TableStyle{}.rows;
  return std::max(least, lines - std::min<std::size_t>(lines, around));
}

}  // namespace

void show(Extent asked) { extent = asked; }

TableStyle table_style(const std::string& output) {
  const bool printed = output == "-";
  const auto size = printed ? terminal_size() : winsize{};
  return {.colour = printed && has_colour(stdout),
          .width = size.ws_col > 0 ? size.ws_col : TableStyle{}.width,
          .rows = rows_on(size.ws_row),
          .brief = extent == Extent::brief};
}

std::string hertz(double omega, int decimals) {
  return fmt::format("{:.{}f}", omega / base::two_pi, decimals);
}

ProgressLine::ProgressLine(std::string title, double items)
    : title_(std::move(title)),
      items_(items),
      active_(as_lines() || (!quiet && is_terminal(stderr))) {}

ProgressLine::~ProgressLine() {
  if (shown_ && !as_lines()) std::fputs("\r\033[K", stderr);
}

void ProgressLine::update(double fraction) {
  if (!active_) return;
  const auto now = std::chrono::steady_clock::now();
  if (shown_ && now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  if (!shown_) {  // what came before, read from a file or not yet work, says nothing of the speed
    first_ = fraction;
    begun_ = now;
  }
  shown_ = true;
  if (as_lines()) return print_line(fmt::format("progress {:.4f}", fraction));
  const double spent = std::chrono::duration<double>(now - begun_).count();
  std::string left;
  if (const double done = fraction - first_; spent > 2.0 && done > 0.0) {
    if (items_ > 0.0) left = fmt::format(", {:.4g} per second", items_ * done / spent);
    left += fmt::format(", {:.0f} s left", spent * (1.0 - fraction) / done);
  }
  const std::string line = fmt::format("\r{} {:3.0f} %{}\033[K", title_, 100.0 * fraction, left);
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
}

InterruptNote::InterruptNote() {
  interrupted = 0;
  seen = 0;
  before_alarm_ = std::signal(SIGALRM, answer_interrupt);
  before_interrupt_ = std::signal(SIGINT, note_interrupt);
  before_terminate_ = std::signal(SIGTERM, note_interrupt);
}

InterruptNote::~InterruptNote() {
  std::signal(SIGINT, before_interrupt_);
  std::signal(SIGTERM, before_terminate_);
  alarm_after(0);
  std::signal(SIGALRM, before_alarm_);
}

bool InterruptNote::noted() {
  if (interrupted != 0) seen = 1;
  return interrupted != 0;
}

}  // namespace hydrapod::cli
