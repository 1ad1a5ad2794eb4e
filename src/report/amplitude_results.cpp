#include "hydrapod/report/model_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "fields.hpp"
#include "gnuplot.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::report {

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
}

template <class Fields>
void describe(Fields& f, modal::AmplitudeCurve& curve) {
  f.counted("mode", curve.mode);
  f.word("direction", curve.direction, spatial::direction_names);
  f("omega_rad_s", curve.omega);
  f.derived("frequency_hz", curve.omega / base::two_pi);
  f("points", curve.points);
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
      "piston_amplitude_m,legs_on_guide\n";
  for (const auto& curve : modes.curves)
    for (const auto& point : curve.points)
      if (point.converged)
        text +=
            fmt::format("{},{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{}\n",
                        curve.mode + 1, spatial::direction_name(curve.direction), point.amplitude,
                        point.omega / base::two_pi, point.omega, point.damping_ratio, point.mac,
                        point.sleeve, point.piston, point.legs_on_guide);
  return text;
}

void plot_modes_at_amplitudes(const ModesAtAmplitudes& modes, const std::string& title,
                              const std::string& subtitle, const std::string& path) {
  constexpr int width = 900, height = 760;
  constexpr double millimetres = 1e3;
  // Colours that are told apart by the colour-blind as well (Okabe & Ito).
  constexpr std::array colours{"#0072b2", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#56b4e9"};
  std::string blocks, frequency, damping;
  for (std::size_t k = 0; k < modes.curves.size(); ++k) {
    const auto& curve = modes.curves[k];
    std::string rows;
    for (const auto& point : curve.points)
      if (point.converged)
        rows += fmt::format("{:.9g} {:.9g} {:.9g}\n", millimetres * point.amplitude,
                            point.omega / base::two_pi, 100.0 * point.damping_ratio);
    const std::string name = fmt::format("mode{}", k);
    blocks += block_of(name, rows);
    const std::string style = fmt::format("with linespoints lw 1.6 pt 7 ps 0.4 lc rgb '{}' dt {}",
                                          colours[k % colours.size()], k / colours.size() + 1);
    frequency += fmt::format("{}${} using 1:2 {} title {}", k == 0 ? "plot " : ", ", name, style,
                             quoted(fmt::format("mode {}, {}", curve.mode + 1,
                                                spatial::direction_name(curve.direction))));
    damping += fmt::format("{}${} using 1:3 {} notitle", k == 0 ? "plot " : ", ", name, style);
  }
  const auto cell = [](double bottom, double top) {
    return at_screen({.left = 0.09, .right = 0.97, .top = top, .bottom = bottom});
  };
  draw(path, width, height,
       std::string(thin_grid) + thin_axes + titles(title, subtitle, height) +
           key_below_titles(height) + blocks +
           "set multiplot\nset logscale x\nset format x '%g'\nset ylabel 'frequency Hz'\n" +
           cell(0.50, 0.86) + "set xlabel ''\n" + frequency +
           "\nunset label 101\nunset label 102\nset ylabel 'damping ratio %'\n" +
           "set xlabel 'amplitude of the platform joint that moves most, mm'\n" + cell(0.09, 0.44) +
           damping + "\nunset multiplot\n");
}

}  // namespace hydrapod::report
