#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gnuplot.hpp"
#include "hydrapod/report/calibration.hpp"

namespace hydrapod::report {

namespace {

using namespace calibration;

constexpr double two_pi = 2.0 * std::numbers::pi;

/// "legs.rod.mass_center" → "rod mass center", what fits below a column.
std::string short_name(std::string path) {
  for (const std::string prefix : {"legs.", "platform.inertia.", "poses."})
    if (path.starts_with(prefix)) path = path.substr(prefix == "platform.inertia." ? 9 : prefix.size());
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

}  // namespace

void plot_calibration(const Calibration& result, const Targets& targets, const std::string& path) {
  const auto& best = result.best();
  const bool several = result.candidates.size() > 1;
  const int rows = static_cast<int>(result.candidates.size());
  const int height = 640 + (several ? 60 + 26 * rows : 0);
  const double share = 640.0 / height;  // of the upper two panels
  draw(path, 1000, height, [&](const std::string& terminal, const std::string& file) {
    std::string s = fmt::format(
        "set terminal {}\nset output {}\nset encoding utf8\nset termoption noenhanced\n", terminal,
        quoted(file));
    s += target_rows(best, targets);
    const auto panel = [&](double top, double bottom) {
      return fmt::format(
          "set tmargin at screen {:.4f}\nset bmargin at screen {:.4f}\nset lmargin at screen "
          "0.09\nset rmargin at screen 0.97\n",
          1.0 - top * share, 1.0 - bottom * share);
    };
    s += "set multiplot\nset grid ytics back lt 1 lc rgb '#d0d0d0' lw 0.5\nset tics font ',9'\n";
    s += "set border lw 0.8 lc rgb '#444444'\n";
    s += fmt::format("set xrange [0.4:{}.6]\nset xtics 1\n", best.targets.size());
    s += panel(0.08, 0.52) + fmt::format("set title {}\n", quoted(targets.title));
    s += "set ylabel 'Hz'\nset key top right\nset format x ''\n";
    s += "plot $targets using 1:2 with points pt 6 ps 1.6 lw 2 lc rgb '#d55e00' title 'target', "
         "$targets using 1:3 with points pt 7 ps 0.7 lc rgb '#0072b2' title 'model'\n";
    s += panel(0.56, 0.93) + "unset title\nunset key\nset format x '%g'\nset xlabel 'target'\n";
    s += "set ylabel 'model − target, rad/s'\nset xzeroaxis lt 1 lc rgb '#888888'\n";
    s += "plot $targets using 1:4 with impulses lw 4 lc rgb '#0072b2'\n";
    if (several) {
      s += "unset xzeroaxis\nunset ylabel\nunset grid\nset logscale x\nset format x '%g'\n";
      s += fmt::format("set tmargin at screen {:.4f}\nset bmargin at screen {:.4f}\n",
                       1.0 - share - 26.0 / height, 52.0 / height);
      s += "set lmargin at screen 0.62\nset xrange [*:*]\nset xtics auto\n";
      s += fmt::format(
          "set yrange [{}.5:0.5]\nset xlabel 'root mean square difference, in deviations'\n", rows);
      s += "set boxwidth 0.6\nset style fill solid\nset ytics font ',8'\n$c << END\n";
      int row = 0;
      for (const auto& c : result.candidates)
        s += fmt::format(
            "{} {:.6g} {} {}\n", ++row,
            c.fitted ? std::max(1e-3, std::sqrt(c.misfit / static_cast<double>(c.targets.size())))
                     : 1e6,
            c.admissible() ? "0x009e73" : "0xbbbbbb",
            quoted(c.name + (c.admissible() ? "" : " (cannot be built)")));
      s += "END\nset ytics ()\n";
      row = 0;
      for (const auto& c : result.candidates)
        s += fmt::format("set ytics add ({} {})\n",
                         quoted(c.name + (c.admissible() ? "" : " (cannot be built)")), ++row);
      s += "plot $c using 2:1:(1e-3):2:($1-0.3):($1+0.3):3 with boxxyerror lc rgb variable\n";
    }
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
