#include "weak_excitation.hpp"

namespace hydrapod::identification {

ForeignLoop weak_loop(double level, std::uint64_t seed) {
  return {.excitation = Excitation::noise, .level = level, .seed = seed};
}

std::vector<data::ResponseWarning> weak_bands(const FrequencyResponses& responses) {
  std::vector<data::ResponseWarning> bands;
  std::ranges::copy_if(responses.warnings, std::back_inserter(bands), [](const auto& w) {
    return w.kind == data::ResponseWarning::Kind::weak_excitation;
  });
  return bands;
}

bool is_weak(const std::vector<data::ResponseWarning>& bands, std::complex<double> pole) {
  const double f = std::abs(pole) / (2.0 * std::numbers::pi),
               wide = -pole.real() / (2.0 * std::numbers::pi);
  return std::ranges::any_of(
      bands, [&](const auto& w) { return f + wide >= w.lowest && f - wide <= w.highest; });
}

void add_weak_loop(const test::ModalSystem& plant, double level, std::uint64_t seed,
                   WeakScore& score) {
  const auto m = foreign_measurement(plant, weak_loop(level, seed));
  const auto bands = weak_bands(m.responses);
  score.records_with_bands += bands.empty() ? 0 : 1;
  score.most_bands = std::max(score.most_bands, static_cast<int>(bands.size()));
  const auto found = identify_modes(m.responses, foreign_band);
  for (const auto& truth : plant.modes) {
    const bool weak = is_weak(bands, truth.pole);
    ++score.modes;
    score.weak_modes += weak ? 1 : 0;
    for (const auto& mode : found.modes) {
      if (std::abs(mode.fit.omega() / std::abs(truth.pole) - 1.0) > 0.02) continue;
      const double zeta = -truth.pole.real() / std::abs(truth.pole);
      const int held =
          (std::abs(mode.fit.omega() - std::abs(truth.pole)) <= 1.96 * mode.fit.omega_deviation) +
          (std::abs(mode.fit.damping_ratio() - zeta) <= 1.96 * mode.fit.damping_deviation);
      (weak ? score.weak_intervals : score.intervals) += 2;
      (weak ? score.weak_covered : score.covered) += held;
    }
  }
  for (const auto& mode : found.modes) {
    for (const auto& band : bands)
      if (is_weak({band}, mode.fit.pole))
        score.best_weak_quality =
            std::max(score.best_weak_quality, mode.quality() / std::max(band.share, 1e-3));
    const bool is_true = std::ranges::any_of(plant.modes, [&](const auto& truth) {
      return std::abs(mode.fit.omega() / std::abs(truth.pole) - 1.0) <= 0.02;
    });
    score.false_modes += is_true ? 0 : 1;
    score.false_and_good += !is_true && mode.quality() >= 0.5 ? 1 : 0;
  }
}

}  // namespace hydrapod::identification
