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

/// Columns: Hz, then per entry dB and phase of the real model, dB and phase of the rigid one.
std::string data_block(const Bode& bode, const std::vector<Entry>& entries) {
  std::string text;
  std::vector<std::array<double, 2>> last(entries.size(), {0.0, 0.0});
  for (size_t i = 0; i < bode.omega.size(); ++i) {
    text += fmt::format("{:.9g}", bode.omega[i] / two_pi);
    for (size_t e = 0; e < entries.size(); ++e)
      for (int model = 0; model < 2; ++model) {
        const auto value =
            (model == 0 ? bode.real : bode.rigid)[i](entries[e].output, entries[e].input);
        last[e][model] = continued(std::arg(value) * 180.0 / std::numbers::pi, last[e][model]);
        text += fmt::format(" {:.6f} {:.4f}", level_db(std::abs(value)), last[e][model]);
      }
    text += '\n';
  }
  return block_of("bode", text);
}

/// Range of a magnitude axis [dB], with room above for the peaks' labels.
std::array<double, 2> magnitude_range(const Bode& bode, const Entry& entry) {
  double low = 1e300, high = -1e300;
  for (const auto* H : {&bode.real, &bode.rigid})
    for (const auto& h : *H) {
      const double level = level_db(std::abs(h(entry.output, entry.input)));
      if (!std::isfinite(level)) continue;  // an undamped mode met exactly
      low = std::min(low, level);
      high = std::max(high, level);
    }
  for (const auto& peak : bode.real_peaks)
    if (entry.output == entry.input && peak.direction == entry.output &&
        std::isfinite(peak.magnitude))
      high = std::max(high, level_db(peak.magnitude));
  const double span = std::max(high - low, 6.0);
  return {low - 0.05 * span, high + 0.16 * span};
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
          std::min(level_db(peak.magnitude), top));
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

std::string entry_plots(const Bode& bode, const Entry& entry, size_t index, const CellPair& cells,
                        const std::string& key) {
  const size_t first = 2 + 4 * index;
  const std::string unit = response_unit(bode.options.output, entry.output, entry.input);
  const std::string name =
      entry.output == entry.input
          ? std::string(direction_names[entry.output])
          : fmt::format("{} from {}", direction_names[entry.output], direction_names[entry.input]);
  std::string text = at_screen(cells.magnitude);
  text += fmt::format(
      "set title {} offset 0,-0.6\nset ylabel {} offset 1.2,0\nset format x ''\nset xlabel ''\n",
      quoted(name + (vanishes(bode, entry) ? " (vanishes)" : "")), quoted("dB re 1 " + unit));
  text += key;
  const auto [low, high] = magnitude_range(bode, entry);
  text += fmt::format("set ytics autofreq\nset yrange [{:.3f}:{:.3f}]\n", low, high) +
          peak_labels(bode, entry, high);
  text += fmt::format(
      "plot $bode using 1:{} with lines {} title 'with seals', "
      "$bode using 1:{} with lines {} title 'rigid legs'\n",
      first, real_style, first + 2, rigid_style);
  text += "unset label\nunset title\nunset key\nset autoscale y\n";
  text += at_screen(cells.phase);
  text +=
      "set format x '%g'\nset xlabel 'Hz' offset 0,0.6\nset ylabel 'phase °' offset 1.2,0\nset "
      "ytics 90\nset autoscale yfix\nset offsets 0,0,10,10\n";  // curves along the frame are not
                                                                // seen
  text += fmt::format(
      "plot $bode using 1:{} with lines {}, $bode using 1:{} with lines {}\n"
      "unset offsets\nset autoscale y\n",
      first + 1, real_style, first + 3, rigid_style);
  return text;
}

}  // namespace

std::string bode_script(const Bode& bode, const std::vector<Entry>& entries, const PlotText& text,
                        const std::string& terminal, const std::string& file) {
  const CellGrid cells(entries.size());
  const double from = bode.omega.front() / two_pi, to = bode.omega.back() / two_pi;
  std::string script = opened(terminal, file) + data_block(bode, entries);
  script += "set multiplot\n";
  script += std::string(thin_grid) + thin_axes;
  script += logarithmic_axis(from, to);
  script += titles(text.title, text.subtitle, cells.width(), cells.height());
  for (size_t e = 0; e < entries.size(); ++e)
    script += entry_plots(bode, entries[e], e, split(cells[e], cells.height()),
                          e == 0 ? key_below_titles(cells.height()) : "unset key\n");
  return script + "unset multiplot\nunset output\n";
}

void plot_bode(const Bode& bode, const std::vector<Entry>& entries, const PlotText& text,
               const std::string& path) {
  const CellGrid size(entries.size());
  draw(path, size.width(), size.height(),
       [&](const std::string& terminal, const std::string& file) {
         return bode_script(bode, entries, text, terminal, file);
       });
}

}  // namespace hydrapod::report
