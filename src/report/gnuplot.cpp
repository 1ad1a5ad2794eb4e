#include "gnuplot.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/file.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/report/model_results.hpp"

namespace hydrapod::report {

namespace {

/// Told apart by the colour-blind as well (Okabe & Ito).
constexpr std::array colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"};

/// As a word of the shell.
std::string shell_word(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string terminal_of(const std::string& path, int width, int height) {
  const std::string ending = std::filesystem::path(path).extension().string();
  const std::string font = "font 'Helvetica,11'";
  if (ending == ".svg")
    return fmt::format("svg size {},{} dynamic background rgb 'white' {} enhanced", width, height,
                       font);
  if (ending == ".png") return fmt::format("pngcairo size {},{} {}", width, height, font);
  if (ending == ".pdf")
    return fmt::format("pdfcairo size {:.2f}in,{:.2f}in {}", width / 96.0, height / 96.0, font);
  base::refuse("--plot " + path,
               fmt::format("a plot ends in .svg, .png or .pdf; found '{}'", ending));
}

std::string file_text(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// A folder of its own that is gone at the end.
struct TemporaryFolder {
  std::filesystem::path path;
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "hydrapod-plot-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw base::ComputationError("no temporary folder for the plot could be made in " +
                                   std::filesystem::temp_directory_path().string());
    path = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
};

void run_gnuplot(const std::filesystem::path& script, const std::filesystem::path& log) {
  const std::string command = fmt::format("gnuplot {} > {} 2>&1 < /dev/null",
                                          shell_word(script.string()), shell_word(log.string()));
  const int status = std::system(command.c_str());
  if (status == 0) return;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
    throw base::ComputationError("plots need the program gnuplot; install the package gnuplot-nox");
  std::string said = file_text(log);
  said.erase(said.find_last_not_of(" \n") + 1);
  throw base::ComputationError("gnuplot failed: " + said);
}

}  // namespace

std::string quoted(const std::string& text) {
  // gnuplot does not read a text in single quotes that begins with a doubled one
  const std::size_t leading = std::min(text.find_first_not_of('\''), text.size());
  std::string out = leading == 0 ? "'" : '"' + text.substr(0, leading) + "\".'";
  for (const char c : std::string_view(text).substr(leading)) {
    if (c == '\'') out += '\'';
    out += static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? ' ' : c;
  }
  return out + "'";
}

void require_picture_ending(const std::string& path) { terminal_of(path, 1, 1); }

void draw(const std::string& path, int width, int height, const Script& script) {
  const std::string terminal = terminal_of(path, width, height);
  const TemporaryFolder folder;
  const auto picture = folder.path / "picture";
  const auto file = folder.path / "plot.gp";
  base::write_file_whole(file.string(), script(terminal, picture.string()));
  run_gnuplot(file, folder.path / "log");
  const std::string drawn = file_text(picture);
  base::write_file_whole(path,
                         with_origin(path.ends_with(".svg") ? joined_cells(drawn) : drawn, path));
}

void draw(const std::string& path, int width, int height, const std::string& body) {
  draw(path, width, height, [&](const std::string& terminal, const std::string& file) {
    return opened(terminal, file) + body + "unset output\n";
  });
}

std::string opened(const std::string& terminal, const std::string& file) {
  std::string text =
      fmt::format("set terminal {}\nset output {}\nset encoding utf8\nset termoption noenhanced\n",
                  terminal, quoted(file));
  for (std::size_t k = 0; k < colours.size(); ++k)
    text += fmt::format("set linetype {} lc rgb '{}'\n", k + 1, colours[k]);
  return text;
}

namespace {

/// The first `most` characters, at most to the last blank among them.
std::string_view beginning(std::string_view text, std::size_t most) {
  std::size_t end = 0, count = 0, blank = 0;
  for (; end < text.size(); ++end) {
    if ((static_cast<unsigned char>(text[end]) & 0xC0U) != 0x80U && count++ == most) break;
    if (text[end] == ' ') blank = end;
  }
  return text.substr(0, end == text.size() || blank == 0 ? end : blank);
}

/// What does not fit ends in "…".
std::string shortened(std::string_view text, std::size_t most) {
  return base::characters(text) <= most ? std::string(text)
                                        : std::string(beginning(text, most - 1)) + "…";
}

}  // namespace

std::string titles(const std::string& title, const std::string& subtitle, int width, int height) {
  constexpr double character = 6.4, small = 5.8;                  // mean widths [pixels]
  constexpr double title_character = 10.0, small_of_title = 8.6;  // of sizes 14 and 12
  const auto fitting = [&](double one) {
    return static_cast<std::size_t>(std::max(12.0, (width - 20.0) / one));
  };
  std::string below = quoted(subtitle);
  double size = 10.0;
  if (base::characters(subtitle) > fitting(character)) {
    size = 9.0;
    const auto first = beginning(subtitle, fitting(small));
    std::string_view rest = std::string_view(subtitle).substr(first.size());
    rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
    below = quoted(std::string(first));
    if (!rest.empty()) below += ".\"\\n\"." + quoted(shortened(rest, fitting(small)));
  }
  const bool fits = base::characters(title) <= fitting(title_character);
  return fmt::format(
      "set label 101 {} at screen 0.5,{:.4f} center font ',{}'\n"
      "set label 102 {} at screen 0.5,{:.4f} center font ',{}' tc rgb '#444444'\n",
      quoted(shortened(title, fitting(fits ? title_character : small_of_title))),
      1.0 - 22.0 / height, fits ? 14 : 12, below, 1.0 - 46.0 / height, size);
}

std::string key_below_titles(int height) {
  return fmt::format(
      "set key at screen 0.5,{:.4f} center center horizontal samplen 2.5 font ',9'\n",
      1.0 - 68.0 / height);
}

CellPair split(const Cell& cell, int height) {
  const double middle = cell.bottom + 0.36 * (cell.top - cell.bottom), apart = 8.0 / height;
  return {{cell.left, cell.right, cell.top, middle + apart},
          {cell.left, cell.right, middle - apart, cell.bottom}};
}

std::string at_screen(const Cell& cell) {
  return fmt::format(
      "set lmargin at screen {:.4f}; set rmargin at screen {:.4f}\n"
      "set tmargin at screen {:.4f}; set bmargin at screen {:.4f}\n",
      cell.left, cell.right, cell.top, cell.bottom);
}

CellGrid::CellGrid(std::size_t cells)
    : columns(static_cast<int>(std::min<std::size_t>(3, cells))),
      rows((static_cast<int>(cells) + columns - 1) / columns) {}

Cell CellGrid::operator[](std::size_t index) const {
  const int row = static_cast<int>(index) / columns, column = static_cast<int>(index) % columns;
  const double w = 1.0 / columns;
  const double band = static_cast<double>(top_band) / height();
  const double h = (1.0 - band) / rows;
  const double top = 1.0 - band - row * h;
  return {column * w + 80.0 / width(), (column + 1) * w - 14.0 / width(), top - 26.0 / height(),
          top - h + 52.0 / height()};
}

namespace {

/// `digits` times powers of ten, in the band.
std::vector<double> decade_ticks(double from, double to, const std::vector<double>& digits) {
  constexpr double rounding = 1e-9;
  std::vector<double> ticks;
  const int lowest = static_cast<int>(std::floor(std::log10(from))) - 1;
  const int highest = static_cast<int>(std::ceil(std::log10(to)));
  for (int decade = lowest; decade <= highest; ++decade)
    for (const double digit : digits) ticks.push_back(digit * std::pow(10.0, decade));
  std::erase_if(
      ticks, [&](double at) { return at < from * (1.0 - rounding) || at > to * (1.0 + rounding); });
  return ticks;
}

/// Four to ten round numbers, evenly spaced; fewer of them where their distances differ much.
std::vector<double> even_ticks(double from, double to) {
  const double power = std::pow(10.0, std::floor(std::log10((to - from) / 2.0)));
  const double steps = (to - from) / power;  // 2 … 20
  const bool even = to < 2.0 * from;
  const double step = power * (steps < 4.0            ? 0.5
                               : steps < 8.0          ? 1.0
                               : steps < 16.0 || even ? 2.0
                                                      : 4.0);
  std::vector<double> ticks;
  for (double k = std::ceil(from / step); k * step <= to; ++k) ticks.push_back(k * step);
  return ticks;
}

}  // namespace

std::string logarithmic_axis(double from, double to) {
  constexpr std::size_t enough = 4, most = 11;  // twelve contain four powers of ten
  auto ticks = decade_ticks(from, to, {1.0, 2.0, 5.0});
  if (ticks.size() > most) ticks = decade_ticks(from, to, {1.0});
  if (ticks.size() < enough) ticks = decade_ticks(from, to, {1.0, 1.5, 2.0, 3.0, 5.0, 7.0});
  if (ticks.size() < enough && to > from) ticks = even_ticks(from, to);
  return fmt::format("set logscale x\nset xrange [{:.9g}:{:.9g}]\nset xtics ({:.6g})\n", from, to,
                     fmt::join(ticks, ", "));
}

std::vector<std::size_t> stretches_of(const std::vector<double>& at, bool logarithmic, int most) {
  std::vector<std::size_t> begins;
  if (at.empty()) return {0};
  const auto place = [&](double value) { return logarithmic ? std::log(value) : value; };
  const double from = place(at.front()), span = place(at.back()) - from;
  int last = -1;
  for (std::size_t k = 0; k < at.size(); ++k) {
    const double share = span > 0.0 ? (place(at[k]) - from) / span : 0.0;
    const int stretch = std::min(static_cast<int>(share * most), most - 1);
    if (stretch == last) continue;
    begins.push_back(k);
    last = stretch;
  }
  begins.push_back(at.size());
  return begins;
}

std::string block_of(const std::string& name, const std::string& rows) {
  return fmt::format("${} << END\n{}END\n", name, rows);
}

std::string matrix_rows(const Eigen::MatrixXd& values, int first) {
  std::string text;
  for (Eigen::Index i = 0; i < values.rows(); ++i)
    for (Eigen::Index j = 0; j < values.cols(); ++j)
      text += fmt::format("{} {} {:.4f}\n", j + first, i + first, values(i, j));
  return text;
}

std::string named_tics(char axis, const std::vector<std::string>& names, int first) {
  std::string text = fmt::format("set {}tics ()\n", axis);
  for (const auto& name : names)
    text += fmt::format("set {}tics add ({} {})\n", axis, quoted(name), first++);
  return text;
}

std::string six_lines(const char* name, int first, int step, double width,
                      const std::array<std::string, 6>& names, bool directions) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const char* dashes = directions && (i == 1 || i == 4) ? " dt (7,5)" : "";
    lines.push_back(fmt::format("${} using 1:{} with lines lw {}{} lc rgb '{}' title '{}'", name,
                                first + step * static_cast<int>(i), width, dashes, colours[i],
                                names[i]));
  }
  return fmt::format("plot {}\n", fmt::join(lines, ", "));
}

double level_db(double magnitude) { return 20.0 * std::log10(std::max(magnitude, 1e-300)); }

double phase_cut(const std::vector<double>& degrees) {
  constexpr int bins = 72, wide = 360 / bins;
  std::array<int, bins> count{};
  for (const double angle : degrees)
    if (std::isfinite(angle))
      ++count.at(static_cast<std::size_t>(within_turn(angle, 0.0) / wide) % bins);
  const int least = *std::ranges::min_element(count);
  int longest = 0, middle = bins / 2;  // twice the number of bins below the middle of the run
  for (int begin = 0; begin < bins; ++begin) {
    int length = 0;
    while (length < bins && count.at(static_cast<std::size_t>((begin + length) % bins)) == least)
      ++length;
    if (length <= longest || length == bins) continue;
    longest = length;
    middle = (2 * begin + length) % (2 * bins);
  }
  if (longest == 0) return -180.0;  // all angles or none
  return within_turn(0.5 * wide * middle, 0.0) - 360.0;
}

double within_turn(double angle, double from) {
  const double turned = angle - 360.0 * std::floor((angle - from) / 360.0);
  return turned < from + 360.0 ? turned : from;
}

std::string phase_line(const std::string& block, int column, const std::string& style) {
  constexpr double most = 135.0;
  return fmt::format(
      "last = NaN, ${0} using 1:(step = column({1}) - last, last = column({1}), "
      "abs(step) > {2} ? NaN : last) with lines {3}",
      block, column, most, style);
}

double continued(double angle, double last, double turn) {
  return angle + turn * std::round((last - angle) / turn);
}

}  // namespace hydrapod::report
