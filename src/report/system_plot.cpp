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
using spatial::direction_names;
/// Six colours that are told apart by the colour-blind as well.
constexpr std::array colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"};

std::string head(const std::string& terminal, const std::string& file, const std::string& title,
                 const std::string& subtitle, int height) {
  return fmt::format(
      "set terminal {}\nset output {}\nset encoding utf8\nset termoption noenhanced\n"
      "set grid xtics ytics back lt 1 lc rgb '#d0d0d0' lw 0.5\n"
      "set tics font ',9'\nset border lw 0.8 lc rgb '#444444'\n"
      "set label 101 {} at screen 0.5,{:.4f} center font ',14'\n"
      "set label 102 {} at screen 0.5,{:.4f} center font ',10' tc rgb '#444444'\n",
      terminal, quoted(file), quoted(title), 1.0 - 22.0 / height, quoted(subtitle),
      1.0 - 46.0 / height);
}

/// The part of the plane around the oscillations of mechanics and oil: those of valves and delay
/// lie so far out that they would squeeze the rest.
std::array<double, 4> shown_plane(const RootLocus& locus) {
  double left = 0.0, right = 0.0, top = 0.0;
  for (const auto& poles : locus.poles)
    for (const auto& pole : poles.poles) {
      const double far_out = pole.parts[static_cast<std::size_t>(simulation::Part::valve)] +
                             pole.parts[static_cast<std::size_t>(simulation::Part::delay)];
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
  std::string text = "$bode << END\n";
  std::array<double, 6> last{};
  for (std::size_t k = 0; k < response.omega.size(); ++k) {
    text += fmt::format("{:.9g}", response.omega[k] / two_pi);
    for (int i = 0; i < 6; ++i) {
      const auto value = response.H[k](i, i);
      auto& phase = last[static_cast<std::size_t>(i)];
      const double now = std::arg(value) * 180.0 / std::numbers::pi;
      phase = now + 360.0 * std::round((phase - now) / 360.0);
      text += fmt::format(" {:.6f} {:.4f}", 20.0 * std::log10(std::max(std::abs(value), 1e-300)),
                          phase);
    }
    text += '\n';
  }
  return text + "END\n";
}

std::string six_curves(int first) {
  std::string text = "plot ";
  for (int i = 0; i < 6; ++i)
    text += fmt::format("{}$bode using 1:{} with lines lw 1.6 lc rgb '{}' title '{}'",
                        i == 0 ? "" : ", ", first + 2 * i, colours[static_cast<std::size_t>(i)],
                        direction_names[static_cast<std::size_t>(i)]);
  return text + "\n";
}

}  // namespace

void plot_root_locus(const RootLocus& locus, const std::string& title, const std::string& subtitle,
                     const std::string& path) {
  constexpr int width = 960, height = 760;
  draw(path, width, height, [&](const std::string& terminal, const std::string& file) {
    std::string text = head(terminal, file, title, subtitle, height) + "$poles << END\n";
    for (std::size_t k = 0; k < locus.values.size(); ++k)
      for (const auto& pole : locus.poles[k].poles)
        text += fmt::format("{:.9g} {:.9g} {:.9g}\n", pole.pole.real(), pole.pole.imag(),
                            locus.values[k]);
    const auto [left, right, bottom, top] = shown_plane(locus);
    text += fmt::format(
        "END\nset tmargin at screen {:.4f}\nset xrange [{:.6g}:{:.6g}]\nset yrange "
        "[{:.6g}:{:.6g}]\nset xlabel 'Re 1/s'\nset ylabel 'Im rad/s'\nset cblabel {}\n"
        "set cbrange [{:.9g}:{:.9g}]\nset palette defined (0 '#0072b2', 0.5 '#e69f00', 1 "
        "'#d55e00')\n"
        "set arrow from 0,{:.6g} to 0,{:.6g} nohead lw 1.2 lc rgb '#444444'\nunset key\n",
        1.0 - 66.0 / height, left, right, bottom, top, quoted(locus.key),
        *std::min_element(locus.values.begin(), locus.values.end()),
        *std::max_element(locus.values.begin(), locus.values.end()), bottom, top);
    return text + "plot $poles using 1:2:3 with points pt 7 ps 0.55 lc palette\nunset output\n";
  });
}

void plot_command_response(const CommandResponse& response, const std::string& title,
                           const std::string& subtitle, const std::string& path) {
  constexpr int width = 960, height = 760;
  draw(path, width, height, [&](const std::string& terminal, const std::string& file) {
    std::string text = head(terminal, file, title, subtitle, height) + response_block(response);
    text += fmt::format(
        "set multiplot\nset logscale x\nset xrange [{:.9g}:{:.9g}]\nset lmargin at screen 0.09\n"
        "set rmargin at screen 0.97\nset tmargin at screen {:.4f}\nset bmargin at screen 0.42\n"
        "set format x ''\nset ylabel 'dB, platform / command'\nset yrange [-40:*]\n"
        "set key bottom left font ',10'\n",
        response.omega.front() / two_pi, response.omega.back() / two_pi, 1.0 - 66.0 / height);
    text += six_curves(2) + "unset label 101\nunset label 102\nunset key\n";
    text +=
        "set tmargin at screen 0.40\nset bmargin at screen 0.08\nset format x '%g'\n"
        "set xlabel 'Hz'\nset ylabel 'phase °'\nset yrange [-360:30]\nset ytics 90\n";
    return text + six_curves(3) + "unset multiplot\nunset output\n";
  });
}

}  // namespace hydrapod::report
