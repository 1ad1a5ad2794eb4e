#include "beside_open.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "names.hpp"

namespace hydrapod::identification {

namespace {

bool overlap(Complex a, Complex b, double share) {
  return std::abs(a - b) < share * (std::abs(a.real()) + std::abs(b.real()));
}

/// Poles whose frequency or damping is open beside a mode of the model, each once.
std::vector<Complex> open_poles(const Identification& result, const BesideOpenOptions& rules) {
  std::vector<Complex> poles;
  for (const auto& [pole, reason] : result.left_out) {
    if (reason != Objection::open_frequency && reason != Objection::open_damping) continue;
    const auto beside = [&](Complex other, double share) { return overlap(pole, other, share); };
    const bool known = std::ranges::any_of(poles, [&](Complex p) { return beside(p, 0.5); });
    const bool overlaps = std::ranges::any_of(
        result.model.modes, [&](const FittedMode& m) { return beside(m.pole, rules.overlap); });
    if (!known && overlaps && poles.size() < rules.most) poles.push_back(pole);
  }
  return poles;
}

/// The model with one pole more beside each mode that `pole` overlaps, in the directions of that
/// mode; the modes of the model come first.
std::vector<PoleEstimate> with_pole(const ModalModel& model, Complex pole, double share) {
  std::vector<PoleEstimate> start(model.modes.begin(), model.modes.end());
  for (const auto& mode : model.modes)
    if (overlap(pole, mode.pole, share))
      start.push_back({.pole = pole, .shape = mode.shape, .participation = mode.participation});
  return start;
}

}  // namespace

void widen_beside_open_poles(const IdentifyOptions& options, Identification& result,
                             const BesideOpenOptions& rules) {
  auto& modes = result.model.modes;
  const auto poles = open_poles(result, rules);
  auto fit = options.fit;
  fit.deviations = Deviations::poles;
  fit.highest_residual_power =
      lowest_residual_power + static_cast<int>(result.model.residuals.size()) - 1;
  const auto own = modes;
  for (const auto pole : poles) {
    const auto more =
        fit_modes(result.responses, with_pole(result.model, pole, rules.overlap), fit);
    const bool stands_out = std::any_of(
        more.modes.begin() + std::ssize(own), more.modes.end(),
        [&](const FittedMode& m) { return m.significance >= options.least_significance; });
    if (!stands_out || !(more.misfit < result.model.misfit)) continue;
    for (std::size_t r = 0; r < own.size(); ++r) {
      if (!overlap(pole, own[r].pole, rules.overlap)) continue;
      const auto widen = [](double& deviation, double difference) {
        if (std::isfinite(difference)) deviation = std::hypot(deviation, difference);
      };
      widen(modes[r].omega_deviation, more.modes[r].omega() - own[r].omega());
      widen(modes[r].damping_deviation, more.modes[r].damping_ratio() - own[r].damping_ratio());
    }
  }
}

}  // namespace hydrapod::identification
