#include "line_noise.hpp"

#include <algorithm>
#include <cmath>

#include "pole_basis.hpp"
#include "prune.hpp"
#include "weak_modes.hpp"

namespace hydrapod::identification {

namespace {

constexpr double nearly_all = 0.999;  ///< |g| of the nearest line of every record

/// What inputs and transients make of a mode at a line.
struct Parts {
  Complex by_inputs{}, rings{};
};
Parts parts_at(const RecordLines& lines, const FrequencyResponses& r, const FittedMode& mode,
               std::size_t line) {
  const VectorXcd& U = r.excitation[line];
  const Index p = lines.U.cols();
  return {mode.participation.head(p).transpose() * U.head(p),
          mode.participation.tail(lines.records).transpose() * U.tail(lines.records)};
}

/// Do the inputs drive a mode, by its power beside that of its transient? A tone with a whole
/// number of periods in the record is all in one line, where inputs explain it as well as a
/// transient does: what they drive is then nowhere else.
bool is_driven(const RecordOptions& options, const RecordLines& lines, const FrequencyResponses& r,
               const FittedMode& mode) {
  const VectorXcd g = PoleBasis(r, false).at(mode.pole).g;
  const double nearest = nearly_all * g.cwiseAbs().maxCoeff();
  double driven = 0.0, free = 0.0, beside = 0.0;
  for (Index k = 0; k < g.size(); ++k) {
    const auto [by_inputs, rings] = parts_at(lines, r, mode, static_cast<std::size_t>(k));
    driven += std::norm(g[k] * by_inputs);
    free += std::norm(g[k] * rings);
    if (std::abs(g[k]) < nearest) beside += std::norm(g[k] * by_inputs);
  }
  return driven >= options.tone_driven * free && beside >= options.tone_beside * driven;
}

bool is_tone(const RecordOptions& options, const RecordLines& lines, const FrequencyResponses& r,
             const FittedMode& mode) {
  return -mode.pole.real() * lines.duration < options.tone_decays &&
         !is_driven(options, lines, r, mode);
}

/// Poles that nothing drives, of which one is within a line of another, are one tone.
bool are_one(const RecordLines& lines, Complex a, Complex b) {
  return std::abs(a.imag() - b.imag()) * lines.duration < two_pi;
}

/// A pole that hardly decays, in the transients alone.
PoleCluster tone_at(double frequency, const RecordLines& lines, const FrequencyResponses& r) {
  PoleCluster cluster;
  auto& e = cluster.representative;
  constexpr double decay = 0.05;
  e.pole = {-decay / lines.duration, two_pi * frequency};
  e.shape = VectorXcd::Ones(r.H[0].rows());
  e.participation = VectorXcd::Zero(r.H[0].cols());
  e.participation.tail(lines.records).setOnes();
  return cluster;
}

bool try_tone(const IdentifyOptions& options, const RecordLines& lines, double frequency,
              Identification& result) {
  auto tone = tone_at(frequency, lines, result.responses);
  std::vector<PoleCluster> clusters;
  for (std::size_t r = 0; r < result.clusters.size(); ++r) {
    const auto& mode = result.model.modes[r];
    // a candidate that has a decay of its own does not come to rest at the tone
    if (are_one(lines, mode.pole, tone.representative.pole) &&
        !is_driven(options.record, lines, result.responses, mode))
      continue;
    clusters.push_back(result.clusters[r]);
    clusters.back().representative = mode;
  }
  const std::size_t before = clusters.size();
  clusters.push_back(std::move(tone));
  Identification trial = result;
  if (!fit_if_all_stay(options, std::move(clusters), before, trial) ||
      trial.clusters.size() != before + 1 ||
      !is_tone(options.record, lines, trial.responses, trial.model.modes.back()))
    return false;
  result = std::move(trial);
  return true;
}

/// Amplitude per output, of the record in which it is largest.
data::Harmonic harmonic_of(const FittedMode& tone, const RecordLines& lines,
                           const FrequencyResponses& r) {
  const double T = lines.duration;
  const VectorXcd g = PoleBasis(r, false).at(tone.pole).g;
  const double nearest = nearly_all * g.cwiseAbs().maxCoeff();
  double size = 0.0;
  for (Index k = 0; k < g.size(); ++k) {
    if (std::abs(g[k]) < nearest) continue;
    const auto [by_inputs, rings] = parts_at(lines, r, tone, static_cast<std::size_t>(k));
    size = std::max(size, std::abs(by_inputs + rings));
  }
  const double turned = std::max(std::abs(std::exp(tone.pole * T) - 1.0), 1e-12);
  return {.frequency = tone.pole.imag() / two_pi,
          .amplitude = size * T / turned * tone.shape.cwiseAbs()};
}

}  // namespace

void add_tones(const IdentifyOptions& options, const RecordLines& lines, Identification& result) {
  for (int found = 0; found < options.record.most_tones && !result.model.modes.empty(); ++found) {
    const auto places = conspicuous_frequencies(result.responses, result.model, options);
    if (std::ranges::none_of(places, [&](double f) { return try_tone(options, lines, f, result); }))
      return;
  }
}

std::vector<data::Harmonic> take_out_tones(const IdentifyOptions& options, const RecordLines& lines,
                                           Identification& result) {
  std::vector<data::Harmonic> tones;
  for (std::size_t r = result.model.modes.size(); r-- > 0;) {
    if (!is_tone(options.record, lines, result.responses, result.model.modes[r])) continue;
    tones.push_back(harmonic_of(result.model.modes[r], lines, result.responses));
    const auto at = static_cast<std::ptrdiff_t>(r);
    result.model.modes.erase(result.model.modes.begin() + at);
    result.clusters.erase(result.clusters.begin() + at);
  }
  std::ranges::sort(tones, {}, &data::Harmonic::frequency);
  return tones;
}

}  // namespace hydrapod::identification
