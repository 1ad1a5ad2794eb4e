#pragma once
/// Running gnuplot, and what its scripts have in common. Private to the module.

#include <Eigen/Core>
#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace hydrapod::report {

/// `text` as a gnuplot string; line ends in it, which would end the command, become blanks.
std::string quoted(const std::string& text);

/// Makes the script for a gnuplot terminal and an output file.
using Script = std::function<std::string(const std::string& terminal, const std::string& file)>;

/// Draws a picture of `width` × `height` pixels; its format follows from the ending of `path`
/// (.svg, .png, .pdf). The file is written whole or not at all. Throws base::InputError for another
/// ending or a folder that is not there, base::ComputationError when gnuplot is missing or fails.
void draw(const std::string& path, int width, int height, const Script& script);
/// With opened() and the end around `body`.
void draw(const std::string& path, int width, int height, const std::string& body);

/// `picture`, the bytes of a file `path` (.svg, .png, .pdf), with what state_in_pictures() asked
/// for.
std::string with_origin(std::string picture, std::string_view path);

/// How a script begins: plots to `file`, texts as they are.
std::string opened(const std::string& terminal, const std::string& file);

inline constexpr const char* thin_axes = "set tics font ',9'\nset border lw 0.8 lc rgb '#444444'\n";
inline constexpr const char* thin_grid = "set grid xtics ytics back lt 1 lc rgb '#d0d0d0' lw 0.5\n";

/// Title and subtitle at the top of a picture [pixels], as labels 101 and 102. A long subtitle has
/// two lines.
std::string titles(const std::string& title, const std::string& subtitle, int width, int height);
/// The legend of all plots of a grid, in a line below the titles.
std::string key_below_titles(int height);

/// Edges of a plot in the picture, 0 … 1 from the lower left.
struct Cell {
  double left, right, top, bottom;
};
std::string at_screen(const Cell& cell);

/// Magnitude above phase, with room for the lowest and the highest label between them.
struct CellPair {
  Cell magnitude, phase;
};
CellPair split(const Cell& cell, int height);

/// Plots side by side, at most three in a row, below the titles.
struct CellGrid {
  int columns, rows;
  explicit CellGrid(std::size_t cells);
  /// [pixels]; the subtitle has room.
  [[nodiscard]] int width() const { return columns == 1 ? 760 : 420 * columns + 40; }
  [[nodiscard]] int height() const { return 400 * rows + top_band; }
  static constexpr int top_band = 88;  ///< of titles and legend
  [[nodiscard]] Cell operator[](std::size_t index) const;
};

/// A logarithmic axis x over `from` … `to` with four labels or more: 1, 2, 5 times
/// powers of ten, the powers alone in a wide band, numbers closer together in a narrow one.
std::string logarithmic_axis(double from, double to);

/// Numbers of the values of `at`, which ascend, at which stretches of an axis begin, and the number
/// of values at the end: at most `most` stretches, equally wide on a linear or logarithmic axis.
/// Curves with more lines than pixels look the same with the extremes of each stretch alone.
std::vector<std::size_t> stretches_of(const std::vector<double>& at, bool logarithmic, int most);

/// An SVG of gnuplot in which the rectangles of a heat map, one polygon each, are one path per
/// colour, those side by side in one: a tenth of the size, and no seams between cells.
std::string joined_cells(std::string_view svg);

/// The data `$name`; every line of `rows` has its end.
std::string block_of(const std::string& name, const std::string& rows);
/// Lines of column, row and value, both numbered from `first`.
std::string matrix_rows(const Eigen::MatrixXd& values, int first);

/// `names` along the axis x or y at `first` and the following whole numbers.
std::string named_tics(char axis, const std::vector<std::string>& names, int first = 1);

/// A plot of six lines over column 1 of `$name`, from column `first` on, every `step` columns, in
/// colours that are told apart by the colour-blind as well. `directions`: of y and ry the lines are
/// dashed, since in a symmetric machine those of x and rx lie below them.
std::string six_lines(const char* name, int first, int step, double width,
                      const std::array<std::string, 6>& names, bool directions = false);

/// Where phases [°] are cut: the angle `from` in (−360°, 0°] for which they lie in from … from +
/// 360° with the most room at both ends. Measured curves are not made continuous: noise would turn
/// them.
double phase_cut(const std::vector<double>& degrees);
/// `angle` plus the whole turns that bring it between `from` and `from` + 360°.
double within_turn(double angle, double from);
/// Column `column` of `$block` over the first one as a line with gaps where it steps by more than a
/// phase does from line to line: at the cut, and in noise.
std::string phase_line(const std::string& block, int column, const std::string& style);

/// 20 lg |H|, also of what vanishes.
double level_db(double magnitude);
/// `angle` plus the whole turns that bring it nearest to `last`, so that curves do not jump.
double continued(double angle, double last, double turn = 360.0);

}  // namespace hydrapod::report
