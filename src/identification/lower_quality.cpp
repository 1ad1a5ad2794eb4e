#include "lower_quality.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "names.hpp"

namespace hydrapod::identification {

namespace {

using Kind = data::ResponseWarning::Kind;

void limit(IdentifiedMode& mode, double most) {
  mode.explained = std::min(mode.explained, std::clamp(most, 0.0, 1.0));
}

void limit_all(double most, Identification& result) {
  for (auto& mode : result.modes) limit(mode, most);
}

/// Modes whose half-power band reaches into lines at which the excitation is weak.
void lower_where_weak(const data::ResponseWarning& warning, Identification& result) {
  for (auto& mode : result.modes) {
    const double f = mode.fit.omega() / two_pi, wide = mode.fit.damping_ratio() * f;
    if (f + wide >= warning.lowest && f - wide <= warning.highest) limit(mode, warning.share);
  }
}

/// Modes beside what was left out for a vibration, whose flanks are wider than what was left out:
/// none of the quality at its edge, all as far away as it is wide; and by the share of the
/// half-power band in there.
void lower_where_left_out(const data::ResponseWarning& warning, Identification& result) {
  const double width = warning.highest - warning.lowest;
  for (auto& mode : result.modes) {
    const double f = mode.fit.omega() / two_pi,
                 wide = std::max(mode.fit.damping_ratio() * f, 1e-9 * f);
    const double away = std::max({0.0, warning.lowest - f, f - warning.highest});
    limit(mode, away / std::max(width, 1e-300));
    const double out = std::min(f + wide, warning.highest) - std::max(f - wide, warning.lowest);
    if (out > 0.0) limit(mode, 1.0 - out / (2.0 * wide));
  }
}

/// Share of an output in a mode, each output in proportion to its own responses; of an input, and
/// of a sensor from which directions of the platform were made, 1.
double share_in(const FrequencyResponses& responses, const VectorXd& size, const FittedMode& mode,
                const std::string& channel) {
  const auto at = std::ranges::find(responses.outputs, channel, &data::Channel::name);
  if (at == responses.outputs.end()) return 1.0;
  const VectorXd power = mode.shape.cwiseAbs2().cwiseQuotient(size);
  return power[at - responses.outputs.begin()] / std::max(power.sum(), 1e-300);
}

void lower_where_clipped(const FrequencyResponses& responses, const LowerQualityOptions& options,
                         Identification& result) {
  VectorXd size = VectorXd::Constant(std::ssize(result.responses.outputs), 1e-300);
  for (const auto& H : std::as_const(result.responses.H)) size += H.rowwise().squaredNorm();
  for (auto& mode : result.modes) {
    double power = 0.0;
    for (const auto& warning : responses.warnings)
      if (warning.kind == Kind::clipped)
        power += warning.value * share_in(result.responses, size, mode.fit, warning.channel);
    if (power > 0.0) limit(mode, std::sqrt(options.harmless / power));
  }
}

}  // namespace

void lower_quality(const FrequencyResponses& responses, Identification& result,
                   const LowerQualityOptions& options) {
  for (const auto& warning : responses.warnings) {
    if (warning.kind == Kind::weak_excitation) lower_where_weak(warning, result);
    if (warning.kind == Kind::wandering_tone) lower_where_left_out(warning, result);
    if (warning.kind == Kind::rings) limit_all(options.ringing, result);
    if (warning.kind == Kind::cut_sweep) limit_all(options.cut_sweep, result);
    if (warning.kind == Kind::run_up) limit_all(options.run_up, result);
    // a resonance in blocks that hold a jump is wider than it is
    if (warning.kind == Kind::lost_rows && warning.total == 0)
      limit_all(1.0 - warning.share, result);
    // a channel that was left out is no channel of a mode
    if (warning.kind == Kind::slow_channel && warning.count == 0)
      limit_all(1.0 - warning.share, result);
  }
  lower_where_clipped(responses, options, result);
}

}  // namespace hydrapod::identification
