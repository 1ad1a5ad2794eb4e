#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <limits>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "gnuplot.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "hydrapod/report/measured_results.hpp"

namespace hydrapod::report {

namespace {

using base::two_pi;
constexpr double half_interval = numerics::normal_half_width;

constexpr std::array thing_colours{"#0072b2", "#d55e00", "#009e73",
                                   "#cc79a7", "#56b4e9", "#e69f00"};
const char* colour(std::size_t thing) { return thing_colours[thing % thing_colours.size()]; }

std::string letter(std::size_t thing) {
  return std::string(1, static_cast<char>('A' + thing % 26));
}

/// Modes of the first thing with a partner in any other.
std::vector<int> paired_modes(const SideBySide& result) {
  std::set<int> modes;
  for (const auto& c : result.comparisons)
    for (const auto& pair : c.pairs) modes.insert(pair.first);
  return {modes.begin(), modes.end()};
}

/// A difference and half its interval, and where it stands.
struct Bar {
  double value, half, place{};
};

/// Differences of the frequencies [%] or of the damping ratios [percentage points].
std::vector<Bar> bars_of(const SideBySide& result, const ThingComparison& c,
                         const std::vector<int>& modes, bool of_frequencies) {
  std::vector<Bar> bars;
  const auto things = static_cast<double>(result.things.size());
  for (const auto& pair : c.pairs) {
    const auto place = std::ranges::find(modes, pair.first) - modes.begin() + 1;
    const double omega = result.things.front().modes[static_cast<std::size_t>(pair.first)].omega;
    const auto& difference = of_frequencies ? pair.frequency : pair.damping;
    const double scale = 100.0 / (of_frequencies ? omega : 1.0);
    bars.push_back({scale * difference.value,
                    scale * half_interval * difference.deviation.value_or(0.0),
                    static_cast<double>(place) + 0.6 * (c.thing - 0.5 * things) / things});
  }
  return bars;
}

/// Columns: place, difference of the frequency and half its interval, of the damping ratio.
std::string difference_rows(const SideBySide& result, const ThingComparison& c,
                            const std::vector<int>& modes) {
  std::string rows;
  const auto frequencies = bars_of(result, c, modes, true);
  const auto dampings = bars_of(result, c, modes, false);
  for (std::size_t k = 0; k < frequencies.size(); ++k)
    rows +=
        fmt::format("{:.4f} {:.9g} {:.9g} {:.9g} {:.9g}\n", frequencies[k].place,
                    frequencies[k].value, frequencies[k].half, dampings[k].value, dampings[k].half);
  return block_of(fmt::format("d{}", c.thing), rows);
}

/// Range of the differences. A bar far longer than most is of a mode that is hardly determined; it
/// leaves the frame, since all others would be points on a line beside it.
std::pair<double, double> shown_range(std::vector<Bar> bars) {
  constexpr double far = 5.0;
  if (bars.empty()) return {-1.0, 1.0};
  std::ranges::sort(bars, {}, &Bar::half);
  const double usual = bars[bars.size() / 2].half;
  double low = 0.0, high = 0.0;
  for (const auto& bar : bars) {
    const double half = usual > 0.0 && bar.half > far * usual ? 0.0 : bar.half;
    low = std::min(low, bar.value - half);
    high = std::max(high, bar.value + half);
  }
  const double room = high > low ? 0.1 * (high - low) : 1.0;
  return {low - room, high + 2.5 * room};  // the legend is at the top
}

/// Arrow heads with half the interval, at the edges that a bar crosses.
std::string beyond_marks(const std::vector<Bar>& bars, double low, double high,
                         const char* colour) {
  std::string text;
  const double room = 0.03 * (high - low);
  for (const auto& bar : bars) {
    const auto mark = [&](double at, int point, double aside) {
      text += fmt::format(
          "set label {} at {:.4f},{:.6g} left point pt {} ps 1.2 lc rgb '{}' offset 0.7,{} front "
          "font ',8' tc rgb '{}'\n",
          quoted(fmt::format("±{:.3g}", bar.half)), bar.place, at, point, colour, aside, colour);
    };
    if (bar.value + bar.half > high) mark(high - room, 9, -0.3);
    if (bar.value - bar.half < low) mark(low + room, 11, 0.3);
  }
  return text;
}

/// Labels of titles() are drawn by every plot of a page: from the second on they would look bold.
constexpr const char* titles_drawn = "unset label 101\nunset label 102\n";

std::string difference_panel(const SideBySide& result, const std::vector<int>& modes, int column,
                             const char* title, const Cell& cell) {
  std::vector<std::string> names;
  for (const int k : modes)
    names.push_back(fmt::format(
        "{:.4g} Hz", result.things.front().modes[static_cast<std::size_t>(k)].omega / two_pi));
  const bool of_frequencies = column == 2;
  std::vector<Bar> bars;
  for (const auto& c : result.comparisons)
    std::ranges::copy(bars_of(result, c, modes, of_frequencies), std::back_inserter(bars));
  const auto [low, high] = shown_range(std::move(bars));
  std::string beyond;
  for (const auto& c : result.comparisons)
    beyond += beyond_marks(bars_of(result, c, modes, of_frequencies), low, high,
                           colour(static_cast<std::size_t>(c.thing)));
  std::string script = at_screen(cell) +
                       fmt::format(
                           "unset logscale x\nset format x '%g'\nset xrange [0.4:{}.6]\n"
                           "set yrange [{:.6g}:{:.6g}]\nset ytics autofreq\n",
                           modes.size(), low, high) +
                       named_tics('x', names);
  script += fmt::format(
      "set xtics rotate by 40 right\nset title {} offset 0,-0.5\nset xlabel ''\n"
      "set ylabel ''\nset xzeroaxis lt 1 lc rgb '#888888'\nplot ",
      quoted(std::string(title) + (beyond.empty() ? "" : " (▲▼ beyond the frame)")));
  script.insert(script.rfind("plot "), beyond);
  for (std::size_t k = 0; k < result.comparisons.size(); ++k) {
    const auto& c = result.comparisons[k];
    script += fmt::format(
        "{}$d{} using 1:{}:{} with yerrorbars lw 2 pt 7 ps 0.9 lc rgb '{}' title {}",
        k == 0 ? "" : ", ", c.thing, column, column + 1, colour(static_cast<std::size_t>(c.thing)),
        quoted(fmt::format("{} − A", letter(static_cast<std::size_t>(c.thing)))));
  }
  return script + "\nset autoscale y\nunset label\n";
}

/// Names of responses that two things have, in the order of the first thing that has them.
std::vector<std::string> shared_names(const SideBySide& result) {
  constexpr std::size_t most = 6;
  std::vector<std::string> names;
  for (const auto& thing : result.things)
    for (const auto& response : thing.responses)
      if (std::ranges::find(names, response.name) == names.end() && names.size() < most)
        names.push_back(response.name);
  return names;
}

/// What is shown of responses [Hz]: lines far above the modes hold noise alone.
double highest_shown(const SideBySide& result) {
  constexpr double room = 1.5;
  double highest = 0.0;
  for (const auto& thing : result.things)
    for (const auto& mode : thing.modes) highest = std::max(highest, mode.omega / two_pi);
  return highest > 0.0 ? room * highest : std::numeric_limits<double>::infinity();
}

double degrees_of(const std::complex<double>& H) { return std::arg(H) * 180.0 / std::numbers::pi; }

bool is_shown(const ComparedThing::Response& response, std::size_t line, double highest) {
  return response.frequency[line] > 0.0 && response.frequency[line] <= highest;
}

std::string response_rows(const ComparedThing::Response& response, double highest, double cut) {
  std::string rows;
  for (std::size_t k = 0; k < response.H.size(); ++k)
    if (is_shown(response, k, highest))
      rows += fmt::format("{:.9g} {:.6f} {:.4f}\n", response.frequency[k],
                          level_db(std::abs(response.H[k])),
                          within_turn(degrees_of(response.H[k]), cut));
  return rows;
}

/// One for all things: what lies side by side is drawn side by side.
double common_cut(const SideBySide& result, const std::string& name, double highest) {
  std::vector<double> phases;
  for (const auto& thing : result.things)
    for (const auto& response : thing.responses)
      for (std::size_t k = 0; response.name == name && k < response.H.size(); ++k)
        if (is_shown(response, k, highest)) phases.push_back(degrees_of(response.H[k]));
  return phase_cut(phases);
}

/// One response of all things that have it, one over the other.
std::string overlay(const SideBySide& result, const std::string& name, std::size_t number,
                    const CellPair& cells) {
  std::string blocks, magnitudes, phases, unit;
  const double highest = highest_shown(result), cut = common_cut(result, name, highest);
  double from = std::numeric_limits<double>::infinity(), to = 0.0;
  for (std::size_t t = 0; t < result.things.size(); ++t)
    for (const auto& response : result.things[t].responses) {
      if (response.name != name || response.frequency.empty()) continue;
      unit = response.unit;
      for (const double f : response.frequency)
        if (f > 0.0) from = std::min(from, f);
      to = std::max(to, std::min(highest, response.frequency.back()));
      const std::string block = fmt::format("r{}_{}", number, t);
      blocks += block_of(block, response_rows(response, highest, cut));
      const std::string line =
          fmt::format("lw 2{} lc rgb '{}'", t == 0 ? "" : " dt (8,4)", colour(t));
      const char* comma = magnitudes.empty() ? "" : ", ";
      magnitudes += fmt::format("{}${} using 1:2 with lines {} title {}", comma, block, line,
                                quoted(letter(t)));
      phases += comma + phase_line(block, 3, line + " notitle");
    }
  if (magnitudes.empty()) return {};
  std::string script = blocks + "unset xzeroaxis\nset xtics norotate\n" +
                       logarithmic_axis(from, to) + at_screen(cells.magnitude);
  script += fmt::format(
      "set title {} offset 0,-0.6\nset ylabel {} offset 1.2,0\nset format x ''\nset xlabel ''\n"
      "set ytics autofreq\nset autoscale y\nplot {}\n",
      quoted(name), quoted("dB re 1 " + unit), magnitudes);
  script += std::string(titles_drawn) + "unset title\n" + at_screen(cells.phase);
  script += fmt::format(
      "set format x '%g'\nset xlabel 'Hz' offset 0,0.6\nset ylabel 'phase °' offset 1.2,0\n"
      "set ytics 90\nset autoscale yfix\nset offsets 0,0,10,10\nplot {}\n"
      "unset offsets\nset autoscale y\n",
      phases);
  return script + titles_drawn;
}

}  // namespace

void plot_side_by_side(const SideBySide& result, const std::string& path) {
  const auto modes = paired_modes(result);
  const auto names = shared_names(result);
  const std::size_t differences = modes.empty() ? 0 : 2;
  if (differences + names.size() == 0)
    base::refuse(path, "there is nothing to draw: no mode has a partner and no response is shared");
  const CellGrid cells(differences + names.size());
  std::string subtitle;
  for (std::size_t t = 0; t < result.things.size(); ++t)
    subtitle += fmt::format("{}{}: {}", t == 0 ? "" : "   ", letter(t), result.things[t].name);
  const bool intervals = std::ranges::any_of(result.comparisons, [](const auto& comparison) {
    return std::ranges::any_of(
        comparison.pairs, [](const auto& pair) { return pair.frequency.deviation.has_value(); });
  });
  std::string script = "set multiplot\n" + std::string(thin_grid) + thin_axes +
                       titles(intervals ? "Side by side, 95 % intervals" : "Side by side", subtitle,
                              cells.width(), cells.height());
  script += "set key top right font ',9'\n";
  for (const auto& c : result.comparisons) script += difference_rows(result, c, modes);
  if (differences > 0) {
    Cell first = cells[0], second = cells[1];
    const double label = 24.0 / cells.height();  // tics are written aslant
    first.bottom += label;
    second.bottom += label;
    script += difference_panel(result, modes, 2, "frequency, % of A, by mode of A", first);
    script += difference_panel(result, modes, 4, "damping ratio, % points, by mode of A", second);
  }
  for (std::size_t k = 0; k < names.size(); ++k)
    script += (k == 0 ? key_below_titles(cells.height()) : "unset key\n") +
              overlay(result, names[k], k, split(cells[differences + k], cells.height()));
  draw(path, cells.width(), cells.height(), script + "unset multiplot\n");
}

}  // namespace hydrapod::report
