/// Heat map of a value over two inputs, with labelled contours.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "gnuplot.hpp"
#include "hydrapod/report/model_results.hpp"
#include "prefix.hpp"

namespace hydrapod::report {

namespace {

constexpr int width = 860, height = 720;                                 // [pixels]
constexpr double left = 95.0, right = 714.0, top = 88.0, bottom = 66.0;  // of the frame [pixels]

struct Point {
  double x, y;
};

/// Where cells end: in the middle between neighbours, and as far beyond the first and the last.
std::vector<double> edges_of(const std::vector<double>& at) {
  if (at.size() == 1) return {at[0] - 0.5, at[0] + 0.5};
  std::vector<double> edges{at[0] - 0.5 * (at[1] - at[0])};
  for (std::size_t k = 1; k < at.size(); ++k) edges.push_back(0.5 * (at[k - 1] + at[k]));
  edges.push_back(at.back() + 0.5 * (at.back() - at[at.size() - 2]));
  return edges;
}

/// Are they as far from each other as pictures of equal cells have them?
bool are_even(const std::vector<double>& at) {
  constexpr double rounding = 1e-6;  // of a cell
  for (std::size_t k = 1; k + 1 < at.size(); ++k)
    if (std::abs(at[k + 1] - 2.0 * at[k] + at[k - 1]) > rounding * std::abs(at[1] - at[0]))
      return false;
  return true;
}

/// A field in its frame.
struct Frame {
  const Field& field;
  std::vector<double> x_edges, y_edges;

  explicit Frame(const Field& of) : field(of), x_edges(edges_of(of.x)), y_edges(edges_of(of.y)) {}
  /// [pixels] from the upper left of the picture.
  [[nodiscard]] Point at(double x, double y) const {
    const double across = (x - x_edges.front()) / (x_edges.back() - x_edges.front());
    const double up = (y - y_edges.front()) / (y_edges.back() - y_edges.front());
    return {left + across * (right - left), height - bottom - up * (height - bottom - top)};
  }
};

/// Round numbers between the least and the largest value, at most eight.
std::vector<double> levels_of(const std::vector<double>& values) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const double value : values)
    if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
  if (!(high > low)) return {};
  constexpr double most = 8.0;
  const double power = std::pow(10.0, std::floor(std::log10((high - low) / most)));
  const double steps = (high - low) / (most * power);  // 1 … 10
  const double step = power * (steps <= 1.0 ? 1.0 : steps <= 2.0 ? 2.0 : steps <= 5.0 ? 5.0 : 10.0);
  std::vector<double> levels;
  for (double k = std::floor(low / step) + 1.0; k * step < high; ++k) levels.push_back(k * step);
  return levels;
}

/// Where the contour of `level` of `values` crosses the lines between neighbouring points.
std::vector<Point> crossings(const Frame& frame, const std::vector<double>& values, double level) {
  const auto &x = frame.field.x, &y = frame.field.y;
  std::vector<Point> found;
  const auto between = [&](std::size_t i, std::size_t j, std::size_t k, std::size_t l) {
    const double a = values[i * y.size() + j], b = values[k * y.size() + l];
    if (!std::isfinite(a) || !std::isfinite(b) || (a < level) == (b < level)) return;
    const double t = (level - a) / (b - a);
    found.push_back(frame.at(x[i] + t * (x[k] - x[i]), y[j] + t * (y[l] - y[j])));
  };
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = 0; j < y.size(); ++j) {
      if (i + 1 < x.size()) between(i, j, i + 1, j);
      if (j + 1 < y.size()) between(i, j, i, j + 1);
    }
  return found;
}

/// Which lines pass where, in squares of a few pixels.
class Occupied {
 public:
  void add(std::size_t line, const Point& at) { squares_[square(at)].insert(line); }

  /// Number of other lines below a label that stands at `at`.
  [[nodiscard]] int others(std::size_t line, const Point& at) const {
    constexpr int across = 3, up = 2;
    const auto [column, row] = square(at);
    std::set<std::size_t> lines;
    for (int i = -across; i <= across; ++i)
      for (int j = -up; j <= up; ++j)
        if (const auto found = squares_.find({column + i, row + j}); found != squares_.end())
          lines.insert(found->second.begin(), found->second.end());
    lines.erase(line);
    return static_cast<int>(lines.size());
  }

 private:
  static std::pair<int, int> square(const Point& at) {
    constexpr double side = 6.0;
    return {static_cast<int>(at.x / side), static_cast<int>(at.y / side)};
  }
  std::map<std::pair<int, int>, std::set<std::size_t>> squares_{};
};

/// A number on a contour.
struct ContourLabel {
  Point at;
  double level;
};

/// Labels that do not touch each other: the first of a contour where the fewest other contours
/// pass, further ones where none does.
class Labels {
 public:
  void add(double level, std::size_t line, const std::vector<Point>& along,
           const Occupied& occupied) {
    constexpr int most = 3;
    for (int k = 0; k < most; ++k) {
      const Point* best = nullptr;
      int fewest = 0;
      double farthest = 0.0;
      for (const auto& at : along) {
        const double apart = free_distance(level, at);
        const int others = occupied.others(line, at);
        if (apart <= 0.0 || (k > 0 && others > 0)) continue;
        if (best != nullptr && std::pair(-others, apart) <= std::pair(-fewest, farthest)) continue;
        best = &at;
        fewest = others;
        farthest = apart;
      }
      if (best == nullptr) return;
      placed_.push_back({*best, level});
    }
  }
  [[nodiscard]] const std::vector<ContourLabel>& placed() const { return placed_; }

 private:
  /// Distance to the nearest label [pixels], at most a long one; 0 where there is no room.
  [[nodiscard]] double free_distance(double level, const Point& at) const {
    constexpr double across = 46.0, up = 22.0, edge = 22.0, same = 200.0, far = 300.0;
    if (at.x < left + edge || at.x > right - edge || at.y < top + 0.5 * edge ||
        at.y > height - bottom - 0.5 * edge)
      return 0.0;
    double nearest = far;
    for (const auto& other : placed_) {
      const double x = std::abs(other.at.x - at.x), y = std::abs(other.at.y - at.y);
      const double apart = std::hypot(x, y);
      if ((x < across && y < up) || (other.level == level && apart < same)) return 0.0;
      nearest = std::min(nearest, apart);
    }
    return nearest;
  }
  std::vector<ContourLabel> placed_{};
};

std::string label_commands(const Frame& frame, const std::vector<double>& levels) {
  std::vector<std::vector<Point>> lines;
  Occupied occupied;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    lines.push_back(crossings(frame, frame.field.values, levels[k]));
    for (const auto& at : lines.back()) occupied.add(k, at);
  }
  std::vector<std::size_t> order(levels.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return lines[k].size(); });
  Labels labels;
  for (const std::size_t k : order) labels.add(levels[k], k, lines[k], occupied);
  std::string text =
      "set style textbox 3 opaque noborder fillcolor rgb '#ffffff' margins 0.4,0.3\n";
  for (const auto& label : labels.placed())
    text += fmt::format(
        "set label '{:.4g}' at screen {:.5f},{:.5f} center front boxed bs 3 font ',8' "
        "tc rgb '#1a1a1a'\n",
        label.level, label.at.x / width, 1.0 - label.at.y / height);
  return text;
}

/// `values` of the field in the block `$name`.
std::string block_of_values(const std::string& name, const Field& field,
                            const std::vector<double>& values) {
  std::string rows;
  for (std::size_t i = 0; i < field.x.size(); ++i) {
    for (std::size_t j = 0; j < field.y.size(); ++j) {
      const double value = values[i * field.y.size() + j];
      rows += fmt::format("{:.9g} {:.9g} {}\n", field.x[i], field.y[j],
                          std::isfinite(value) ? fmt::format("{:.9g}", value) : "NaN");
    }
    rows += '\n';
  }
  return block_of(name, rows);
}

/// Cells that have a value, in the block `$cells`: place, edges, value.
std::string block_of_cells(const Frame& frame) {
  const auto& field = frame.field;
  std::string rows;
  for (std::size_t i = 0; i < field.x.size(); ++i)
    for (std::size_t j = 0; j < field.y.size(); ++j)
      if (const double value = field.values[i * field.y.size() + j]; std::isfinite(value))
        rows += fmt::format("{:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n", field.x[i],
                            field.y[j], frame.x_edges[i], frame.x_edges[i + 1], frame.y_edges[j],
                            frame.y_edges[j + 1], value);
  return block_of("cells", rows);
}

/// Contours of `levels` of the block `$of` in the block `$name`.
std::string contour_table(const std::string& name, const std::vector<double>& levels,
                          const std::string& of = "field") {
  return fmt::format(
      "set cntrparam levels discrete {:.9g}\nset table ${}\nsplot ${} using 1:2:3\nunset "
      "table\n",
      fmt::join(levels, ", "), name, of);
}

/// With ascending x and y: lists may have any order.
Field in_order(const Field& given) {
  const auto order_of = [](const std::vector<double>& at) {
    std::vector<std::size_t> order(at.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t k) { return at[k]; });
    return order;
  };
  const auto of_x = order_of(given.x), of_y = order_of(given.y);
  Field field = given;
  for (std::size_t i = 0; i < of_x.size(); ++i) {
    field.x[i] = given.x[of_x[i]];
    for (std::size_t j = 0; j < of_y.size(); ++j) {
      const auto to = i * of_y.size() + j, from = of_x[i] * of_y.size() + of_y[j];
      field.y[j] = given.y[of_y[j]];
      field.values[to] = given.values[from];
      if (!given.stroke_left.empty()) field.stroke_left[to] = given.stroke_left[from];
    }
  }
  return field;
}

/// Its values and bound in a unit that fits them.
Field in_shown_unit(Field field) {
  if (field.unit.empty()) return field;
  double largest = 0.0;
  for (const double value : field.values)
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  const auto unit = shown_unit(field.unit, largest);
  field.name += " [" + unit.name + "]";
  for (double& value : field.values) value /= unit.size;
  if (field.bound) *field.bound /= unit.size;
  return field;
}

}  // namespace

void plot_field(const Field& given, const std::string& title, const std::string& subtitle,
                const std::string& path) {
  const Field field = in_shown_unit(in_order(given));
  const Frame frame(field);
  const bool even = are_even(field.x) && are_even(field.y);
  const auto levels = levels_of(field.values);
  const bool bounded = field.bound && !crossings(frame, field.values, *field.bound).empty();
  const bool ends = !field.stroke_left.empty() && !crossings(frame, field.stroke_left, 0.0).empty();
  std::string script =
      titles(title, subtitle, width, height) + thin_axes + key_below_titles(height) +
      block_of_values("field", field, field.values) + (even ? "" : block_of_cells(frame)) +
      (ends ? block_of_values("stroke", field, field.stroke_left) : "") +
      "set contour base\nunset surface\n" + (levels.empty() ? "" : contour_table("lines", levels)) +
      (bounded ? contour_table("bound", {*field.bound}) : "") +
      (ends ? contour_table("end", {0.0}, "stroke") : "") + "set surface\nunset contour\n" +
      at_screen({left / width, right / width, 1.0 - top / height, bottom / height});
  script += fmt::format(
      "set xlabel {}\nset ylabel {}\nset cblabel {}\nset xrange [{:.9g}:{:.9g}]\n"
      "set yrange [{:.9g}:{:.9g}]\n",
      quoted(field.x_name), quoted(field.y_name), quoted(field.name), frame.x_edges.front(),
      frame.x_edges.back(), frame.y_edges.front(), frame.y_edges.back());
  script +=
      "set object 1 rectangle from graph 0,0 to graph 1,1 behind fc rgb '#bbbbbb' fs solid "
      "noborder\n"
      "set palette defined (0 '#0d0887', 0.35 '#9c179e', 0.7 '#ed7953', 1 '#f0f921')\n" +
      label_commands(frame, levels);
  // of cells side by side the background shows through their smoothed edges: drawn again, it
  // does not; the SVG has sharp edges
  const int times = path.ends_with(".svg") ? 1 : 3;
  script += "plot ";
  for (int k = 0; k < times; ++k)
    script += even
                  ? "$field using 1:2:3 with image pixels notitle, "
                  : "$cells using 1:2:3:4:5:6:7 with boxxyerror fillstyle solid noborder linecolor "
                    "palette notitle, ";
  if (!levels.empty())
    script +=
        "$lines using 1:2 with lines lw 2.2 lc rgb '#604020' notitle, "
        "$lines using 1:2 with lines lw 1.1 lc rgb '#ffffff' notitle, ";
  if (bounded)
    script += fmt::format("$bound using 1:2 with lines lw 2.6 lc rgb '#000000' title {}, ",
                          quoted("bound of " + field.bound_text));
  if (ends)
    script += fmt::format("$end using 1:2 with lines lw 2.6 dt (9,5) lc rgb '#00a0a0' title {}, ",
                          quoted("end of stroke"));
  draw(path, width, height, script + "NaN notitle\n");
}

}  // namespace hydrapod::report
