#include "hydrapod/bode_report.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "hydrapod/terminal.hpp"

namespace hydrapod::cli {

namespace {

constexpr std::array<const char*, 6> directions{"x", "y", "z", "rx", "ry", "rz"};
constexpr double two_pi = 2.0 * std::numbers::pi;

std::string peak_table(const report::Bode& bode, const std::vector<response::Peak>& peaks,
                       const modal::AnalysedModel& model, bool colour) {
  Table table({{"direction", Align::left},
               {"Hz"},
               {"rad/s"},
               {"height"},
               {"unit", Align::left},
               {"above valley dB"},
               {"mode"},
               {"of", Align::left}});
  for (const auto& peak : peaks) {
    const int mode = model.tabled_of_normal[peak.mode];
    const std::string prominence =
        std::isinf(peak.prominence_db) ? "highest" : fmt::format("{:.1f}", peak.prominence_db);
    table.add_row({directions[peak.direction], fmt::format("{:.3f}", peak.omega / two_pi),
                   fmt::format("{:.3f}", peak.omega), fmt::format("{:.3e}", peak.magnitude),
                   report::response_unit(bode.options.output, peak.direction, peak.direction),
                   prominence, fmt::format("{}", mode + 1),
                   model.modes[mode].label + (peak.own ? "" : " (coupled)")});
  }
  return table.text(colour);
}

std::string count_text(const std::vector<response::Peak>& peaks) {
  std::string text;
  for (int d = 0; d < 6; ++d)
    text +=
        fmt::format("{}{} {}", d == 0 ? "" : ", ", directions[d], response::count_own(peaks, d));
  return text;
}

}  // namespace

std::string peak_text(const report::Bode& bode, bool colour) {
  const bool flexible = bode.table.kind != dynamics::ModelKind::rigid;
  std::string text;
  if (flexible)
    text = "Peaks of the direct responses\n" +
           peak_table(bode, bode.real_peaks, bode.table.real, colour) + "\nWith rigid legs\n";
  text += peak_table(bode, bode.rigid_peaks, bode.table.rigid, colour);
  text += "\nResonances of its own per direction (coupled ones left out)\n";
  if (flexible) text += fmt::format("  with seals  {}\n", count_text(bode.real_peaks));
  return text + fmt::format("  rigid legs  {}\n", count_text(bode.rigid_peaks));
}

report::PlotText plot_text(const model::Machine& machine, const report::PoseChoice& pose,
                           const report::Bode& bode) {
  constexpr std::array<const char*, 2> inputs{"wrench", "actuator forces"};
  constexpr std::array<const char*, 3> outputs{"displacement", "velocity", "acceleration"};
  const auto& p = *bode.options.p_PQ;
  return {
      fmt::format("{}: {} from {}", machine.name, outputs[static_cast<size_t>(bode.options.output)],
                  inputs[static_cast<size_t>(bode.options.input)]),
      fmt::format("pose {}; point ({:.4g}, {:.4g}, {:.4g}) m of the platform; {}; damping: {}",
                  pose.name, p.x(), p.y(), p.z(), report::gravity_text(machine),
                  report::damping_text(machine))};
}

}  // namespace hydrapod::cli
