#include <fmt/format.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "gnuplot.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/report/model_results.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::report {

namespace {

using base::two_pi;
using spatial::direction_names;
constexpr const char* real_style = "lw 2 lc rgb '#0072b2'";  // colours safe for the colour-blind
constexpr const char* rigid_style = "lw 2 dt (8,5) lc rgb '#d55e00'";

double decibels(double magnitude) { return 20.0 * std::log10(std::max(magnitude, 1e-300)); }

/// Phase [deg] continued from `last`, so that curves do not jump by a turn.
double continued_phase(const response::Complex& value, double last) {
  const double phase = std::arg(value) * 180.0 / std::numbers::pi;
  return phase + 360.0 * std::round((last - phase) / 360.0);
}

/// Columns: Hz, then per entry dB and phase of the real model, dB and phase of the rigid one.
std::string data_block(const Bode& bode, const std::vector<Entry>& entries) {
  std::string text = "$bode << END\n";
  std::vector<std::array<double, 2>> last(entries.size(), {0.0, 0.0});
  for (size_t i = 0; i < bode.omega.size(); ++i) {
    text += fmt::format("{:.9g}", bode.omega[i] / two_pi);
    for (size_t e = 0; e < entries.size(); ++e)
      for (int model = 0; model < 2; ++model) {
        const auto value =
            (model == 0 ? bode.real : bode.rigid)[i](entries[e].output, entries[e].input);
        last[e][model] = continued_phase(value, last[e][model]);
        text += fmt::format(" {:.6f} {:.4f}", decibels(std::abs(value)), last[e][model]);
      }
    text += '\n';
  }
  return text + "END\n";
}

/// Range of a magnitude axis [dB], with room above for the peaks' labels.
std::array<double, 2> magnitude_range(const Bode& bode, const Entry& entry) {
  double low = 1e300, high = -1e300;
  for (const auto* H : {&bode.real, &bode.rigid})
    for (const auto& h : *H) {
      const double level = decibels(std::abs(h(entry.output, entry.input)));
      if (!std::isfinite(level)) continue;  // an undamped mode met exactly
      low = std::min(low, level);
      high = std::max(high, level);
    }
  for (const auto& peak : bode.real_peaks)
    if (entry.output == entry.input && peak.direction == entry.output &&
        std::isfinite(peak.magnitude))
      high = std::max(high, decibels(peak.magnitude));
  const double span = std::max(high - low, 6.0);
  return {low - 0.05 * span, high + 0.16 * span};
}

/// Ticks at 1, 2, 5 times powers of ten; in a band too narrow for them, evenly spaced round
/// numbers.
std::string frequency_ticks(double from, double to) {
  std::vector<double> ticks;
  const int lowest = static_cast<int>(std::floor(std::log10(from)));
  const int highest = static_cast<int>(std::ceil(std::log10(to)));
  for (int decade = lowest; decade <= highest; ++decade)
    for (const int digit : {1, 2, 5}) ticks.push_back(digit * std::pow(10.0, decade));
  std::erase_if(ticks, [&](double at) { return at < from || at > to; });
  constexpr size_t enough = 3;
  if (ticks.size() < enough) {
    const double power = std::pow(10.0, std::floor(std::log10((to - from) / 2.0)));
    const double steps = (to - from) / power;  // 2 … 20
    const double step = power * (steps < 5.0 ? 0.5 : steps < 10.0 ? 1.0 : 2.0);
    ticks.clear();
    for (double k = std::ceil(from / step); k * step <= to; ++k) ticks.push_back(k * step);
  }
  std::string text;
  for (const double at : ticks) text += fmt::format("{}{:.6g}", text.empty() ? "" : ", ", at);
  return "set xtics (" + text + ")\n";
}

/// Marks the peaks of a direct entry with their frequencies; unbounded ones stand at `top` [dB].
std::string peak_labels(const Bode& bode, const Entry& entry, double top) {
  std::string text;
  if (entry.output != entry.input) return text;
  for (const auto& peak : bode.real_peaks)
    if (peak.direction == entry.output)
      text += fmt::format(
          "set label {} at {:.9g},{:.6f} point pt 7 ps 0.45 lc rgb '#0072b2' offset 0.4,0.5 font "
          "',9'\n",
          quoted(fmt::format("{:.2f}", peak.omega / two_pi)), peak.omega / two_pi,
          std::min(decibels(peak.magnitude), top));
  return text;
}

/// Does an entry vanish (for instance z caused by x in a symmetric machine)? Then there is nothing
/// to scale by.
bool vanishes(const Bode& bode, const Entry& entry) {
  double largest = 0.0, of_output = 0.0;
  for (const auto& H : bode.real) {
    largest = std::max(largest, std::abs(H(entry.output, entry.input)));
    of_output = std::max(of_output, std::abs(H(entry.output, entry.output)));
  }
  return largest < 1e-9 * of_output;
}

struct Cell {
  double left, right, top, bottom;  // of the picture, 0…1 from the lower left
};

std::string margins(const Cell& c) {
  return fmt::format(
      "set lmargin at screen {:.4f}; set rmargin at screen {:.4f}\n"
      "set tmargin at screen {:.4f}; set bmargin at screen {:.4f}\n",
      c.left, c.right, c.top, c.bottom);
}

std::string entry_plots(const Bode& bode, const Entry& entry, size_t index, const Cell& cell,
                        bool key) {
  const double split = cell.bottom + 0.36 * (cell.top - cell.bottom);
  const size_t first = 2 + 4 * index;
  const std::string unit = response_unit(bode.options.output, entry.output, entry.input);
  const std::string name =
      entry.output == entry.input
          ? std::string(direction_names[entry.output])
          : fmt::format("{} from {}", direction_names[entry.output], direction_names[entry.input]);
  std::string text = margins({cell.left, cell.right, cell.top, split + 0.006});
  text += fmt::format(
      "set title {} offset 0,-0.6\nset ylabel {} offset 1.2,0\nset format x ''\nset xlabel ''\n",
      quoted(name + (vanishes(bode, entry) ? " (vanishes)" : "")), quoted("dB re 1 " + unit));
  text += key ? "set key top right samplen 2.5 font ',9'\n" : "unset key\n";
  const auto [low, high] = magnitude_range(bode, entry);
  text += fmt::format("set ytics autofreq\nset yrange [{:.3f}:{:.3f}]\n", low, high) +
          peak_labels(bode, entry, high);
  text += fmt::format(
      "plot $bode using 1:{} with lines {} title 'rigid legs', "
      "$bode using 1:{} with lines {} title 'with seals'\n",
      first + 2, rigid_style, first, real_style);
  text += "unset label\nunset title\nunset key\nset autoscale y\n";
  text += margins({cell.left, cell.right, split - 0.006, cell.bottom});
  text +=
      "set format x '%g'\nset xlabel 'Hz' offset 0,0.6\nset ylabel 'phase °' offset 1.2,0\nset "
      "ytics 90\n";
  text += fmt::format("plot $bode using 1:{} with lines {}, $bode using 1:{} with lines {}\n",
                      first + 3, rigid_style, first + 1, real_style);
  return text;
}

struct PictureSize {
  int columns, rows;
  [[nodiscard]] int width() const { return 420 * columns + 40; }
  [[nodiscard]] int height() const { return 400 * rows + 70; }
};

PictureSize picture_size(size_t entries) {
  const int columns = static_cast<int>(std::min<size_t>(3, entries));
  return {columns, static_cast<int>((entries + columns - 1) / columns)};
}

Cell cell_of(const PictureSize& size, size_t index) {
  const int row = static_cast<int>(index) / size.columns,
            column = static_cast<int>(index) % size.columns;
  const double w = 1.0 / size.columns;
  const double top_band = 70.0 / size.height();
  const double h = (1.0 - top_band) / size.rows;
  const double top = 1.0 - top_band - row * h;
  return {column * w + 80.0 / size.width(), (column + 1) * w - 14.0 / size.width(),
          top - 26.0 / size.height(), top - h + 52.0 / size.height()};
}

}  // namespace

std::string bode_script(const Bode& bode, const std::vector<Entry>& entries, const PlotText& text,
                        const std::string& terminal, const std::string& file) {
  const PictureSize size = picture_size(entries.size());
  std::string script =
      fmt::format("set terminal {}\nset output {}\nset encoding utf8\n", terminal, quoted(file));
  script += data_block(bode, entries);
  script +=
      "set multiplot\nset logscale x\nset grid xtics ytics back lt 1 lc rgb '#d0d0d0' lw 0.5\n";
  script += "set tics font ',9'\nset border lw 0.8 lc rgb '#444444'\nset termoption noenhanced\n";
  script += fmt::format("set xrange [{:.9g}:{:.9g}]\n", bode.omega.front() / two_pi,
                        bode.omega.back() / two_pi);
  script += frequency_ticks(bode.omega.front() / two_pi, bode.omega.back() / two_pi);
  script += fmt::format("set label 101 {} at screen 0.5,{:.4f} center font ',14'\n",
                        quoted(text.title), 1.0 - 22.0 / size.height());
  script +=
      fmt::format("set label 102 {} at screen 0.5,{:.4f} center font ',10' tc rgb '#444444'\n",
                  quoted(text.subtitle), 1.0 - 46.0 / size.height());
  for (size_t e = 0; e < entries.size(); ++e) {
    script += entry_plots(bode, entries[e], e, cell_of(size, e), e == 0);
  }
  return script + "unset multiplot\nunset output\n";
}

void plot_bode(const Bode& bode, const std::vector<Entry>& entries, const PlotText& text,
               const std::string& path) {
  const PictureSize size = picture_size(entries.size());
  draw(path, size.width(), size.height(),
       [&](const std::string& terminal, const std::string& file) {
         return bode_script(bode, entries, text, terminal, file);
       });
}

}  // namespace hydrapod::report
