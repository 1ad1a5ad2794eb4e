#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "uff_dataset.hpp"
#include "uff_geometry.hpp"
#include "uff_text.hpp"

namespace hydrapod::data {

namespace {

constexpr std::size_t most_functions = 100'000;

bool is_delimiter(std::string_view line) {
  return base::trimmed(line) == "-1" && base::trimmed(line.substr(0, 6)) == "-1";
}

class Scan {
 public:
  /// `heads_only`: values are passed over where their lines are even.
  Scan(const std::string& path, Notes& notes, bool heads_only, bool with_matrices = false)
      : file_(path), notes_(notes), heads_only_(heads_only), with_matrices_(with_matrices) {}

  UffContents all() {
    std::string_view line;
    while (next(line)) {
      if (!is_delimiter(line)) {
        if (!base::trimmed(line).empty())
          notes_.add("text outside of datasets, skipped", line_, 0, "outside");
        continue;
      }
      begin_dataset();
    }
    if (datasets_ == 0)
      notes_.fail("this is no Universal File: it has no dataset between lines of \"    -1\"");
    settle_units();
    return std::move(contents_);
  }

 private:
  /// The next line; it holds until the next call. Where the file ends within it, a number at its
  /// end may be another one than was written, and is left out.
  bool next(std::string_view& line) {
    if (offset_ >= file_.size()) return false;
    const FileWindow::Line got = file_.line_at(offset_);
    line = is_delimiter(got.text) ? got.text : got.whole();
    offset_ = got.next;
    if (count_lines_) ++line_;
    return true;
  }

  /// The next line of a dataset; false at its end.
  bool next_inside(std::string_view& line) {
    if (!next(line)) return false;
    ended_ = is_delimiter(line);
    return !ended_;
  }

  void begin_dataset() {
    std::string_view line;
    do {
      if (!next(line)) return;  // the last delimiter of a file
    } while (is_delimiter(line));
    ++datasets_;
    first_line_ = line_;
    const std::string head(line);
    const auto number = fortran_integer(columns(head, 0, 6));
    const std::string_view kind = columns(head, 6, 1);
    const bool matrix = number == 250 || number == 252 || number == 2453;
    is_binary_ = (number == 58 || matrix) && (kind == "b" || kind == "B");
    try {
      if (!number)
        throw Unusable{fmt::format("\"{}\" is not the number of a dataset",
                                   base::printable(columns(head, 0, 6)))};
      if (*number == 58)
        function(head, is_binary_);
      else if (*number == uff_modes || *number == uff_analysis)
        take_lines(static_cast<int>(*number), contents_.modes);
      else if (matrix && with_matrices_)
        take_matrix(*number);
      else if (*number == 151)
        file_header();
      else if (*number == 164)
        units_ = read_uff_units(next_line(), notes_);
      else if (*number == uff_nodes || *number == uff_nodes_double)
        nodes(*number == uff_nodes_double);
      else if (*number == uff_elements)
        take_elements();
      else if (*number == uff_trace_line)
        contents_.geometry.lines.push_back(read_uff_trace_line(next_line()));
      else if (*number == uff_own_dataset)
        own_header();
      else
        notes_.add(fmt::format("dataset {} has the number {}, which is not read: skipped",
                               datasets_, *number),
                   first_line_, 0, fmt::format("number {}", *number));
    } catch (const Unusable& unusable) {
      notes_.add(fmt::format("dataset {}: {}; skipped", datasets_, unusable.why), first_line_);
      if (number == 164) units_.emplace().usable = false;
    }
    if (!first_units_) first_units_ = units_;
    node_units_.resize(contents_.geometry.nodes.size(), units_);
    skip_to_end();
  }

  /// Behind the delimiter that ends this dataset.
  void skip_to_end() {
    std::string_view line;
    if (ended_) {
      ended_ = false;
      return;
    }
    if (is_binary_ && find_binary_end()) return;
    while (next(line))
      if (is_delimiter(line)) return;
    notes_.add(fmt::format("the file is cut off in dataset {}: its end is missing", datasets_));
  }

  /// Behind binary data the delimiter need not begin a line.
  bool find_binary_end() {
    constexpr std::string_view mark = "    -1";
    constexpr std::size_t step = 1U << 16U;
    for (std::uint64_t at = offset_; at < file_.size();) {
      const std::string bytes(file_.at(at, step).substr(0, step));
      for (std::size_t found = bytes.find(mark); found != bytes.npos;
           found = bytes.find(mark, found + 1)) {
        const std::string_view behind = file_.at(at + found + mark.size(), 1);
        if (!behind.empty() && behind[0] != '\n' && behind[0] != '\r' && behind[0] != ' ') continue;
        offset_ = file_.line_at(at + found).next;
        return true;
      }
      at += bytes.size() > mark.size() ? bytes.size() - mark.size() + 1 : bytes.size();
    }
    return false;
  }

  /// A line of a dataset's header, which may not end here.
  std::string header_line(const char* what) {
    std::string_view line;
    if (next_inside(line)) return std::string(line);
    if (ended_) throw Unusable{fmt::format("it ends before its {}", what)};
    throw Unusable{fmt::format("the file is cut off before its {}", what)};
  }

  void function(const std::string& head, bool binary) {
    if (contents_.functions.size() == most_functions)
      throw Unusable{fmt::format("more than {} functions", most_functions)};
    UffFunction f;
    f.dataset = datasets_;
    f.line = first_line_;
    f.binary = binary;
    f.units = units_;
    const char* names[uff_header_lines] = {"record 1",
                                           "record 2",
                                           "record 3",
                                           "record 4",
                                           "record 5",
                                           "record 6",
                                           "record 7",
                                           "record 8 (abscissa)",
                                           "record 9 (ordinate)",
                                           "record 10",
                                           "record 11 (z axis)"};
    std::array<std::string, uff_header_lines> lines;
    for (int i = 0; i < uff_header_lines; ++i)
      lines[static_cast<std::size_t>(i)] = header_line(names[i]);
    for (std::size_t i = 0; i < f.id.size(); ++i) f.id[i] = uff_field(lines[i], 0, 80);
    places(lines[5], f);
    data_form(lines[6], f);
    f.abscissa = uff_axis(lines[7]);
    f.ordinate = uff_axis(lines[8]);
    f.denominator = uff_axis(lines[9]);
    f.z_axis = uff_axis(lines[10]);
    f.begin = offset_;
    f.data_line = count_lines_ ? line_ + 1 : 0;
    if (binary)
      binary_values(head, f);
    else
      text_values(f);
    if (f.count < f.declared)
      notes_.add(
          fmt::format("dataset {} declares {} values and holds {}", datasets_, f.declared, f.count),
          f.line);
    contents_.functions.push_back(f);
  }

  static void places(const std::string& line, UffFunction& f) {
    f.type = uff_small(line, 0, 5, "the function type", 0, 99999);
    f.number = uff_integer(line, 5, 10, "the function identification number");
    f.version = uff_integer(line, 15, 5, "the version number");
    f.load_case = uff_integer(line, 20, 10, "the load case");
    f.response = uff_place_at(line, 30, "the response node or direction");
    f.reference = uff_place_at(line, 55, "the reference node or direction");
  }

  static void data_form(const std::string& line, UffFunction& f) {
    const long long type = uff_integer(line, 0, 10, "the ordinate data type");
    if (type != 2 && type != 4 && type != 5 && type != 6)
      throw Unusable{fmt::format("the ordinate data type is {}; known are 2, 4, 5 and 6", type)};
    f.is_complex = type >= 5;
    f.is_double = type == 4 || type == 6;
    const long long count = uff_integer(line, 10, 10, "the number of values");
    if (count < 0) throw Unusable{fmt::format("the number of values is {}", count)};
    f.declared = static_cast<std::uint64_t>(count);
    f.is_even = uff_integer(line, 20, 10, "the abscissa spacing") == 1;
    f.first = uff_real(line, 30, 13, "the abscissa minimum");
    f.step = uff_real(line, 43, 13, "the abscissa increment");
    f.z = uff_real(line, 56, 13, "the z-axis value");
    if (f.is_even && !(f.step > 0.0) && f.declared > 1)
      throw Unusable{fmt::format("the abscissa increment is {} and must be positive", f.step)};
  }

  bool delimiter_at(std::uint64_t offset) {
    const std::string_view bytes = file_.at(offset, 8);
    const std::size_t begin = std::min(bytes.find_first_not_of("\r\n"), bytes.size());
    return begin <= 2 && bytes.substr(begin).starts_with("    -1");
  }

  void binary_values(const std::string& head, UffFunction& f) {
    const long long order = uff_integer(head, 7, 6, "the byte order");
    const long long floats = uff_integer(head, 13, 6, "the floating point format");
    const auto bytes =
        static_cast<std::uint64_t>(std::max(uff_integer(head, 31, 12, "the number of bytes"), 0LL));
    count_lines_ = false;  // what looks like lines in binary data is none
    line_ = 0;
    f.big_endian = order == 2;
    const std::uint64_t value = (f.is_double ? 8U : 4U) * (f.is_complex ? 2U : 1U);
    std::uint64_t stride = value + (f.is_even ? 0U : f.is_double ? 8U : 4U);
    f.wide_abscissa = f.is_double;
    if (!f.is_even && f.is_double && f.declared > 0 && bytes / f.declared == value + 4) {
      f.wide_abscissa = false;
      stride = value + 4;
    }
    const std::uint64_t left = file_.size() - offset_;
    const bool fits = f.declared <= left / stride;
    std::uint64_t used = fits ? f.declared * stride : left;
    if (bytes > 0 && bytes != f.declared * stride) {
      notes_.add(fmt::format("dataset {} declares {} values and {} bytes, which do not fit",
                             datasets_, f.declared, bytes));
      const bool by_values = fits && delimiter_at(offset_ + used);
      if (!by_values && bytes <= left && delimiter_at(offset_ + bytes)) used = bytes;
    }
    f.count = std::min(f.declared, used / stride);
    f.end = offset_ + f.count * stride;
    offset_ += used;
    if (order != 1 && order != 2)
      throw Unusable{
          fmt::format("the byte order is {}; known are 1 (little endian) and 2 (big "
                      "endian)",
                      order)};
    if (floats != 2)
      throw Unusable{
          fmt::format("the floating point format is {}; only 2 (IEEE 754) is read", floats)};
  }

  /// To the delimiter, where lines as long as the first one lead to it. Lines are not counted then.
  bool pass_over_values(const UffFunction& f, const std::vector<int>& widths) {
    const FileWindow::Line first = file_.line_at(offset_);
    if (is_delimiter(first.text)) return false;
    const std::uint64_t numbers = f.declared * tuple_size(f), length = first.next - offset_;
    const auto left = static_cast<std::ptrdiff_t>(numbers % widths.size());
    std::uint64_t bytes = numbers / widths.size() * length;
    if (left > 0)
      bytes += std::accumulate(widths.begin(), widths.begin() + left,
                               length - std::min<std::uint64_t>(length, first.text.size()));
    if (bytes > file_.size() - offset_ || !delimiter_at(offset_ + bytes)) return false;
    offset_ += bytes;
    return true;
  }

  /// Lines up to the delimiter; how many values they hold.
  void text_values(UffFunction& f) {
    const auto widths = uff_widths(f);
    const auto whole = std::accumulate(widths.begin(), widths.end(), std::size_t{0});
    if (heads_only_ && pass_over_values(f, widths)) return;
    std::uint64_t numbers = 0;
    bool is_first = true;
    std::string_view line;
    for (f.end = offset_; next_inside(line); f.end = offset_) {
      unsigned bad = 0;
      if (is_first) {
        uff_line_numbers(line, widths, false, bad);
        unsigned bad_when_free = 0;
        if (bad > 0) uff_line_numbers(line, widths, true, bad_when_free);
        f.free_form = bad > 0 && bad_when_free == 0;
        is_first = false;
      }
      const std::size_t length = line.find_last_not_of(" \t") + 1;
      const bool full = !f.free_form && length > whole - static_cast<std::size_t>(widths.back());
      numbers += full ? widths.size() : uff_line_numbers(line, widths, f.free_form, bad).size();
    }
    f.count = std::min<std::uint64_t>(f.declared, numbers / tuple_size(f));
  }

  void take_lines(int number, std::vector<UffLines>& all) {
    constexpr std::size_t most_lines = 2'000'000;
    UffLines& dataset = all.emplace_back();
    dataset.number = number;
    dataset.line = count_lines_ ? line_ + 1 : 0;
    dataset.units = units_;
    for (std::string_view line; next_inside(line);) {
      if (++kept_lines_ > most_lines)
        throw Unusable{fmt::format("more than {} lines of modes and matrices", most_lines)};
      dataset.lines.emplace_back(line);
    }
  }

  void take_matrix(long long number) {
    if (is_binary_)
      notes_.fail(fmt::format("dataset {} is a binary matrix ({}b), expected the text format ({})",
                              datasets_, number, number),
                  first_line_);
    take_lines(static_cast<int>(number), contents_.matrices);
  }

  void file_header() {
    contents_.model_name = uff_field(header_line("model name"), 0, 80);
    contents_.description = uff_field(header_line("description"), 0, 80);
    contents_.program = uff_field(header_line("program"), 0, 80);
    std::string_view date;
    if (next_inside(date)) contents_.date = uff_field(date, 0, 20);
  }

  [[nodiscard]] UffNextLine next_line() {
    return [this](std::string_view& line) { return next_inside(line); };
  }

  /// What is there of nodes before something is wrong is kept.
  void nodes(bool in_double) { read_uff_nodes(next_line(), in_double, contents_.geometry.nodes); }

  /// Rods and beams are lines; the form of other elements is not kept.
  void take_elements() {
    auto rods = read_uff_rods(next_line());
    if (!rods.nodes.empty()) contents_.geometry.lines.push_back(std::move(rods));
  }

  /// Lengths of nodes in metres, and the units of functions and modes that stood before the first
  /// dataset 164.
  void settle_units() {
    const auto settle = [&](std::optional<UffUnits>& units) {
      if (!units) units = first_units_;
    };
    for (UffFunction& f : contents_.functions) settle(f.units);
    for (UffLines& mode : contents_.modes) settle(mode.units);
    for (UffLines& matrix : contents_.matrices) settle(matrix.units);
    auto& nodes = contents_.geometry.nodes;
    node_units_.resize(nodes.size());
    bool usable = true;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      settle(node_units_[k]);
      usable = usable && (!node_units_[k] || node_units_[k]->usable);
      if (node_units_[k]) nodes[k].position /= node_units_[k]->length;
    }
    if (!usable) {
      notes_.add("the unit of the coordinates of the nodes is unknown: the nodes are left out");
      nodes.clear();
    } else if (!nodes.empty() && !first_units_) {
      notes_.add("the file states no units (dataset 164): coordinates are taken as metres");
    }
  }

  void own_header() {
    std::string_view line;
    while (next_inside(line)) {
      std::string whole(line);  // lines may be longer than the pieces they come in
      while (offset_ < file_.size() && whole.size() % 4096 == 0 && !whole.empty() && next(line))
        whole += line;
      if (base::is_table_comment(whole)) contents_.own.take(whole, line_);
    }
  }

  FileWindow file_;
  Notes& notes_;
  bool heads_only_, with_matrices_;
  UffContents contents_;
  std::uint64_t offset_{};
  unsigned line_{}, first_line_{};
  bool count_lines_{true};
  bool is_binary_{};
  bool ended_{};  ///< the delimiter of this dataset has been taken
  std::size_t datasets_{};
  std::size_t kept_lines_{};
  std::optional<UffUnits> units_{}, first_units_{};    ///< the last and the first one
  std::vector<std::optional<UffUnits>> node_units_{};  ///< of the nodes so far
};

}  // namespace

UffContents scan_uff(const std::string& path, Notes& notes, bool with_matrices) {
  return Scan(path, notes, false, with_matrices).all();
}

FileKind uff_kind(const std::string& path) {
  Notes notes(path);
  const UffContents contents = Scan(path, notes, true).all();
  const auto is_response = [](const auto& f) { return f.type == uff_function::frequency_response; };
  if (std::ranges::any_of(contents.functions, is_response)) return FileKind::frequency_responses;
  return contents.functions.empty() && !contents.modes.empty() ? FileKind::modal_results
                                                               : FileKind::record;
}

}  // namespace hydrapod::data
