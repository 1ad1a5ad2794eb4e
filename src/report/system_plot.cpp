#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

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
  return six_lines("bode", first, 2, 1.6, names);
}

constexpr int plane_width = 960, plane_height = 760;  // [pixels]

std::string beginning(const std::string& title, const std::string& subtitle) {
  return std::string(thin_grid) + thin_axes + titles(title, subtitle, plane_height);
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
  const auto [least, most] = std::ranges::minmax(locus.values);
  draw(path, plane_width, plane_height,
       beginning(title, subtitle) + block_of("poles", rows) +
           fmt::format(
               "set tmargin at screen {:.4f}\nset xrange [{:.6g}:{:.6g}]\n"
               "set yrange [{:.6g}:{:.6g}]\nset xlabel 'Re 1/s'\nset ylabel 'Im rad/s'\n"
               "set cblabel {}\nset cbrange [{:.9g}:{:.9g}]\n"
               "set palette defined (0 '#0072b2', 0.5 '#e69f00', 1 '#d55e00')\n"
               "set arrow from 0,{:.6g} to 0,{:.6g} nohead lw 1.2 lc rgb '#444444'\nunset key\n"
               "plot $poles using 1:2:3 with points pt 7 ps 0.55 lc palette\n",
               1.0 - 66.0 / plane_height, left, right, bottom, top, quoted(locus.key), least, most,
               bottom, top));
}

void plot_command_response(const CommandResponse& response, const std::string& title,
                           const std::string& subtitle, const std::string& path) {
  std::string text = beginning(title, subtitle) + response_block(response);
  text += "set multiplot\n" +
          logarithmic_frequencies(response.omega.front() / two_pi, response.omega.back() / two_pi);
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
