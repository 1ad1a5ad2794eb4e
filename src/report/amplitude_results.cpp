#include "hydrapod/report/model_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "fields.hpp"
#include "gnuplot.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::report {

namespace {

constexpr std::array branch_ends{"beyond", "turned", "local", "stopped", "most_steps"};

/// All that was found on a branch in its order, with or without the points at which it turns back.
std::vector<const modal::ModeAtAmplitude*> along(const modal::AmplitudeCurve& curve,
                                                 bool with_turning_points) {
  std::vector<const modal::ModeAtAmplitude*> found;
  for (const auto& point : curve.points)
    if (point.converged) found.push_back(&point);
  for (const auto& point : curve.further) found.push_back(&point);
  if (with_turning_points)
    for (const auto& point : curve.turning)
      if (point.amplitude > curve.points.front().amplitude) found.push_back(&point);
  std::ranges::stable_sort(found, [&](const auto* a, const auto* b) {
    if (a->turns != b->turns) return a->turns < b->turns;
    const bool rises = (a->turns % 2 == 0) != curve.from_long_swings;
    return rises ? a->amplitude < b->amplitude : a->amplitude > b->amplitude;
  });
  return found;
}

}  // namespace

template <class Fields>
void describe(Fields& f, modal::ModeAtAmplitude& point) {
  f("amplitude_m", point.amplitude);
  f("converged", point.converged);
  f("omega_rad_s", point.omega);
  f.derived("frequency_hz", point.omega / base::two_pi);
  f("damping_ratio", point.damping_ratio);
  f("mac", point.mac);
  f("sleeve_amplitude_m", point.sleeve);
  f("piston_amplitude_m", point.piston);
  f("legs_on_guide", point.legs_on_guide);
  f("turns", point.turns);
}

template <class Fields>
void describe(Fields& f, modal::AmplitudeCurve& curve) {
  f.counted("mode", curve.mode);
  f.word("direction", curve.direction, spatial::direction_names);
  f("omega_rad_s", curve.omega);
  f.derived("frequency_hz", curve.omega / base::two_pi);
  f("from_long_swings", curve.from_long_swings);
  f("points", curve.points);
  f("further", curve.further);
  f("turning_points", curve.turning);
  f.word("end", curve.end, branch_ends);
  f("last", curve.last);
}

template <class Fields>
void describe(Fields& f, ModesAtAmplitudes& modes) {
  f("amplitude_m", modes.amplitudes);
  f("curves", modes.curves);
}

Json modes_at_amplitudes_json(const ModesAtAmplitudes& modes) { return written(modes); }

ModesAtAmplitudes modes_at_amplitudes_from_json(const Json& json, const std::string& file) {
  return read<ModesAtAmplitudes>(json, file);
}

std::string modes_at_amplitudes_csv(const ModesAtAmplitudes& modes) {
  std::string text =
      "mode,direction,amplitude_m,frequency_hz,omega_rad_s,damping_ratio,mac,sleeve_amplitude_m,"
      "piston_amplitude_m,from_long_swings,turns,legs_on_guide\n";
  for (const auto& curve : modes.curves)
    for (const auto* point : along(curve, false))
      text += fmt::format(
          "{},{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:d},{},"
          "{}\n",
          curve.mode + 1, spatial::direction_name(curve.direction), point->amplitude,
          point->omega / base::two_pi, point->omega, point->damping_ratio, point->mac,
          point->sleeve, point->piston, static_cast<int>(curve.from_long_swings), point->turns,
          point->legs_on_guide);
  return text;
}

void plot_modes_at_amplitudes(const ModesAtAmplitudes& modes, const std::string& title,
                              const std::string& subtitle, const std::string& path) {
  constexpr int width = 900, height = 760;
  constexpr double millimetres = 1e3;
  // Colours that are told apart by the colour-blind as well (Okabe & Ito).
  constexpr std::array colours{"#0072b2", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#56b4e9"};
  std::string blocks, frequency, damping;
  std::map<int, std::size_t> order;  // of the modes
  bool dashed = false;
  for (const auto& curve : modes.curves) {
    const auto points = along(curve, true);
    if (points.empty()) continue;
    dashed = dashed || curve.from_long_swings;
    std::string rows;
    for (const auto* point : points)
      rows += fmt::format("{:.9g} {:.9g} {:.9g}\n", millimetres * point->amplitude,
                          point->omega / base::two_pi, 100.0 * point->damping_ratio);
    const auto name = fmt::format("mode{}{}", curve.mode, curve.from_long_swings ? "long" : "");
    blocks += block_of(name, rows);
    const std::size_t k = order.try_emplace(curve.mode, order.size()).first->second;
    const auto style = fmt::format("with linespoints lw 1.6 pt {} ps 0.4 lc rgb '{}' dt {}",
                                   k < colours.size() ? 7 : 8, colours[k % colours.size()],
                                   curve.from_long_swings ? 2 : 1);
    const auto caption =
        curve.from_long_swings
            ? std::string("notitle")
            : "title " + quoted(fmt::format("mode {}, {}", curve.mode + 1,
                                            spatial::direction_name(curve.direction)));
    const char* const separator = frequency.empty() ? "plot " : ", ";
    frequency += fmt::format("{}${} using 1:2 {} {}", separator, name, style, caption);
    damping += fmt::format("{}${} using 1:3 {} notitle", separator, name, style);
  }
  const auto cell = [](double bottom, double top) {
    return at_screen({.left = 0.11, .right = 0.97, .top = top, .bottom = bottom});
  };
  draw(path, width, height,
       std::string(thin_grid) + thin_axes + titles(title, subtitle, width, height) +
           key_below_titles(height) + "set key at screen 0.5,0.9 maxcols 6\n" + blocks +
           "set multiplot\nset logscale x\nset format x '%g'\nset ylabel 'frequency Hz'\n" +
           "set ylabel offset 1,0\n" + cell(0.50, 0.86) + "set xlabel ''\n" + frequency +
           "\nunset label 101\nunset label 102\nset ylabel 'damping ratio %'\n" +
           fmt::format("set xlabel 'amplitude of the platform joint that moves most, mm{}'\n",
                       dashed ? " (dashed: branches from long swings)" : "") +
           cell(0.09, 0.44) + damping + "\nunset multiplot\n");
}

}  // namespace hydrapod::report
