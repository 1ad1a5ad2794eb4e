#include "hydrapod/report/bode.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "hydrapod/base/constants.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/spatial/directions.hpp"

namespace hydrapod::report {

namespace {

using base::two_pi;
using spatial::direction_names;

/// Fills in the band: a third of the lowest to twice the highest frequency that the platform feels.
void fill_band(const modal::ModeTable& table, BodeOptions& options) {
  double lowest = 1e300, highest = 0.0;
  for (const auto* modes : {&table.real.modes, &table.rigid.modes})
    for (const auto& entry : *modes) {
      if (!entry.platform_feels || entry.mode.omega <= 0.0) continue;
      lowest = std::min(lowest, entry.mode.omega);
      highest = std::max(highest, entry.mode.omega);
    }
  if (highest == 0.0 && (!options.from || !options.to))
    throw base::ComputationError(
        "no stable mode that the platform feels; give the band with --from and --to");
  if (!options.from) options.from = std::min(lowest / 3.0, options.to.value_or(lowest) / 3.0);
  if (!options.to) options.to = std::max(2.0 * highest, 3.0 * *options.from);
}

struct Swept {
  std::vector<response::Matrix6c> H;
  std::vector<response::Peak> peaks;
};

Swept sweep(const modal::AnalysedModel& model, double ratio, const Bode& bode) {
  const auto& options = bode.options;
  const auto swept =
      response::response_model(model.linear, model.normal, ratio, *options.p_PQ, options.input);
  return {response::frequency_response(swept, bode.omega, options.output),
          response::find_peaks(swept, {*options.from, *options.to, options.output})};
}

}  // namespace

Bode bode(const model::Machine& machine, const PoseChoice& pose, dynamics::ModelKind kind,
          const BodeOptions& options) {
  Bode result{.options = options, .table = modal::mode_table(machine, pose.X_BP, kind)};
  if (!result.options.p_PQ) result.options.p_PQ = machine.platform.mass_center;
  fill_band(result.table, result.options);
  result.omega = response::log_space(*result.options.from, *result.options.to, options.points);
  auto real = sweep(result.table.real, result.table.ratio.value, result);
  auto rigid = sweep(result.table.rigid, result.table.ratio.value, result);
  result.real = std::move(real.H);
  result.real_peaks = std::move(real.peaks);
  result.rigid = std::move(rigid.H);
  result.rigid_peaks = std::move(rigid.peaks);
  return result;
}

std::string response_unit(response::Output output, int out_direction, int in_direction) {
  const std::string numerator = out_direction < 3 ? "m" : "rad";
  const std::string load = in_direction < 3 ? "N" : "(N m)";
  switch (output) {
    case response::Output::velocity:
      return fmt::format("({}/s)/{}", numerator, load);
    case response::Output::acceleration:
      return fmt::format("({}/s²)/{}", numerator, load);
    case response::Output::displacement:
      break;
  }
  return numerator + "/" + load;
}

Json bode_json(const Bode& bode) {
  constexpr std::array<const char*, 2> inputs{"wrench", "actuator"};
  constexpr std::array<const char*, 3> outputs{"displacement", "velocity", "acceleration"};
  const auto& options = bode.options;
  const auto& p = *options.p_PQ;
  Json json{{"model", dynamics::name(bode.table.kind)},
            {"input", inputs[static_cast<size_t>(options.input)]},
            {"output", outputs[static_cast<size_t>(options.output)]},
            {"point_m", {p.x(), p.y(), p.z()}},
            {"peaks", peaks_json(bode.real_peaks, bode.table, false)},
            {"rigid_peaks", peaks_json(bode.rigid_peaks, bode.table, true)}};
  const Json real = response_json(bode.omega, bode.real);
  json["omega_rad_s"] = real["omega_rad_s"];
  json["frequency_hz"] = real["frequency_hz"];
  json["response"] = real["response"];
  json["rigid_response"] = response_json(bode.omega, bode.rigid)["response"];
  return json;
}

std::string bode_csv(const Bode& bode) {
  std::string text = "frequency_hz,omega_rad_s";
  for (const char* model : {"", "rigid "})
    for (int out = 0; out < 6; ++out)
      for (int in = 0; in < 6; ++in)
        for (const char* part : {"re", "im"})
          text += fmt::format(",{}{} {}/{} [{}]", model, part, direction_names[out],
                              direction_names[in], response_unit(bode.options.output, out, in));
  text += '\n';
  for (size_t i = 0; i < bode.omega.size(); ++i) {
    text += fmt::format("{:.12g},{:.12g}", bode.omega[i] / two_pi, bode.omega[i]);
    for (const auto* H : {&bode.real[i], &bode.rigid[i]})
      for (int out = 0; out < 6; ++out)
        for (int in = 0; in < 6; ++in)
          text += fmt::format(",{:.12g},{:.12g}", (*H)(out, in).real(), (*H)(out, in).imag());
    text += '\n';
  }
  return text;
}

}  // namespace hydrapod::report
