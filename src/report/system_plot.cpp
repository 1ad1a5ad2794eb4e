#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "gnuplot.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/report/model_results.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::report {

namespace {

using base::two_pi;

/// The part of the plane around the oscillations of mechanics and oil: those of valves, delay and
/// lines lie so far out that they would squeeze the rest.
std::array<double, 4> shown_plane(const RootLocus& locus) {
  double left = 0.0, right = 0.0, top = 0.0;
  for (const auto& poles : locus.poles)
    for (const auto& pole : poles.poles) {
      const double far_out = pole.parts[static_cast<std::size_t>(simulation::Part::valve)] +
                             pole.parts[static_cast<std::size_t>(simulation::Part::delay)] +
                             pole.parts[static_cast<std::size_t>(simulation::Part::line)];
      if (!pole.oscillates() || far_out > 0.5) continue;
      left = std::min(left, pole.pole.real());
      right = std::max(right, pole.pole.real());
      top = std::max(top, pole.pole.imag());
    }
  const double width = std::max(right - left, 1.0);
  return {left - 0.08 * width, right + 0.08 * width, -0.03 * top, std::max(1.06 * top, 1.0)};
}

/// Part of the complex plane that is shown.
struct Plane {
  double left, right, bottom, top;
  /// Distance in shares of the picture.
  [[nodiscard]] double apart(std::complex<double> a, std::complex<double> b) const {
    return std::hypot((a.real() - b.real()) / (right - left),
                      (a.imag() - b.imag()) / (top - bottom));
  }
  [[nodiscard]] bool holds(std::complex<double> s) const {
    return s.real() > left && s.real() < right && s.imag() > bottom && s.imag() < top;
  }
};

/// Rays of equal damping ratio from the origin to the edge of the plane, with their labels.
std::string damping_rays(const Plane& plane) {
  constexpr std::array ratios{0.01, 0.02, 0.05, 0.1, 0.2, 0.5};
  constexpr double near = 0.07;  // shares of the picture: labels would overlap
  std::string text = "set style textbox opaque noborder fillcolor rgb '#ffffff' margins 0.5,0.5\n";
  std::complex<double> last{0.0, plane.top};
  for (const double ratio : ratios) {
    const std::complex<double> direction{-ratio, std::sqrt(1.0 - ratio * ratio)};
    const auto end =
        direction * std::min(plane.left / direction.real(), plane.top / direction.imag());
    if (plane.apart(end, last) < near) continue;
    last = end;
    const bool at_top = end.imag() > (1.0 - 1e-9) * plane.top;
    text += fmt::format(
        "set arrow from 0,0 to {0:.6g},{1:.6g} nohead back lw 0.8 dt 2 lc rgb '#9a9a9a'\n"
        "set label '{2:g} %' at {0:.6g},{1:.6g} {3} offset {4} font ',9' tc rgb '#5a5a5a' front "
        "boxed\n",
        end.real(), end.imag(), 100.0 * ratio, at_top ? "center" : "left",
        at_top ? "0,-1.1" : "1.4,1.0");
  }
  return text;
}

/// A branch on its way from value to value.
struct Tip {
  std::complex<double> at{}, step{};            ///< and how far it went last
  std::optional<std::complex<double>> arrow{};  ///< where one begins that is too short as yet
};

/// Which pole of `next` each tip goes on to: the nearest to where it is heading, the surest pairs
/// first; −1 where a branch ends. Branches that cross are not confused.
std::vector<int> followed(const std::vector<Tip>& tips, const simulation::SystemPoles& next,
                          const Plane& plane) {
  constexpr double far = 0.15;  // of the picture in one step
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t a = 0; a < tips.size(); ++a)
    for (std::size_t b = 0; b < next.poles.size(); ++b)
      if (const double apart = plane.apart(tips[a].at + tips[a].step, next.poles[b].pole);
          apart < far)
        pairs.emplace_back(apart, a, b);
  std::ranges::sort(pairs);
  std::vector<int> to(tips.size(), -1);
  std::vector<bool> taken(next.poles.size());
  for (const auto& [apart, a, b] : pairs) {
    if (to[a] >= 0 || taken[b]) continue;
    to[a] = static_cast<int>(b);
    taken[b] = true;
  }
  return to;
}

/// Lines between the poles of successive values, and an arrow in the middle of each branch that is
/// long enough.
std::string branches(const RootLocus& locus, const Plane& plane, std::string& rows) {
  constexpr double long_enough = 0.025;  // of the picture: an arrow is seen
  std::string arrows;
  if (locus.poles.empty()) return arrows;
  const std::size_t middle = (locus.poles.size() - 1) / 2;
  std::vector<Tip> tips;
  for (const auto& pole : locus.poles.front().poles) tips.push_back({.at = pole.pole});
  for (std::size_t k = 0; k + 1 < locus.poles.size(); ++k) {
    const auto& next = locus.poles[k + 1].poles;
    std::vector<Tip> moved;
    for (const auto& pole : next) moved.push_back({.at = pole.pole});
    const auto to = followed(tips, locus.poles[k + 1], plane);
    for (std::size_t a = 0; a < tips.size(); ++a) {
      if (to[a] < 0) continue;
      const auto from = tips[a].at;
      auto& tip = moved[static_cast<std::size_t>(to[a])];
      tip.step = tip.at - from;
      if (!plane.holds(from)) continue;
      rows += fmt::format("{:.9g} {:.9g}\n{:.9g} {:.9g}\n\n", from.real(), from.imag(),
                          tip.at.real(), tip.at.imag());
      tip.arrow = k == middle ? from : tips[a].arrow;
      if (!tip.arrow || plane.apart(*tip.arrow, tip.at) < long_enough) continue;
      const bool halfway = plane.apart(from, tip.at) > 2.0 * long_enough;
      const auto end = halfway ? 0.5 * (from + tip.at) : tip.at;
      arrows += fmt::format(
          "set arrow from {:.9g},{:.9g} to {:.9g},{:.9g} head filled size screen 0.012,22 front "
          "lw 1.2 lc rgb '#333333'\n",
          tip.arrow->real(), tip.arrow->imag(), end.real(), end.imag());
      tip.arrow.reset();
    }
    tips = std::move(moved);
  }
  return arrows;
}

/// "today: 10.2", the key of the crosses.
std::string today_text(const RootLocus& locus) {
  return locus.today_value ? fmt::format("today: {:.4g}", *locus.today_value)
                           : std::string("today");
}

/// Columns: Hz, then dB and phase of the six direct responses.
std::string response_block(const CommandResponse& response) {
  std::string text;
  std::array<double, 6> last{};
  for (std::size_t k = 0; k < response.omega.size(); ++k) {
    text += fmt::format("{:.9g}", response.omega[k] / two_pi);
    for (int i = 0; i < 6; ++i) {
      const auto value = response.H[k](i, i);
      auto& phase = last[static_cast<std::size_t>(i)];
      phase = continued(std::arg(value) * 180.0 / std::numbers::pi, phase);
      text += fmt::format(" {:.6f} {:.4f}", level_db(std::abs(value)), phase);
    }
    text += '\n';
  }
  return block_of("bode", text);
}

std::string six_curves(int first) {
  std::array<std::string, 6> names;
  std::ranges::copy(spatial::direction_names, names.begin());
  return six_lines("bode", first, 2, 1.6, names, true);
}

constexpr int plane_width = 960, plane_height = 760;  // [pixels]

std::string beginning(const std::string& title, const std::string& subtitle) {
  return std::string(thin_grid) + thin_axes + titles(title, subtitle, plane_width, plane_height);
}

}  // namespace

void plot_root_locus(const RootLocus& locus, const std::string& title, const std::string& subtitle,
                     const std::string& path) {
  std::string rows;
  for (std::size_t k = 0; k < locus.values.size(); ++k)
    for (const auto& pole : locus.poles[k].poles)
      rows += fmt::format("{:.9g} {:.9g} {:.9g}\n", pole.pole.real(), pole.pole.imag(),
                          locus.values[k]);
  const auto [left, right, bottom, top] = shown_plane(locus);
  const Plane plane{left, right, bottom, top};
  std::string lines, crosses;
  const std::string arrows = branches(locus, plane, lines);
  for (const auto& pole : locus.today.poles)
    if (plane.holds(pole.pole))
      crosses += fmt::format("{:.9g} {:.9g}\n", pole.pole.real(), pole.pole.imag());
  const auto [least, most] = std::ranges::minmax(locus.values);
  std::string curves = "plot ";
  if (!lines.empty()) curves += "$branches using 1:2 with lines lw 0.8 lc rgb '#b0b0b0' notitle, ";
  curves += "$poles using 1:2:3 with points pt 7 ps 0.55 lc palette notitle";
  if (!crosses.empty())
    curves += ", $today using 1:2 with points pt 2 ps 1.3 lw 2 lc rgb '#000000' title " +
              quoted(today_text(locus));
  draw(path, plane_width, plane_height,
       beginning(title, subtitle) + block_of("poles", rows) +
           (lines.empty() ? "" : block_of("branches", lines)) +
           (crosses.empty() ? "" : block_of("today", crosses)) + damping_rays(plane) + arrows +
           fmt::format("set tmargin at screen {:.4f}\nset xrange [{:.6g}:{:.6g}]\n"
                       "set yrange [{:.6g}:{:.6g}]\nset xlabel 'Re, 1/s'\nset ylabel 'Im, rad/s'\n"
                       "set cblabel {}\nset cbrange [{:.9g}:{:.9g}]\n"
                       "set palette defined (0 '#0072b2', 0.5 '#e69f00', 1 '#d55e00')\n"
                       "set arrow from 0,{:.6g} to 0,{:.6g} nohead lw 1.2 lc rgb '#444444'\n"
                       "set key at screen 0.86,0.012 right bottom\n",
                       1.0 - 66.0 / plane_height, left, right, bottom, top, quoted(locus.key),
                       least, most, bottom, top) +
           curves + "\n");
}

void plot_command_response(const CommandResponse& response, const std::string& title,
                           const std::string& subtitle, const std::string& path) {
  std::string text = beginning(title, subtitle) + response_block(response);
  text += "set multiplot\n" +
          logarithmic_axis(response.omega.front() / two_pi, response.omega.back() / two_pi);
  text += at_screen({0.09, 0.97, 1.0 - 88.0 / plane_height, 0.42}) +
          "set format x ''\nset ylabel 'dB, platform / command'\nset yrange [-40:*]\n" +
          key_below_titles(plane_height);
  text += six_curves(2) + "unset label 101\nunset label 102\nunset key\n";
  text += at_screen({0.09, 0.97, 0.40, 0.08}) +
          "set format x '%g'\nset xlabel 'Hz'\nset ylabel 'phase °'\nset yrange [-360:30]\n"
          "set ytics 90\n";
  draw(path, plane_width, plane_height, text + six_curves(3) + "unset multiplot\n");
}

}  // namespace hydrapod::report
