#pragma once
/// What the program shows: colour where a person looks, aligned tables, a progress line.

#include <chrono>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/base/error.hpp"
#include "hydrapod/numerics/parallel.hpp"

namespace hydrapod::cli {

/// True when `stream` is a terminal and neither NO_COLOR (https://no-color.org) nor TERM=dumb
/// stands in the environment.
bool has_colour(std::FILE* stream);

enum class Style { bold, dim, red, yellow, green, cyan };

/// `text` in a style, or as it is when `colour` is false.
std::string styled(std::string_view text, Style style, bool colour);

/// `text` without what could command a terminal: control characters become `?`, except line ends,
/// tabs and the sequences of styled(). Names of machines, channels and files may be anybody's.
std::string without_commands(std::string_view text);

/// A text of several lines on the standard output, without_commands().
void print_text(std::string_view text);

/// Columns that UTF-8 `text` takes on a terminal: escape sequences and combining marks take none,
/// wide (East Asian) characters two.
std::size_t display_width(std::string_view text);

/// From now on no notes and no progress on stderr. Warnings and errors stay.
void be_quiet();
/// No warnings either: of ranks other than 0.
void be_silent();
/// The standard output is no terminal, whatever it looks like: mpirun gives its ranks one.
void be_piped();

/// A note on stderr. Where it cannot be written (closed, disk full) the program goes on.
void print_note(const std::string& line);

/// One line per diagnostic on stderr, the word "error" or "warning" coloured on a terminal.
void print_diagnostics(const std::vector<base::Diagnostic>& diagnostics);

/// The same for a message that belongs to no file.
void print_error(std::string_view message);
void print_warning(const std::string& message, const std::string& file = {});

/// "wrote PATH" on stderr.
void print_written(const std::string& path);

/// Brings what was printed out. False, with a message, where that failed; a reader who has had
/// enough is no failure.
bool close_output();

/// Where a picture was asked for: draws it, and says so.
template <class Draw>
void draw(const std::string& path, const Draw& plot) {
  if (path.empty()) return;
  plot(path);
  print_written(path);
}

enum class Align { left, right };

/// A title; one that begins with '<' stands above a column that is aligned left.
struct Column {
  Column(const char* text) : Column(std::string(text)) {}  // NOLINT: a title is a column
  Column(std::string text);                                // NOLINT

  std::string title;
  Align align{Align::right};
};

/// How much of a result is printed: what fits the terminal's lines, the verdict with the first rows
/// (--brief), everything (--all). Where the output is no terminal, `screen` is everything too.
enum class Extent { screen, brief, all };
/// From now on. At first everything: a command without the options --brief and --all cuts nothing.
void show(Extent extent);

/// How tables are written. A table wider than `width` comes in parts, one below the other, each
/// beginning with the first column; `brief` shows the first part alone: columns stand in the order
/// of their importance. Of a table with more than `rows` rows the first ones are shown, and how
/// many are left out.
struct TableStyle {
  bool colour{};
  std::size_t width{static_cast<std::size_t>(-1)};
  std::size_t rows{static_cast<std::size_t>(-1)};
  bool brief{};  ///< the verdict, and what it rests on

  /// A part of a text that --brief leaves out.
  [[nodiscard]] std::string detail(const std::string& text) const { return brief ? "" : text; }
};

/// As the file `output` asks for; "-" is the terminal.
TableStyle table_style(const std::string& output);

std::string bold(std::string_view text, const TableStyle& style);

/// A table with a title row; columns are as wide as their widest cell and two spaces apart.
class Table {
 public:
  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}

  /// A row may be shorter than the columns; a longer one throws std::invalid_argument.
  void add_row(std::vector<std::string> cells);

  /// Lines without trailing blanks, each with its line end; the title row is bold if in colour.
  [[nodiscard]] std::string text(const TableStyle& style = {}) const;

 private:
  [[nodiscard]] std::vector<std::size_t> widths() const;
  [[nodiscard]] std::string part(const std::vector<std::size_t>& shown, bool colour,
                                 std::size_t most_rows) const;

  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// A frequency `omega` [rad/s] in Hz, without the unit.
std::string hertz(double omega, int decimals = 3);

/// A line on stderr that is rewritten in place, at most ten times a second, and gone at the end;
/// after two seconds it says how many are left at this speed, and of a work of so many `items` how
/// many are done in a second. Silent when stderr is not a terminal.
class ProgressLine {
 public:
  explicit ProgressLine(std::string title, double items = 0.0);
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine();

  /// `fraction` in [0, 1] of the work is done.
  void update(double fraction);

 private:
  std::string title_;
  double items_, first_{};  // share that was done at the first update
  bool shown_{};
  bool active_{};
  std::chrono::steady_clock::time_point begun_{};  // of the first update
  std::chrono::steady_clock::time_point last_{};
};

/// Ctrl-C as a wish to stop, not as an end: long work looks, and leaves what it has.
///
/// While one exists, the first SIGINT or SIGTERM is only noted; a second one ends the program as
/// usual. Where nothing has looked 0.25 s later, the program ends then, as without a note; else it
/// says that it is about to end. One at a time.
class InterruptNote {
 public:
  InterruptNote();
  ~InterruptNote();
  InterruptNote(const InterruptNote&) = delete;
  InterruptNote& operator=(const InterruptNote&) = delete;

  [[nodiscard]] static bool noted();

 private:
  void (*before_alarm_)(int);
  void (*before_interrupt_)(int);
  void (*before_terminate_)(int);
};

/// What `task` makes, with a progress line titled `title`. Ctrl-C asks the task to stop.
template <class Task>
auto with_progress(const char* title, const Task& task, double items = 0.0) {
  const InterruptNote interrupt;
  ProgressLine line(title, items);
  return task(numerics::Progress([&](double share) {
    line.update(share);
    return InterruptNote::noted();
  }));
}

}  // namespace hydrapod::cli
