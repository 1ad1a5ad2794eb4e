#include "hydrapod/report/measured_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "gnuplot.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/identification/identify.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "hydrapod/report/model_results.hpp"

namespace hydrapod::report {

namespace {

using base::two_pi;
using Eigen::Index;
using identification::FrequencyResponses;
constexpr double degree = 180.0 / std::numbers::pi;

struct Pair {
  Index output, input;
};

/// At most 12 entries: the direct ones of a square response, else the first.
std::vector<Pair> shown_pairs(const FrequencyResponses& r) {
  constexpr std::size_t most = 12;
  const auto outputs = static_cast<Index>(r.outputs.size()),
             inputs = static_cast<Index>(r.inputs.size());
  std::vector<Pair> pairs;
  if (outputs == inputs) {
    for (Index k = 0; k < outputs; ++k) pairs.push_back({k, k});
  } else {
    for (Index o = 0; o < outputs; ++o)
      for (Index i = 0; i < inputs; ++i) pairs.push_back({o, i});
  }
  if (pairs.size() > most) pairs.resize(most);
  return pairs;
}

/// What of the whole a picture shows, where it is not all.
std::string shown_of(const FrequencyResponses& r, std::size_t shown) {
  const std::size_t all = r.outputs.size() * r.inputs.size();
  return shown == all ? "" : fmt::format("; shown: {} of {} responses", shown, all);
}

/// Does any output follow the inputs about line `k`? Of K averages noise alone has a coherence of
/// p/K for p inputs.
bool is_coherent(const FrequencyResponses& r, std::size_t k) {
  constexpr std::size_t to_each_side = 2;
  const std::size_t from = k - std::min(k, to_each_side);
  const std::size_t end = std::min(r.lines(), k + to_each_side + 1);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(r.multiple_coherence[k].size());
  for (std::size_t j = from; j < end; ++j) sum += r.multiple_coherence[j];
  const double of_noise = static_cast<double>(r.inputs.size()) / r.averages;
  return sum.maxCoeff() >= 0.5 * (1.0 + of_noise) * static_cast<double>(end - from);
}

/// Lines that a picture shows: noise alone would fill the rest of a logarithmic axis.
std::size_t lines_shown(const FrequencyResponses& r) {
  constexpr double room = 1.25;
  if (r.multiple_coherence.size() != r.lines() ||
      r.averages <= static_cast<double>(r.inputs.size()))
    return r.lines();
  std::size_t last = r.lines();
  while (last > 0 && !is_coherent(r, last - 1)) --last;
  if (last == 0) return r.lines();
  const double to = room * r.frequency[last - 1];
  const auto end = std::ranges::upper_bound(r.frequency, to);
  return static_cast<std::size_t>(end - r.frequency.begin());
}

std::string shown_lines_text(const FrequencyResponses& r, std::size_t lines) {
  return lines == r.lines()
             ? ""
             : fmt::format("; beyond {:.3g} Hz there is noise alone", r.frequency[lines - 1]);
}

/// Frequencies far apart have a logarithmic axis.
bool is_wide(const FrequencyResponses& r, std::size_t lines) {
  constexpr double wide = 20.0;
  return r.frequency.front() > 0.0 && r.frequency[lines - 1] > wide * r.frequency.front();
}

std::string values_of(const FrequencyResponses& r, const identification::ModalModel* model,
                      const Pair& pair, std::size_t k, double radius, double cut) {
  const auto [o, i] = pair;
  const auto h = r.H[k](o, i);
  const double band = r.has_errors() ? radius * std::sqrt(r.variance(k, o, i)) : 0.0;
  std::string text =
      fmt::format(" {:.4f} {:.4f} {:.4f} {:.3f}", level_db(std::abs(h)),
                  level_db(std::max(std::abs(h) - band, 0.1 * std::abs(h))),
                  level_db(std::abs(h) + band), within_turn(std::arg(h) * degree, cut));
  if (model == nullptr) return text + " NaN NaN";
  const auto fit = identification::synthesised(*model, r.frequency[k], r.shift)(o, i);
  return text + fmt::format(" {:.4f} {:.3f}", level_db(std::abs(fit)),
                            within_turn(std::arg(fit) * degree, cut));
}

/// One for what was measured and for the model.
double common_cut(const FrequencyResponses& r, const identification::ModalModel* model,
                  const Pair& pair, std::size_t shown) {
  std::vector<double> phases;
  for (std::size_t k = 0; k < shown; ++k) {
    phases.push_back(std::arg(r.H[k](pair.output, pair.input)) * degree);
    if (model != nullptr)
      phases.push_back(std::arg(identification::synthesised(*model, r.frequency[k], r.shift)(
                           pair.output, pair.input)) *
                       degree);
  }
  return phase_cut(phases);
}

/// Of lines that share a pixel the lowest and the highest of each entry, in their order: the curve
/// looks the same, and a picture of a long record stays small.
std::string data_block(const FrequencyResponses& r, const identification::ModalModel* model,
                       const std::vector<Pair>& pairs, std::size_t shown) {
  constexpr int most_stretches = 400;  // a panel is 340 pixels wide
  const double radius = identification::confidence_radius(0.95, r.degrees);
  const std::vector<double> frequency(r.frequency.begin(),
                                      r.frequency.begin() + static_cast<Index>(shown));
  const auto begins = stretches_of(frequency, is_wide(r, shown), most_stretches);
  std::vector<double> cuts;
  for (const auto& pair : pairs) cuts.push_back(common_cut(r, model, pair, shown));
  std::string text;
  for (std::size_t s = 0; s + 1 < begins.size(); ++s) {
    const std::size_t first = begins[s], end = begins[s + 1];
    const std::size_t rows = std::min<std::size_t>(2, end - first);
    std::vector<std::string> lines{fmt::format("{:.9g}", r.frequency[first]),
                                   fmt::format("{:.9g}", r.frequency[end - 1])};
    for (std::size_t e = 0; e < pairs.size(); ++e) {
      const auto& pair = pairs[e];
      std::size_t least = first, most = first;
      const auto level = [&](std::size_t k) { return std::abs(r.H[k](pair.output, pair.input)); };
      for (std::size_t k = first; k < end; ++k) {
        if (level(k) < level(least)) least = k;
        if (level(k) >= level(most)) most = k;
      }
      const std::array at{std::min(least, most), std::max(least, most)};
      for (std::size_t row = 0; row < rows; ++row)
        lines[row] += values_of(r, model, pair, at[row], radius, cuts[e]);
    }
    for (std::size_t row = 0; row < rows; ++row) text += lines[row] + '\n';
  }
  return block_of("frf", text);
}

/// Over the first `lines`, logarithmic where they are far apart.
std::string frequency_axis(const FrequencyResponses& r, std::size_t lines) {
  const double from = r.frequency.front(), to = r.frequency[lines - 1];
  return thin_grid + (is_wide(r, lines) ? logarithmic_axis(from, to)
                                        : fmt::format("set xrange [{:.9g}:{:.9g}]\n", from, to));
}

/// From what the output follows: where noise alone is divided by hardly any excitation, quotients
/// of any size would set the scale.
std::string magnitude_axis(const FrequencyResponses& r, const Pair& pair, std::size_t lines) {
  const std::string whole = "set autoscale y\n";
  if (r.multiple_coherence.size() != r.lines() ||
      r.averages <= static_cast<double>(r.inputs.size()))
    return whole;
  const double least = 0.5 * (1.0 + static_cast<double>(r.inputs.size()) / r.averages);
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (std::size_t k = 0; k < lines; ++k) {
    const double level = level_db(std::abs(r.H[k](pair.output, pair.input)));
    if (!std::isfinite(level) || !is_coherent(r, k)) continue;
    if (r.multiple_coherence[k](pair.output) < least) continue;
    low = std::min(low, level);
    high = std::max(high, level);
  }
  if (!(high > low)) return whole;
  const double room = std::max(0.08 * (high - low), 1.0);
  return fmt::format("set yrange [{:.3f}:{:.3f}]\n", low - 2.0 * room, high + room);
}

/// Magnitude above phase of one entry.
std::string entry_plots(const FrequencyResponses& r, const Pair& pair, std::size_t index,
                        bool with_fit, const CellPair& cells, const std::string& key) {
  const std::size_t first = 2 + 6 * index;
  const auto& out = r.outputs[static_cast<std::size_t>(pair.output)];
  const auto& in = r.inputs[static_cast<std::size_t>(pair.input)];
  const std::string unit = response_unit(out.unit, in.unit);
  std::string text = at_screen(cells.magnitude);
  text += fmt::format(
      "set title {} offset 0,-0.6\nset ylabel {} offset 1.2,0\nset format x ''\n"
      "set xlabel ''\nset ytics autofreq\n",
      quoted(out.name + " from " + in.name), quoted("dB re 1 " + unit));
  text += key;
  text += fmt::format(
      "plot $frf using 1:{}:{} with filledcurves fc rgb '#c8dcec' title '95 %', "
      "$frf using 1:{} with lines lw 1.2 lc rgb '#0072b2' title 'measured'",
      first + 1, first + 2, first);
  if (with_fit)
    text += fmt::format(", $frf using 1:{} with lines lw 1.2 dt 2 lc rgb '#d55e00' title 'modes'",
                        first + 4);
  text += "\nunset label\nunset title\nunset key\nset autoscale y\n" + at_screen(cells.phase);
  text +=
      "set format x '%g'\nset xlabel 'Hz' offset 0,0.6\nset ylabel 'phase °' offset 1.2,0\n"
      "set ytics 90\nset autoscale yfix\nset offsets 0,0,10,10\n";
  text += fmt::format("plot $frf using 1:{} with points pt 7 ps 0.25 lc rgb '#0072b2'", first + 3);
  if (with_fit)
    text += ", " + phase_line("frf", static_cast<int>(first) + 5, "lw 1 dt 2 lc rgb '#d55e00'");
  return text + "\nunset offsets\nset autoscale y\n";
}

}  // namespace

std::string response_unit(const std::string& output, const std::string& input) {
  if (input == "1" || input.empty()) return output;
  const bool compound = input.find_first_of(" /") != std::string::npos;
  return output + (compound ? "/(" + input + ")" : "/" + input);
}

void require_picture(const std::string& path) { require_picture_ending(path); }

void plot_responses(const FrequencyResponses& r, const identification::ModalModel* model,
                    const PlotText& text, const std::string& path) {
  const auto pairs = shown_pairs(r);
  const auto lines = lines_shown(r);
  const CellGrid cells(pairs.size());
  std::string script =
      titles(text.title, text.subtitle + shown_of(r, pairs.size()) + shown_lines_text(r, lines),
             cells.width(), cells.height()) +
      thin_axes + data_block(r, model, pairs, lines) + "set multiplot\n" + frequency_axis(r, lines);
  for (std::size_t e = 0; e < pairs.size(); ++e)
    script += entry_plots(r, pairs[e], e, model != nullptr, split(cells[e], cells.height()),
                          (e == 0 ? key_below_titles(cells.height()) : "unset key\n") +
                              magnitude_axis(r, pairs[e], lines));
  draw(path, cells.width(), cells.height(), script + "unset multiplot\n");
}

namespace {

std::string condition_panel() {
  return "unset label\nunset key\n" + at_screen({0.08, 0.97, 0.39, 0.09}) +
         "set format x '%g'\nset xlabel 'Hz'\nset ylabel 'condition of the inputs'\n"
         "set logscale y\nset yrange [0.8:*]\nplot $c using 1:2 with lines lw 1 lc rgb "
         "'#444444'\n";
}

}  // namespace

void plot_coherence(const FrequencyResponses& r, const PlotText& text, const std::string& path) {
  const bool several = r.inputs.size() > 1;  // one has no condition
  constexpr int width = 1000;
  const int height = several ? 620 : 400;
  constexpr std::size_t most_named = 16;
  const std::size_t count = r.outputs.size();
  const auto shown = lines_shown(r);
  std::string rows, lines;
  for (std::size_t k = 0; k < shown; ++k) {
    std::vector<double> all(r.multiple_coherence[k].begin(), r.multiple_coherence[k].end());
    rows += fmt::format("{:.9g} {:.6g} {:.6g}", r.frequency[k], r.condition[k],
                        numerics::upper_median(all));
    for (const double c : r.multiple_coherence[k]) rows += fmt::format(" {:.6g}", c);
    rows += '\n';
  }
  for (std::size_t o = 0; o < count; ++o) {
    lines += fmt::format("{}$c using 1:{} with lines ", o == 0 ? "" : ", ", o + 4);
    if (count <= most_named)
      lines += fmt::format("lw 1 title {}", quoted(r.outputs[o].name));
    else
      lines += "lw 0.6 lc rgb '#b9c4cf' " +
               (o == 0 ? quoted(fmt::format("{} outputs", count)).insert(0, "title ") : "notitle");
  }
  if (count > most_named)
    lines += ", $c using 1:3 with lines lw 1.4 lc rgb '#0072b2' title 'median'";
  draw(path, width, height,
       titles(text.title, text.subtitle + shown_lines_text(r, shown), width, height) + thin_axes +
           block_of("c", rows) + "set multiplot\n" + frequency_axis(r, shown) +
           at_screen({0.08, 0.97, several ? 0.86 : 0.79, several ? 0.42 : 0.14}) +
           "set yrange [0:1.02]\nset ylabel 'multiple coherence'\n" +
           (several ? "set format x ''\n" : "set xlabel 'Hz'\n") + key_below_titles(height) +
           "set key maxcols 8\nplot " + lines + "\n" + (several ? condition_panel() : "") +
           "unset multiplot\n");
}

namespace {

/// How poles of each level of agreement are drawn, in the order of the levels.
struct MarkStyle {
  const char* title;
  const char* style;
};
constexpr std::array<MarkStyle, 4> mark_styles{
    MarkStyle{"new", "pt 6 ps 0.45 lc rgb '#8a949e'"},
    MarkStyle{"frequency agrees", "pt 9 ps 0.7 lc rgb '#c79a00'"},
    MarkStyle{"and damping", "pt 13 ps 0.75 lc rgb '#b5530a'"},
    MarkStyle{"and shape", "pt 7 ps 0.6 lc rgb '#0072b2'"}};

/// A block of poles per level of agreement, then those of modes.
std::string chart_blocks(const identification::Identification& result) {
  constexpr const char* nothing = "0 -9\n";  // a block must not be empty
  const auto stability = identification::pole_stability(result.chart);
  std::string text, taken;
  for (std::size_t level = 0; level < mark_styles.size(); ++level) {
    std::string poles;
    for (std::size_t n = 0; n < result.chart.size(); ++n)
      for (std::size_t i = 0; i < result.chart[n].poles.size(); ++i)
        if (const auto& e = result.chart[n].poles[i];
            e.pole.real() < 0.0 && static_cast<std::size_t>(stability[n][i]) == level)
          poles += fmt::format("{:.7g} {}\n", e.omega() / two_pi, result.chart[n].order);
    text += block_of(fmt::format("level{}", level), poles + nothing);
  }
  for (const auto& cluster : result.clusters)
    for (const auto& [n, i] : cluster.members)
      taken += fmt::format("{:.7g} {}\n", result.chart[n].poles[i].omega() / two_pi,
                           result.chart[n].order);
  return text + block_of("taken", taken + nothing);
}

std::string indicator_block(const identification::Identification& result) {
  const auto indicator = identification::mode_indicator(result.responses);
  std::string text;
  for (Index k = 0; k < indicator.rows(); ++k) {
    text += fmt::format("{:.7g}", result.responses.frequency[static_cast<std::size_t>(k)]);
    for (const double s : indicator.row(k)) text += fmt::format(" {:.4f}", level_db(s));
    text += '\n';
  }
  return block_of("cmif", text);
}

}  // namespace

void plot_stabilisation(const identification::Identification& result, const PlotText& text,
                        const std::string& path) {
  constexpr int width = 1000, height = 640;
  const auto curves = std::min(result.responses.outputs.size(), result.responses.inputs.size());
  std::string script = titles(text.title, text.subtitle, width, height) + thin_axes +
                       chart_blocks(result) + indicator_block(result);
  const int top = result.chart.empty() ? 1 : result.chart.back().order;
  script += fmt::format(
      "{}set xrange [{:.7g}:{:.7g}]\nset yrange [0:{}]\nset y2tics font ',9'\n"
      "set ytics nomirror\nset xlabel 'Hz' offset 0,0.7\nset ylabel 'model order'\n"
      "set y2label 'mode indicator: singular values of H, dB'\n"
      "set tmargin at screen {:.4f}\nset rmargin at screen 0.92\n"
      "set key outside bottom center horizontal samplen 1.5 font ',9'\n",
      thin_grid, result.from, result.to, top + 2, 1.0 - 66.0 / height);
  for (const auto& mode : result.modes)
    script += fmt::format(
        "set arrow from {0:.7g},0 to {0:.7g},{1} nohead back lw 0.7 dt 3 lc rgb '#222222'\n",
        mode.fit.omega() / two_pi, top + 2);
  script += "plot ";
  for (std::size_t s = 0; s < curves; ++s)
    script += fmt::format("$cmif using 1:{} axes x1y2 with lines lw {} lc rgb '#a9b2bd' {}, ",
                          s + 2, s == 0 ? 1.6 : 0.8, s == 0 ? "title 'mode indicator'" : "notitle");
  for (std::size_t level = 0; level < mark_styles.size(); ++level)
    script += fmt::format("$level{} using 1:2 with points {} title '{}', ", level,
                          mark_styles[level].style, mark_styles[level].title);
  draw(path, width, height,
       script +
           "$taken using 1:2 with points pt 6 ps 0.95 lw 1.1 lc rgb '#222222' title 'of a mode'\n");
}

}  // namespace hydrapod::report
