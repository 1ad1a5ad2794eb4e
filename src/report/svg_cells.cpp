/// Heat maps in SVG: gnuplot writes a polygon of a hundred bytes for every cell.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "gnuplot.hpp"

namespace hydrapod::report {

namespace {

struct Rectangle {
  double left, right, top, bottom;
};

struct MapCell {
  std::string colour;
  Rectangle at;
};

/// The numbers in a text; none where there are not exactly `Count` of them.
template <std::size_t Count>
std::optional<std::array<double, Count>> numbers_in(std::string_view text) {
  std::array<double, Count> numbers{};
  std::size_t found = 0;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end) {
    if ((*at < '0' || *at > '9') && *at != '-') {
      ++at;
      continue;
    }
    double value{};
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc{} || found == Count) return std::nullopt;
    numbers[found++] = value;
    at = next;
  }
  return found == Count ? std::optional(numbers) : std::nullopt;
}

/// A line with a filled polygon that is an upright rectangle.
std::optional<MapCell> cell_in(std::string_view line) {
  constexpr std::string_view begin = "<polygon fill = 'rgb(";
  const auto start = line.find_first_not_of("\t ");
  if (start == std::string_view::npos || !line.substr(start).starts_with(begin))
    return std::nullopt;
  const auto numbers = numbers_in<11>(line);  // three of the colour, four corners
  if (!numbers) return std::nullopt;
  const auto& n = *numbers;
  const auto x = [&](std::size_t corner) { return n[3 + 2 * corner]; };
  const auto y = [&](std::size_t corner) { return n[4 + 2 * corner]; };
  const bool first_along_x = y(0) == y(1);
  const bool upright = first_along_x ? y(2) == y(3) && x(1) == x(2) && x(0) == x(3)
                                     : x(0) == x(1) && x(2) == x(3) && y(1) == y(2) && y(0) == y(3);
  if (!upright) return std::nullopt;
  return MapCell{
      fmt::format("#{:02x}{:02x}{:02x}", static_cast<int>(n[0]), static_cast<int>(n[1]),
                  static_cast<int>(n[2])),
      {std::min(x(0), x(2)), std::max(x(0), x(2)), std::min(y(0), y(2)), std::max(y(0), y(2))}};
}

/// Cells in a row of the file; those of one colour that touch along y become one.
class Cells {
 public:
  void add(MapCell cell) {
    if (last_ && last_->colour == cell.colour && last_->at.left == cell.at.left &&
        last_->at.right == cell.at.right &&
        (last_->at.top == cell.at.bottom || last_->at.bottom == cell.at.top)) {
      last_->at.top = std::min(last_->at.top, cell.at.top);
      last_->at.bottom = std::max(last_->at.bottom, cell.at.bottom);
      return;
    }
    keep();
    last_ = std::move(cell);
  }

  /// One path per colour; nothing is left.
  std::string take() {
    keep();
    std::string text;
    for (const auto& [colour, outline] : paths_)
      text +=
          fmt::format("<path shape-rendering='crispEdges' fill='{}' d='{}'/>\n", colour, outline);
    paths_.clear();
    return text;
  }

 private:
  void keep() {
    if (!last_) return;
    const auto& r = last_->at;
    paths_[last_->colour] += fmt::format("M{:.6g} {:.6g}H{:.6g}V{:.6g}H{:.6g}z", r.left, r.top,
                                         r.right, r.bottom, r.left);
    last_.reset();
  }

  std::optional<MapCell> last_{};
  std::map<std::string, std::string> paths_{};
};

}  // namespace

std::string joined_cells(std::string_view svg) {
  std::string text;
  Cells cells;
  while (!svg.empty()) {
    const auto end = svg.find('\n');
    const auto line = svg.substr(0, end);
    svg.remove_prefix(end == std::string_view::npos ? svg.size() : end + 1);
    if (auto cell = cell_in(line)) {
      cells.add(std::move(*cell));
      continue;
    }
    text += cells.take();
    text += line;
    text += '\n';
  }
  return text + cells.take();
}

}  // namespace hydrapod::report
