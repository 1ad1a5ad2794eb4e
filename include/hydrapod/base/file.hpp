#pragma once
/// Files read with a limit, and written whole or not at all.
///
/// Tables in text files: CSV of hydrapod, of spreadsheets and of measuring programs.
///
/// | part      | rule                                                                             |
/// | --------- | -------------------------------------------------------------------------------- |
/// | line      | ends with LF, CR LF or CR; at most 16 MiB; a byte order mark is passed over      |
/// | comment   | a line that begins with #, % or //                                               |
/// | separator | semicolon, else tabulator, else comma, whichever the title row has first in this |
/// |           | list; ' ' stands for any number of blanks and tabulators                         |
/// | cell      | without blanks around; in double quotes it may hold separators, "" is a quote    |
/// | number    | 1.5, +1.5, 1.5e-3, nan, inf; 1,5 where commas do not separate cells; an empty    |
/// |           | cell, NA and N/A are NaN                                                         |
/// | title     | name and unit: "p [bar]", "p (bar)", "p / bar"                                   |

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/base/error.hpp"

namespace hydrapod::base {

/// The text of `path` (`-`: standard input), no more than `largest` bytes. Throws InputError when
/// it cannot be read or is larger; `expected` then says what would be ("a machine file").
std::string read_file(const std::string& path, std::size_t largest, std::string_view expected);

/// Writes `text` to `path` so that a reader finds either what was there before or all of the new
/// text: into a temporary file beside it, to the disk, then renamed. A symbolic link is followed
/// and stays one; an existing file keeps its permissions; a device or pipe is written directly. `-`
/// is the standard output.
///
/// Throws InputError when the place cannot be written to (no such folder, no permission) and
/// ComputationError when writing failed on the way (disk full); what was there before is then
/// untouched.
void write_file_whole(const std::string& path, std::string_view text);

/// A file that grows over a long time and takes its place only when it is complete: written as
/// `PATH.part`, which replaces PATH at commit(). Until then what was at PATH stays; after a crash
/// or a kill the part is what is left. A PartFile that goes without commit() removes its part.
/// Where a part stands already, of another program or of a run that was killed, it is left alone
/// and the name is `PATH.part2`, and so on.
class PartFile {
 public:
  /// Makes the empty part. A symbolic link is followed. Throws InputError when there cannot be a
  /// file at `path` (no such folder, no permission, a device or folder stands there).
  explicit PartFile(const std::string& path);
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;
  ~PartFile();

  [[nodiscard]] const std::string& path() const { return path_; }  ///< as it was given
  [[nodiscard]] const std::string& part() const { return part_; }  ///< what to write into

  /// The part, which must be closed by now, becomes the file: to the disk, then renamed; where it
  /// then is. What is not `complete` does not replace a file that was there before, and nothing
  /// replaces one that came to be there meanwhile: then the part stays. Throws ComputationError.
  std::string commit(bool complete = true);

  /// The part stays as it is, for what can be read of it.
  void keep() { kept_ = true; }

 private:
  std::string path_;
  std::string target_;
  std::string part_;
  bool replaces_{};  ///< there was a file when the part was made
  bool committed_{};
  bool kept_{};
};

/// There is no file at `path`, and this program was not told to replace one that `must_stay`. If
/// another program makes one there before this one does, write_file_whole and PartFile throw
/// InputError and leave it as it is. Holds for the whole process, until it has made the file.
void expect_no_file(const std::string& path, std::function<bool(const std::string&)> must_stay);

struct TableStyle {
  char separator{','};
  bool decimal_comma{};
};

struct TableCell {
  std::string text{};  ///< without quotes and blanks around
  unsigned column{};   ///< of its first character in the line, from 1
};

struct TableTitle {
  std::string name{};
  std::string unit{};      ///< empty: none
  unsigned column{};       ///< of the name, from 1
  unsigned unit_column{};  ///< of the unit, or of the name where there is none
};

/// Reads a table line by line, in bounded memory.
class TableReader {
 public:
  /// A file. Throws InputError when it cannot be opened.
  explicit TableReader(const std::string& path);
  /// A text; `name` stands in messages.
  TableReader(std::string text, std::string name);

  /// The next line that is not empty and, unless `with_comments`, no comment; false at the end. The
  /// view holds until the next call. Throws InputError for a line of more than 16 MiB.
  bool next_line(std::string_view& line, bool with_comments = false);

  /// Of the line that was read last, from 1.
  [[nodiscard]] unsigned line() const { return line_; }
  /// False when the file ended within the line that was read last.
  [[nodiscard]] bool line_was_ended() const { return ended_; }

  /// A place in the file, to read on from there again.
  struct Place {
    std::uint64_t offset{};
    unsigned line{};  ///< before it
  };
  /// Of the line that was read last.
  [[nodiscard]] Place line_place() const { return {line_begin_, line_ - 1}; }
  void go_to(const Place& place);

  /// The next line as title row, whose separator becomes that of the table. Empty at the end.
  std::vector<TableTitle> titles();
  /// The next row with anything in it; false at the end.
  bool row(std::vector<TableCell>& cells);
  /// Of cells: as titles() found it, unless set.
  TableStyle style{};

  /// An error at `column` of the line that was read last; column 0: about the file as a whole.
  [[nodiscard]] Diagnostic fault(unsigned column, std::string key, std::string message) const;

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  bool refill();
  bool next_raw_line(std::string_view& line);

  std::string name_;
  std::unique_ptr<std::FILE, CloseFile> file_;  ///< none: all of the text is in buffer_
  std::vector<char> buffer_;
  std::size_t begin_{}, end_{};  ///< of what has not been given yet in buffer_
  std::uint64_t taken_{};        ///< bytes of the file before begin_
  std::uint64_t line_begin_{};
  unsigned line_{};
  bool ended_{true};
  bool at_end_{};
};

/// Takes the cells off a line one by one, without copying them.
class TableCells {
 public:
  TableCells(std::string_view line, char separator)
      : line_(line), separator_(separator), done_(separator == ' ' && blank()) {}

  /// The next cell without blanks and quotes around; doubled quotes within stay. False at the end.
  bool next(std::string_view& cell);
  /// Of the first character of the cell that next() gave last, from 1.
  [[nodiscard]] unsigned column() const { return column_; }

 private:
  [[nodiscard]] bool blank() const { return line_.find_first_not_of(" \t") == line_.npos; }

  std::string_view line_;
  char separator_;
  std::size_t at_{};
  unsigned column_{};
  bool done_;
};

std::vector<TableCell> table_cells(std::string_view line, char separator);

/// A cell as a number, see above. None: it is text.
std::optional<double> table_number(std::string_view cell, bool decimal_comma);

/// A number in front of a unit with a point for its decimal comma ("4,2 Hz"); other texts as they
/// are.
std::string with_decimal_point(std::string cell);

TableTitle table_title(const TableCell& cell);

bool is_table_comment(std::string_view line);

/// `text` as a cell: in quotes where it has a separator, a quote or a blank at an end.
std::string quoted_cell(std::string_view text);

}  // namespace hydrapod::base
