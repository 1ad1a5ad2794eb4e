#include "hydrapod/tasks/linear.hpp"

#include <algorithm>

#include "hydrapod/kinematics/legs.hpp"

namespace hydrapod::tasks {

namespace {

/// Fills in the band: a third of the lowest to twice the highest frequency that the platform feels.
void fill_band(const modal::ModeTable& table, report::BodeOptions& options) {
  double lowest = 1e300, highest = 0.0;
  for (const auto* modes : {&table.real.modes, &table.rigid.modes})
    for (const auto& entry : *modes) {
      if (!entry.moves_platform || entry.mode.omega <= 0.0) continue;
      lowest = std::min(lowest, entry.mode.omega);
      highest = std::max(highest, entry.mode.omega);
    }
  if (highest == 0.0 && (!options.from || !options.to))
    throw base::ComputationError(
        "no stable mode with platform motion; give the band with --from and --to");
  if (!options.from) options.from = std::min(lowest / 3.0, options.to.value_or(lowest) / 3.0);
  if (!options.to) options.to = std::max(2.0 * highest, 3.0 * *options.from);
}

struct Swept {
  std::vector<response::Matrix6c> H;
  std::vector<response::Peak> peaks;
};

Swept sweep(const modal::AnalysedModel& model, const report::Bode& bode) {
  const auto& options = bode.options;
  const auto swept = response::response_model(model.linear, model.normal, bode.table.ratio.value,
                                              *options.p_PQ, options.input);
  return {response::frequency_response(swept, bode.omega, options.output),
          response::find_peaks(swept, {*options.from, *options.to, options.output})};
}

}  // namespace

modal::ModeTable modes(const Machine& machine) {
  return modal::mode_table(machine.file.machine, machine.pose.X_BP, machine.kind);
}

std::optional<modal::ModeTable> modes_without_overrides(const Machine& machine) {
  if (machine.file.overrides.empty()) return {};
  auto kind = machine.kind;
  const auto file =
      model::parse_machine(machine.file.text, machine.path, {}, kinematics::check_machine);
  if (kind == dynamics::ModelKind::full) kind = model_of(file.machine);
  return modal::mode_table(file.machine, pose_of(file.machine, machine.pose.name).X_BP, kind);
}

report::ModesAtAmplitudes modes_at_amplitudes(const Machine& machine,
                                              const std::vector<double>& amplitudes,
                                              const Progress& progress) {
  return {amplitudes, modal::modes_at_amplitudes(machine.file.machine, machine.pose.X_BP,
                                                 machine.kind, amplitudes, {}, progress)};
}

report::Bode bode(const Machine& machine, const report::BodeOptions& options) {
  report::Bode result{.options = options, .table = modes(machine)};
  if (!result.options.p_PQ) result.options.p_PQ = machine.file.machine.platform.mass_center;
  fill_band(result.table, result.options);
  result.omega = response::log_space(*result.options.from, *result.options.to, options.points);
  auto real = sweep(result.table.real, result);
  auto rigid = sweep(result.table.rigid, result);
  result.real = std::move(real.H);
  result.real_peaks = std::move(real.peaks);
  result.rigid = std::move(rigid.H);
  result.rigid_peaks = std::move(rigid.peaks);
  return result;
}

}  // namespace hydrapod::tasks
