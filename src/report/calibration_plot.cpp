#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gnuplot.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/report/measured_results.hpp"

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
  std::replace(path.begin(), path.end(), '_', ' ');
  std::replace(path.begin(), path.end(), '.', ' ');
  return path;
}

std::string target_rows(const Candidate& best, const Targets& targets) {
  std::string text = "$targets << END\n";
  for (std::size_t i = 0; i < best.targets.size(); ++i)
    text +=
        fmt::format("{} {:.9g} {:.9g} {:.9g} {}\n", i + 1, targets.modes[i].omega / two_pi,
                    best.targets[i].omega / two_pi, best.targets[i].omega - targets.modes[i].omega,
                    best.targets[i].outlier ? 1 : 0);
  return text + "END\n";
}

/// Height [pixels] of the two panels about targets, and of the whole picture.
struct Heights {
  double targets{640.0};
  double all{640.0};
};

std::string margins(const Heights& h, double top, double bottom) {
  return fmt::format(
      "set tmargin at screen {:.4f}\nset bmargin at screen {:.4f}\n"
      "set lmargin at screen 0.09\nset rmargin at screen 0.97\n",
      1.0 - top * h.targets / h.all, 1.0 - bottom * h.targets / h.all);
}

/// Frequencies above, differences below.
std::string target_panels(const Candidate& best, const Targets& targets, const Heights& heights) {
  std::string s = target_rows(best, targets);
  s += "set grid ytics back lt 1 lc rgb '#d0d0d0' lw 0.5\nset tics font ',9'\n";
  s += "set border lw 0.8 lc rgb '#444444'\n";
  s += fmt::format("set xrange [0.4:{}.6]\nset xtics 1\n", best.targets.size());
  s += margins(heights, 0.08, 0.52) + fmt::format("set title {}\n", quoted(targets.title));
  s += "set ylabel 'Hz'\nset key top right\nset format x ''\n";
  s += "plot $targets using 1:2 with points pt 6 ps 1.6 lw 2 lc rgb '#d55e00' title 'target', "
       "$targets using 1:3 with points pt 7 ps 0.7 lc rgb '#0072b2' title 'model'\n";
  s += margins(heights, 0.56, 0.93);
  s += "unset title\nunset key\nset format x '%g'\nset xlabel 'target' offset 0,0.5\n";
  s += "set ylabel 'model − target, rad/s'\nset xzeroaxis lt 1 lc rgb '#888888'\n";
  return s + "plot $targets using 1:4 with impulses lw 4 lc rgb '#0072b2'\n";
}

/// A bar per combination.
std::string combination_panel(const Calibration& result, const Heights& heights) {
  std::string s = "unset xzeroaxis\nunset ylabel\nunset grid\nset logscale x\n";
  s += fmt::format("set tmargin at screen {:.4f}\nset bmargin at screen {:.4f}\n",
                   1.0 - (heights.targets + 26.0) / heights.all, 52.0 / heights.all);
  s += "set lmargin at screen 0.62\nset xrange [*:*]\nset xtics auto\n";
  s += fmt::format("set yrange [{}.5:0.5]\n", result.candidates.size());
  s += "set xlabel 'root mean square difference, σ' offset 0,0\n";
  s += "set style fill solid\nset ytics () font ',8'\n$c << END\n";
  int row = 0;
  for (const auto& c : result.candidates) {
    const double rms = std::sqrt(c.misfit / std::max(1.0, static_cast<double>(c.targets.size())));
    s += fmt::format("{} {:.6g} {}\n", ++row, c.fitted ? std::max(1e-3, rms) : 1e6,
                     c.admissible() ? "0x009e73" : "0xbbbbbb");
  }
  s += "END\n";
  row = 0;
  for (const auto& c : result.candidates)
    s += fmt::format("set ytics add ({} {})\n",
                     quoted(c.name + (c.admissible() ? "" : " (not admissible)")), ++row);
  return s + "plot $c using 2:1:(1e-3):2:($1-0.3):($1+0.3):3 with boxxyerror lc rgb variable\n";
}

}  // namespace

void plot_calibration(const Calibration& result, const Targets& targets, const std::string& path) {
  const bool several = result.candidates.size() > 1;
  Heights heights;
  if (several) heights.all += 60.0 + 26.0 * static_cast<double>(result.candidates.size());
  draw(path, 1000, static_cast<int>(heights.all),
       [&](const std::string& terminal, const std::string& file) {
         std::string s = fmt::format(
             "set terminal {}\nset output {}\nset encoding utf8\nset termoption noenhanced\n"
             "set multiplot\n",
             terminal, quoted(file));
         s += target_panels(result.best(), targets, heights);
         if (several) s += combination_panel(result, heights);
         return s + "unset multiplot\nunset output\n";
       });
}

void plot_sensitivities(const Sensitivities& s, const std::string& title, const std::string& path) {
  const auto modes = s.omega.size();
  const auto parameters = static_cast<Eigen::Index>(s.parameters.size());
  const int width = 190 + 54 * static_cast<int>(parameters);
  const int height = 250 + 26 * static_cast<int>(modes);
  draw(path, width, height, [&](const std::string& terminal, const std::string& file) {
    std::string text = fmt::format(
        "set terminal {}\nset output {}\nset encoding utf8\nset termoption noenhanced\n", terminal,
        quoted(file));
    text += "$map << END\n";
    for (Eigen::Index k = 0; k < modes; ++k)
      for (Eigen::Index j = 0; j < parameters; ++j)
        text += fmt::format("{} {} {:.4f}\n", j, k, s.percent_per_percent(k, j));
    text += "END\n";
    text += fmt::format("set title {}\nset key off\nset tics font ',9' scale 0\n", quoted(title));
    text +=
        fmt::format("set xrange [-0.5:{}.5]\nset yrange [{}.5:-0.5]\n", parameters - 1, modes - 1);
    text += "set palette defined (-1 '#0072b2', 0 'white', 1 '#d55e00')\nset cbrange [-1:1]\n";
    text += "set cblabel '% of the frequency per % of the parameter'\n";
    text += "set xtics () rotate by 50 right\nset ytics ()\n";
    for (Eigen::Index j = 0; j < parameters; ++j)
      text += fmt::format("set xtics add ({} {})\n",
                          quoted(short_name(s.parameters[static_cast<std::size_t>(j)].path)), j);
    for (Eigen::Index k = 0; k < modes; ++k)
      text += fmt::format("set ytics add ({} {})\n",
                          quoted(fmt::format("{}: {:.2f} Hz", k + 1, s.omega[k] / two_pi)), k);
    text +=
        "plot $map using 1:2:3 with image, $map using 1:2:(abs($3) < 0.005 ? '' : "
        "sprintf('%.2f', $3)) with labels font ',8'\n";
    return text + "unset output\n";
  });
}

}  // namespace hydrapod::report
