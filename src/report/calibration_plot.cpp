#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "gnuplot.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "hydrapod/report/measured_results.hpp"
#include "hydrapod/report/model_results.hpp"

namespace hydrapod::report {

namespace {

using namespace calibration;
using observation::Targets;

using base::two_pi;

/// "legs.rod.mass_center" → "rod mass center", what fits below a column.
std::string short_name(std::string path) {
  for (const std::string prefix : {"legs.", "platform.inertia.", "poses."})
    if (path.starts_with(prefix))
      path = path.substr(prefix == "platform.inertia." ? 9 : prefix.size());
  constexpr std::array axes{"[0]", "[1]", "[2]"};
  for (std::size_t k = 0; k < axes.size(); ++k)
    if (path.ends_with(axes[k]))
      path = path.substr(0, path.size() - 3) + ' ' + static_cast<char>('x' + k);
  std::replace(path.begin(), path.end(), '_', ' ');
  std::replace(path.begin(), path.end(), '.', ' ');
  return path;
}

std::string target_rows(const Candidate& best, const Targets& targets) {
  std::string text;
  for (std::size_t i = 0; i < best.targets.size(); ++i)
    text += fmt::format(
        "{} {:.9g} {:.9g} {:.9g} {:.9g}\n", i + 1, targets.modes[i].omega / two_pi,
        best.targets[i].omega / two_pi, (best.targets[i].omega - targets.modes[i].omega) / two_pi,
        targets.deviations_given ? numerics::normal_half_width * targets.modes[i].deviation / two_pi
                                 : 0.0);
  return block_of("targets", text);
}

constexpr int picture_width = 1000;  // [pixels]

/// Height [pixels] of the two panels about targets, and of the whole picture.
struct Heights {
  double targets{640.0};
  double all{640.0};
};

std::string panel_at(const Heights& h, double top, double bottom) {
  return at_screen({0.09, 0.97, 1.0 - top * h.targets / h.all, 1.0 - bottom * h.targets / h.all});
}

/// Frequencies above, differences below.
std::string target_panels(const Candidate& best, const Targets& targets, const PlotText& text,
                          const Heights& heights) {
  std::string s = target_rows(best, targets);
  s += std::string("set grid ytics back lt 1 lc rgb '#d0d0d0' lw 0.5\n") + thin_axes;
  s += fmt::format("set xrange [0.4:{}.6]\nset xtics 1\n", best.targets.size());
  const auto height = static_cast<int>(heights.all);
  s += panel_at(heights, 0.14, 0.54) + titles(text.title, text.subtitle, picture_width, height) +
       key_below_titles(height);
  s += "set ylabel 'Hz'\nset format x ''\nset offsets 0,0,graph 0.06,graph 0.06\n";
  s += targets.deviations_given
           ? "plot $targets using 1:2:5 with yerrorbars pt 6 ps 1.6 lw 2 lc rgb '#d55e00' title "
             "'target (95 %)', "
           : "plot $targets using 1:2 with points pt 6 ps 1.6 lw 2 lc rgb '#d55e00' title "
             "'target', ";
  s += "$targets using 1:3 with points pt 7 ps 0.7 lc rgb '#0072b2' title 'model'\n";
  s += "unset offsets\n" + panel_at(heights, 0.58, 0.93);
  s += "unset label\nunset key\nset format x '%g'\nset xlabel 'target' offset 0,0.5\n";
  s += "set ylabel 'model − target, Hz'\nset xzeroaxis lt 1 lc rgb '#888888'\n";
  return s + "plot $targets using 1:4 with impulses lw 4 lc rgb '#0072b2'\n";
}

/// A bar per combination.
std::string combination_panel(const Calibration& result, const Heights& heights) {
  std::string s = "unset xzeroaxis\nunset ylabel\nunset grid\nset logscale x\n";
  s += at_screen({0.62, 0.97, 1.0 - (heights.targets + 26.0) / heights.all, 52.0 / heights.all});
  s += "set xrange [*:*]\nset xtics auto\n";
  s += fmt::format("set yrange [{}.5:0.5]\n", result.candidates.size());
  s += "set xlabel 'root mean square difference, σ' offset 0,0\n";
  std::string rows;
  std::vector<std::string> names;
  for (const auto& c : result.candidates) {
    const double rms = std::sqrt(c.misfit / std::max(1.0, static_cast<double>(c.targets.size())));
    names.push_back(c.name + (c.admissible() ? "" : " (not admissible)"));
    rows += fmt::format("{} {:.6g} {}\n", names.size(), c.fitted ? std::max(1e-3, rms) : 1e6,
                        c.admissible() ? "0x009e73" : "0xbbbbbb");
  }
  s += "set style fill solid\n" + named_tics('y', names) + "set ytics font ',8'\n";
  s += block_of("c", rows);
  return s + "plot $c using 2:1:(1e-3):2:($1-0.3):($1+0.3):3 with boxxyerror lc rgb variable\n";
}

}  // namespace

void plot_calibration(const Calibration& result, const Targets& targets, const PlotText& text,
                      const std::string& path) {
  const bool several = result.candidates.size() > 1;
  Heights heights;
  if (several) heights.all += 60.0 + 26.0 * static_cast<double>(result.candidates.size());
  std::string s = "set multiplot\n" + target_panels(result.best(), targets, text, heights);
  if (several) s += combination_panel(result, heights);
  draw(path, picture_width, static_cast<int>(heights.all), s + "unset multiplot\n");
}

void plot_sensitivities(const Sensitivities& s, const PlotText& heading, const std::string& path) {
  const auto modes = static_cast<int>(s.omega.size()),
             parameters = static_cast<int>(s.parameters.size());
  std::vector<std::string> columns, rows;
  for (const auto& parameter : s.parameters) columns.push_back(short_name(parameter.path));
  for (const double omega : s.omega)
    rows.push_back(fmt::format("{}: {:.2f} Hz", rows.size() + 1, omega / two_pi));
  std::string text = block_of("map", matrix_rows(s.percent_per_percent, 0));
  const int width = 190 + 54 * parameters, height = 280 + 26 * modes;
  text += titles(heading.title, heading.subtitle, width, height) +
          fmt::format("set tmargin at screen {:.4f}\nset key off\nset tics font ',9' scale 0\n",
                      1.0 - 74.0 / height);
  text +=
      fmt::format("set xrange [-0.5:{}.5]\nset yrange [{}.5:-0.5]\n", parameters - 1, modes - 1);
  // to the largest value, so that no colour stands for two
  double most = 0.0;
  for (const double value : s.percent_per_percent.reshaped())
    if (std::isfinite(value)) most = std::max(most, std::abs(value));
  if (!(most > 0.0)) most = 1.0;
  text += "set palette defined (-1 '#0072b2', 0 'white', 1 '#d55e00')\n";
  text += fmt::format("set cbrange [{:.6g}:{:.6g}]\n", -most, most);
  text += "set cblabel '% of the frequency per % of the parameter'\n";
  text += named_tics('x', columns, 0) + "set xtics rotate by 50 right\n";
  text += named_tics('y', rows, 0);
  text +=
      "plot $map using 1:2:3 with image, $map using 1:2:(abs($3) < 0.005 ? '' : "
      "sprintf('%.2f', $3)) with labels font ',8'\n";
  draw(path, width, height, text);
}

}  // namespace hydrapod::report
