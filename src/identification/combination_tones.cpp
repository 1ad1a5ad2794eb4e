#include "combination_tones.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "names.hpp"

namespace hydrapod::identification {

namespace {

double decay_of(const IdentifiedMode& mode) { return -mode.fit.pole.real(); }

/// Of the largest response, as acceleration; in proportion. Modes have some 1/(2 ζ m).
double peak_of(const IdentifiedMode& mode) {
  return mode.displacement.cwiseAbs().maxCoeff() * mode.fit.participation.cwiseAbs().maxCoeff() *
         std::norm(mode.fit.pole) / std::max(decay_of(mode), 1e-300);
}

/// Two modes that may have made a third one.
struct Combination {
  std::size_t a{}, b{};
  double omega{}, deviation{};  ///< where it would be [rad/s]
};

/// Of modes that are larger than mode k, and decay together as mode k does.
std::vector<Combination> combinations_for(const std::vector<IdentifiedMode>& modes, std::size_t k,
                                          const CombinationToneOptions& options) {
  const auto is_large = [&](const IdentifiedMode& mode) {
    return peak_of(modes[k]) < options.smaller * peak_of(mode);
  };
  std::vector<Combination> all;
  for (std::size_t a = 0; a < modes.size(); ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      if (!is_large(modes[a]) || !is_large(modes[b])) continue;
      const double ratio = decay_of(modes[k]) / (decay_of(modes[a]) + decay_of(modes[b]));
      if (ratio > options.decay || ratio * options.decay < 1.0) continue;
      const double higher = modes[a].fit.omega(), lower = modes[b].fit.omega(),
                   deviation =
                       Eigen::Vector3d(modes[a].fit.omega_deviation, modes[b].fit.omega_deviation,
                                       modes[k].fit.omega_deviation)
                           .norm();
      all.push_back({a, b, higher + lower, deviation});
      if (a != b) all.push_back({a, b, higher - lower, deviation});
    }
  return all;
}

/// Share of the band that is within `distance` of one of these.
double covered(std::vector<Combination> all, double distance, double from, double to) {
  std::ranges::sort(all, {}, &Combination::omega);
  double sum = 0.0, behind = from;
  for (const auto& c : all) {
    const double begin = std::max(c.omega - distance, behind),
                 end = std::min(c.omega + distance, to);
    if (end <= begin) continue;
    sum += end - begin;
    behind = end;
  }
  return sum / (to - from);
}

/// Of a product of n numbers that are even between 0 and 1, by −ln of it (R. A. Fisher).
double chance_of(std::size_t n, double minus_log) {
  double sum = 0.0, term = std::exp(-minus_log);
  for (std::size_t j = 0; j < n; ++j) {
    sum += term;
    term *= minus_log / static_cast<double>(j + 1);
  }
  return sum;
}

}  // namespace

void warn_of_combination_tones(Identification& result, const CombinationToneOptions& options) {
  auto& modes = result.modes;
  if (modes.size() < 3) return;
  const double from = two_pi * result.from, to = two_pi * result.to;
  constexpr double least = 1e-4;  // a frequency is hardly known better
  double minus_log = 0.0;
  std::size_t judged = 0;
  std::vector<std::pair<std::size_t, Combination>> tones;
  for (std::size_t k = 0; k < modes.size(); ++k) {
    const auto all = combinations_for(modes, k, options);
    if (all.empty()) continue;
    const double omega = modes[k].fit.omega();
    const auto away = [&](const Combination& c) { return std::abs(c.omega - omega); };
    const auto& nearest = *std::ranges::min_element(all, {}, away);
    minus_log -= std::log(std::clamp(covered(all, away(nearest), from, to), least, 1.0));
    ++judged;
    if (away(nearest) < options.deviations * nearest.deviation + options.beside * omega)
      tones.emplace_back(k, nearest);
  }
  if (tones.size() < options.fewest || !(chance_of(judged, minus_log) < options.chance)) return;
  for (const auto& tone : tones) {
    auto& explained = modes[tone.first].explained;
    explained = std::min(explained, options.quality);
  }
  const auto& [first, of] = tones.front();
  result.warnings.push_back({.kind = ModeWarning::Kind::combination_tones,
                             .value = modes[first].fit.omega() / two_pi,
                             .from = modes[of.b].fit.omega() / two_pi,
                             .to = modes[of.a].fit.omega() / two_pi,
                             .count = std::ssize(tones),
                             .total = std::ssize(modes)});
}

}  // namespace hydrapod::identification
