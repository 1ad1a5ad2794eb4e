#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gnuplot.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/diagnosis/diagnose.hpp"
#include "hydrapod/report/measured_results.hpp"

namespace hydrapod::report {

namespace {

using namespace diagnosis;

using base::two_pi;
constexpr double panel = 340.0;     // height of the first and the last [pixels]
constexpr double panel_top = 62.0;  // its title and legend [pixels]
constexpr double row_height = 24.0;
constexpr double heading = 52.0;  // of the picture [pixels]
constexpr int picture_width = 1000;
constexpr std::size_t most_rows = 14;

/// From top to bottom, what there is.
struct Layout {
  double measured{}, ranking{}, curve{};  ///< heights [pixels]
  [[nodiscard]] double all() const { return heading + measured + ranking + curve; }
};

std::string place(const Layout& layout, double top, double bottom, double left) {
  return at_screen(
      {left, 0.96, 1.0 - (heading + top) / layout.all(), 1.0 - (heading + bottom) / layout.all()});
}

/// A legend in a line between the title of a panel and its `top` [pixels].
std::string key_above(const Layout& layout, double top) {
  return fmt::format(
      "set key at screen 0.525,{:.4f} center center horizontal samplen 2.5 font ',9'\n",
      1.0 - (heading + top - 11.0) / layout.all());
}

/// Where the modes of a pose begin: its name below them, and a line between it and the one before.
std::string pose_marks(const Diagnosis& d, std::size_t first) {
  const auto& pose = d.modes[first].pose;
  if (first > 0 && d.modes[first - 1].pose == pose) return "";
  std::size_t end = first + 1;
  while (end < d.modes.size() && d.modes[end].pose == pose) ++end;
  const double middle = 0.5 * static_cast<double>(first + 1 + end);
  std::string s = fmt::format("set label {} at first {:.1f}, graph 0 offset 0,-2.3 center\n",
                              quoted(pose.empty() ? "?" : pose), middle);
  if (first > 0)
    s += fmt::format(
        "set arrow from first {0}.5, graph 0 to first {0}.5, graph 1 nohead lw 0.8 lc rgb "
        "'#888888'\n",
        first);
  return s;
}

std::string measured_panel(const Diagnosis& d, const Layout& layout) {
  std::string s = "$m << END\n";
  const bool several =
      std::ranges::any_of(d.modes, [&](const auto& m) { return m.pose != d.modes.front().pose; });
  std::string labels = "set xtics ()\n";
  int k = 0;
  for (const auto& mode : d.modes) {
    ++k;
    s += fmt::format(
        "{} {:.9g} {:.9g} {:.9g} {}\n", k, mode.omega / two_pi, 2.0 * mode.deviation / two_pi,
        mode.omega_best / two_pi,
        mode.rigid_mac >= resonance_mac ? fmt::format("{:.9g}", mode.omega_rigid / two_pi) : "NaN");
    labels += fmt::format(
        "set xtics add ({} {})\n",
        quoted(mode.direction < 0 ? fmt::format("{}", k) : direction_name(mode.direction)), k);
    if (several) labels += pose_marks(d, static_cast<std::size_t>(k - 1));
  }
  s += "END\n" + labels;
  s += fmt::format("set xrange [0.4:{}.6]\nset grid ytics back lt 1 lc rgb '#d0d0d0' lw 0.5\n", k);
  s += place(layout, panel_top, (several ? 0.84 : 0.88) * panel, 0.09);
  s += "set title 'Measured modes, rigid-leg model, best hypothesis' offset 0,1\n"
       "set ylabel 'Hz'\n";
  double low = d.modes.front().omega, high = low;
  for (const auto& mode : d.modes) {
    low = std::min({low, mode.omega, mode.omega_best});
    high = std::max({high, mode.omega, mode.omega_best, mode.omega_rigid});
  }
  constexpr double wide = 8.0;
  s += key_above(layout, panel_top);
  s += high > wide * low ? fmt::format("set logscale y\nset yrange [{:.6g}:{:.6g}]\n",
                                       0.5 * low / two_pi, 1.3 * high / two_pi)
                         : "set yrange [0:*]\n";
  return s +
         "plot $m using 1:5 with points pt 8 ps 2.6 lw 1.5 lc rgb '#999999' title 'rigid', $m "
         "using 1:2:3 with yerrorbars pt 6 ps 1.6 lw 1.6 lc rgb '#d55e00' title 'measured (95 %)', "
         "$m using 1:4 with points pt 7 ps 0.7 lc rgb '#0072b2' title 'best hypothesis'\nunset "
         "logscale y\nunset label\nunset arrow\nset title offset 0,0\n";
}

/// Length of a bar: a logarithm above 1, and from zero on: the best has none.
double above_best(double bic) { return std::log10(1.0 + std::max(0.0, bic)); }

/// Tics of such bars at 0 and powers of ten.
std::string above_tics(double most) {
  std::string s = "set xtics ('0' 0";
  int power = 0;
  for (; std::pow(10.0, power) <= std::max(10.0, most); ++power) {
  }
  const int step = (power + 5) / 6;
  for (int k = 0; k < power; k += step)
    s += fmt::format(
        ", '{}' {:.9g}",
        k < 4 ? fmt::format("{}", std::lround(std::pow(10.0, k))) : fmt::format("1e{}", k),
        above_best(std::pow(10.0, k)));
  return s + ")\n";
}

/// A bar per hypothesis: how far its BIC is above the best.
std::string ranking_panel(const Diagnosis& d, const Layout& layout) {
  std::vector<std::size_t> shown;
  for (std::size_t k = 0; k < d.hypotheses.size(); ++k)
    if (shown.size() < most_rows - 2 || d.hypotheses[k].causes.empty()) shown.push_back(k);
  double most = 0.0;
  for (const auto k : shown) most = std::max(most, d.hypotheses[k].bic - d.best().bic);
  std::string s = "unset ylabel\nunset key\nunset grid\n";
  s += place(layout, layout.measured + 34.0, layout.measured + layout.ranking - 48.0, 0.5);
  s += fmt::format(
      "set title 'Hypotheses'\nset yrange [{}.5:0.5]\nset xrange [0:{:.6g}]\n{}set xlabel {}\n"
      "set style fill solid\nset ytics () font ',9'\n$c << END\n",
      shown.size(), 1.05 * std::max(above_best(most), above_best(1.0)), above_tics(most),
      quoted(d.equivalent.size() > 1 ? "BIC above the best (green: equally good)"
                                     : "BIC above the best"));
  int row = 0;
  for (const auto k : shown) {
    const auto& e = d.hypotheses[k];
    const bool equivalent = std::ranges::count(d.equivalent, k) > 0;
    s += fmt::format("{} {:.6g} {}\n", ++row, above_best(e.bic - d.best().bic),
                     equivalent         ? "0x009e73"
                     : e.causes.empty() ? "0x999999"
                                        : "0x0072b2");
  }
  s += "END\n";
  row = 0;
  for (const auto k : shown)
    s += fmt::format("set ytics add ({} {})\n", quoted(hypothesis_name(d, d.hypotheses[k])), ++row);
  return s +
         "plot $c using 2:1:(0):2:($1-0.35):($1+0.35):3 with boxxyerror lc rgb variable\n"
         "set xtics auto\nset xtics format '%g'\n";
}

/// Of the curve [%].
double highest_drop(const Remedy& r) {
  double highest = 100.0 * r.today.drop;
  for (const auto& point : r.curve)
    if (point.omega > 0.0) highest = std::max(highest, 100.0 * point.drop);
  return highest;
}

std::string curve_panel(const CaseFile& file, const Layout& layout) {
  const auto& r = *file.remedy;
  // down to where the legs fold: what is softer has no use
  auto first = r.curve.end();
  while (first != r.curve.begin() && std::prev(first)->omega > 0.0) --first;
  std::string s = "$k << END\n";
  for (; first != r.curve.end(); ++first)
    s += fmt::format("{:.9g} {:.9g} {:.6g}\n", first->stiffness, first->omega / two_pi,
                     100.0 * first->drop);
  s += "END\nset yrange [*:*]\nset xrange [*:*] noextend\nset ytics auto font ',9'\n";
  const double top = layout.measured + layout.ranking;
  s += place(layout, top + panel_top, top + 0.84 * panel, 0.09);
  s +=
      "set grid back lt 1 lc rgb '#d0d0d0' lw 0.5\nset logscale x\nset xtics format '%.0s %cN/m'\n";
  s += fmt::format("set xlabel 'stiffness of the guide sleeves{}'\n",
                   r.today.softest ? " (stiffest leg)" : "");
  s += fmt::format("set title {} offset 0,1\n",
                   quoted("Required stiffness of the guide sleeves: " + goal_words(file.goal)));
  const bool drop = file.goal.drop.has_value();
  s += key_above(layout, top + panel_top);
  s += drop ? "set ylabel 'largest drop below rigid legs, %'\n"
            : "set ylabel 'lowest resonance, Hz'\n";
  const int column = drop ? 3 : 2;
  const double goal = drop ? 100.0 * *file.goal.drop : file.goal.omega.value_or(0.0) / two_pi;
  if (drop)  // the goal below the upper edge
    s += fmt::format("set yrange [0:{:.6g}]\n", 1.15 * std::max(goal, highest_drop(r)));
  const auto value = [&](const RemedyPoint& p) { return drop ? 100.0 * p.drop : p.omega / two_pi; };
  s += fmt::format("$t << END\n{:.9g} {:.9g}\nEND\n$n << END\n{:.9g} {:.9g}\nEND\n",
                   r.today.stiffness, value(r.today), r.needed.stiffness, value(r.needed));
  s += fmt::format(
      "plot $k using 1:{} with lines lw 2 lc rgb '#0072b2' notitle, {:.9g} with lines dt 2 lc rgb "
      "'#d55e00' title 'goal', $t using 1:2 with points pt 6 ps 1.8 lw 2 lc rgb '#444444' title {}",
      column, goal, quoted((file.fitted ? "fitted, " : "nominal, ") + sleeves_text(r.today)));
  if (r.status == RemedyStatus::found)
    s += fmt::format(", $n using 1:2 with points pt 7 ps 1.4 lc rgb '#009e73' title {}",
                     quoted("required, " + sleeves_text(r.needed)));
  return s + "\n";
}

}  // namespace

void plot_diagnosis(const CaseFile& file, const std::string& state, const std::string& path) {
  Layout layout;
  if (file.diagnosis) {
    layout.measured = panel;
    const auto rows = std::min(most_rows, file.diagnosis->hypotheses.size());
    if (rows > 1) layout.ranking = 90.0 + row_height * static_cast<double>(rows);
  }
  if (file.remedy) layout.curve = panel;
  if (layout.all() == heading) layout.curve = panel;
  const auto height = static_cast<int>(layout.all());
  std::string s =
      std::string(thin_axes) + "set multiplot\n" +
      titles(file.machine.name.empty() ? "Diagnosis" : file.machine.name + ": diagnosis", state,
             picture_width, height);
  if (layout.measured > 0.0) s += measured_panel(*file.diagnosis, layout) + "unset label\n";
  if (layout.ranking > 0.0) s += ranking_panel(*file.diagnosis, layout);
  if (file.remedy) s += curve_panel(file, layout);
  draw(path, picture_width, height, s + "unset multiplot\n");
}

}  // namespace hydrapod::report
