#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "gnuplot.hpp"
#include "hydrapod/report/model_results.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::report {

namespace {

constexpr double degrees = 180.0 / std::numbers::pi;
constexpr int run_width = 1300, run_height = 1192;  // [pixels]
constexpr double band = 78.0 / run_height;          // of title and two lines below it

/// Columns: time, 6 commands, 6 motions (mm, deg), 6 pistons (mm), 6 drives (%).
std::string data_block(const simulation::Trace& trace) {
  std::string text;
  for (std::size_t k = 0; k < trace.time.size(); ++k) {
    text += fmt::format("{:.9g}", trace.time[k]);
    for (const auto* samples : {&trace.command, &trace.motion})
      for (int i = 0; i < 6; ++i)
        text += fmt::format(" {:.7g}", (*samples)[k][i] * (i < 3 ? 1e3 : degrees));
    for (int i = 0; i < 6; ++i) text += fmt::format(" {:.7g}", 1e3 * trace.piston[k][i]);
    for (int i = 0; i < 6; ++i) text += fmt::format(" {:.6g}", 100.0 * trace.drive[k][i]);
    text += '\n';
  }
  return block_of("run", text);
}

/// A range that shows `samples` of direction `i`, and small motions as small beside the others.
std::string range(const Simulation& s, int i) {
  double largest = 0.0;
  for (int j = 0; j < 6; ++j)  // a metre counts as a radian
    largest = std::max({largest, s.summary.peak_command[j], s.summary.peak_motion[j]});
  double low = 0.0, high = 0.0;
  for (const auto* samples : {&s.trace.command, &s.trace.motion})
    for (const auto& sample : *samples) {
      low = std::min(low, sample[i]);
      high = std::max(high, sample[i]);
    }
  const double least = std::max(0.01 * largest, 1e-9);
  const double margin = std::max(0.08 * (high - low), least);
  const double factor = i < 3 ? 1e3 : degrees;
  return fmt::format("set yrange [{:.6g}:{:.6g}]\n", factor * (low - margin),
                     factor * (high + margin));
}

/// Of three rows of three.
std::string cell_at(int row, int column) {
  const double h = (1.0 - band) / 3.0;
  const double left = column / 3.0, top = 1.0 - band - row * h;
  return at_screen({left + 88.0 / run_width, left + 1.0 / 3.0 - 16.0 / run_width,
                    top - 28.0 / run_height, top - h + 50.0 / run_height});
}

std::string direction_plot(const Simulation& s, int i) {
  std::string text = cell_at(i / 3, i % 3) + range(s, i);
  text += fmt::format("set title {}\nset ylabel {}\n", quoted(spatial::direction_name(i)),
                      quoted(i < 3 ? "mm" : "deg"));
  text += i == 0 ? "set key top right samplen 2.5 font ',9'\n" : "unset key\n";
  text += "plot ";
  if (s.loop.actuators == simulation::Actuators::controlled)
    text += fmt::format(
        "$run using 1:{} with lines lw 1.5 dt (8,5) lc rgb '#d55e00' title 'commanded', ", 2 + i);
  return text + fmt::format("$run using 1:{} with lines lw 1.6 lc rgb '#0072b2' title 'platform'\n",
                            8 + i);
}

std::string leg_plot(const char* title, const char* unit, int column, int first, bool key) {
  std::string text = cell_at(2, column) + "set autoscale y\n";
  text += fmt::format("set title {}\nset ylabel {}\n", quoted(title), quoted(unit));
  text += key ? fmt::format(
                    "set key at screen {:.4f},{:.4f} left top Left reverse samplen 1.5 "
                    "font ',9'\n",
                    (column + 1) / 3.0, (1.0 - band) / 3.0 - 28.0 / run_height)
              : "unset key\n";
  std::array<std::string, 6> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = fmt::format("leg {}", i + 1);
  return text + six_lines("run", first, 1, 1.3, names);
}

}  // namespace

void plot_simulation(const Simulation& s, const std::string& title, const std::string& subtitle,
                     const std::string& path) {
  const bool has_valves = s.loop.actuators != simulation::Actuators::springs;
  std::string text = data_block(s.trace) + "set multiplot\n" + thin_grid + thin_axes;
  text += "set xlabel 's' offset 0,0.6\nset ylabel offset 1.2,0\n";
  text += fmt::format("set xrange [0:{:.9g}]\n", std::max(s.trace.time.back(), 1e-9));
  text += titles(title, subtitle, run_width, run_height);
  for (int i = 0; i < 6; ++i) {
    text += direction_plot(s, i);
    if (i == 0) text += "unset label 101\nunset label 102\n";
  }
  text += leg_plot("pistons, from the base joints", "mm", 0, 14, !has_valves);
  const auto* drives = s.trace.torque.empty() ? "drives at the valves" : "drives of the motors";
  if (has_valves) text += leg_plot(drives, "%", 1, 20, true);
  draw(path, run_width, run_height, text + "unset multiplot\n");
}

}  // namespace hydrapod::report
