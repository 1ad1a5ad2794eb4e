#include <fmt/format.h>

#include <array>
#include <cmath>

#include "hydrapod/base/units.hpp"
#include "hydrapod/reports.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::cli {

namespace {

using base::two_pi;
using spatial::direction_names;

std::string peak_table(const report::Bode& bode, const std::vector<response::Peak>& peaks,
                       const modal::AnalysedModel& model, const TableStyle& style) {
  if (peaks.empty()) return "none in this band\n";
  Table table({"<direction", "Hz", "rad/s", "height", "<unit", "prominence dB", "mode",
               "<motion, compliance"});
  for (const auto& peak : peaks) {
    const int mode = model.tabled_of_normal[peak.mode];
    const std::string prominence =
        std::isinf(peak.prominence_db) ? "highest" : fmt::format("{:.1f}", peak.prominence_db);
    table.add_row(
        {direction_names[peak.direction], hertz(peak.omega), fmt::format("{:.3f}", peak.omega),
         std::isinf(peak.magnitude) ? "unbounded" : fmt::format("{:.3e}", peak.magnitude),
         report::response_unit(bode.options.output, peak.direction, peak.direction), prominence,
         fmt::format("{}", mode + 1), model.modes[mode].label + (peak.own ? "" : " (coupled)")});
  }
  return table.text(style);
}

constexpr std::array<const char*, 2> inputs{"wrench", "actuator forces"};
constexpr std::array<const char*, 3> outputs{"displacement", "velocity", "acceleration"};

std::string output_from_input(const report::BodeOptions& options) {
  return fmt::format("{} from {}", outputs[static_cast<size_t>(options.output)],
                     inputs[static_cast<size_t>(options.input)]);
}

std::string point_of_platform(const report::BodeOptions& options) {
  const auto& p = *options.p_PQ;
  return fmt::format("point ({:.4g}, {:.4g}, {:.4g}) m of the platform", p.x(), p.y(), p.z());
}

std::string count_text(const std::vector<response::Peak>& peaks) {
  std::string text;
  for (int d = 0; d < 6; ++d)
    text += fmt::format("{}{} {}", d == 0 ? "" : ", ", direction_names[d],
                        response::count_own(peaks, d));
  return text;
}

}  // namespace

std::string peak_text(const report::Bode& bode, const TableStyle& style) {
  const bool flexible = bode.table.kind != dynamics::ModelKind::rigid;
  std::string text =
      fmt::format("{}; {}; {:.4g} Hz to {:.4g} Hz\n\nPeaks of the direct responses\n",
                  output_from_input(bode.options), point_of_platform(bode.options),
                  *bode.options.from / two_pi, *bode.options.to / two_pi);
  if (flexible)
    text += peak_table(bode, bode.real_peaks, bode.table.real, style) + "\nWith rigid legs\n";
  text += peak_table(bode, bode.rigid_peaks, bode.table.rigid, style);
  text += "\nResonances per direction, without coupled ones\n";
  if (flexible) text += fmt::format("  with seals  {}\n", count_text(bode.real_peaks));
  return text + fmt::format("  rigid legs  {}\n", count_text(bode.rigid_peaks));
}

report::PlotText plot_text(const tasks::Machine& subject, const report::Bode& bode) {
  const auto& machine = subject.file.machine;
  return {fmt::format("{}: {}", machine.name, output_from_input(bode.options)),
          fmt::format("pose {}; {}; {}; damping: {}; machine: {}", subject.pose.name,
                      point_of_platform(bode.options), report::gravity_text(machine),
                      report::damping_text(machine), report::mechanics_state_text(subject.file))};
}

}  // namespace hydrapod::cli
