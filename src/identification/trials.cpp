#include <algorithm>
#include <cmath>
#include <limits>

#include "identify_steps.hpp"
#include "line_weights.hpp"
#include "prune.hpp"
#include "search.hpp"
#include "selection.hpp"
#include "weak_modes.hpp"

namespace hydrapod::identification {

namespace {

/// Fall of the sum of squares from `before` to `after`, over the number of a mode's parameters as
/// in FittedMode::significance.
double gain(const Identification& before, const Identification& after) {
  const auto& H = before.responses.H;
  const double numbers = static_cast<double>(H.size()) * numbers_per_line(before.responses);
  return (before.model.misfit - after.model.misfit) * numbers /
         (2.0 * static_cast<double>(H[0].rows() + H[0].cols()));
}

/// Tries `count` modes more, with this pole at the beginning. They stay if they gain so much (see
/// Certainty), are what is wanted, and everything else stays.
template <class Wanted>
bool try_more_if(const IdentifyOptions& options, const PoleCluster& like, Complex pole,
                 std::size_t count, double least_gain, const Wanted& is_wanted,
                 Identification& result) {
  auto clusters = fitted_clusters(result);
  const std::size_t before = clusters.size();
  for (auto& mode :
       modes_in_residual(result.responses, result.model, pole, count, options.fit.taper)) {
    clusters.push_back(like);
    clusters.back().representative = std::move(mode);
  }
  Identification trial = result;
  if (!fit_if_all_stay(options, std::move(clusters), before, trial) ||
      trial.clusters.size() != before + count ||
      gain(result, trial) < least_gain * options.least_significance)
    return false;
  for (std::size_t r = before; r < before + count; ++r)
    if (!is_wanted(trial.model.modes[r])) return false;
  for (std::size_t r = 0; r < before; ++r)
    if (!is_near(trial.model.modes[r].pole, result.model.modes[r].pole, options.trial.unmoved))
      return false;
  result = std::move(trial);
  return true;
}

/// Such as come out near there, as certain as is asked.
bool try_more(const IdentifyOptions& options, const PoleCluster& like, Complex pole,
              std::size_t count, const Certainty& asked, Identification& result) {
  const auto is_wanted = [&](const FittedMode& added) {
    return std::abs(added.omega() / std::abs(pole) - 1.0) <= asked.near &&
           added.damping_ratio() <= options.highest_damping &&
           added.omega_deviation <= asked.frequency * added.omega() &&
           added.damping_deviation <= asked.damping * added.damping_ratio();
  };
  return try_more_if(options, like, pole, count, asked.gain, is_wanted, result);
}

/// Damping is judged as `pair` has it, where that is milder.
IdentifyOptions for_pairs(IdentifyOptions options, const Certainty& pair) {
  options.largest_damping_deviation = std::max(pair.damping, options.largest_damping_deviation);
  return options;
}

}  // namespace

void add_candidates(const IdentifyOptions& options, const std::vector<PoleCluster>& candidates,
                    Identification& result) {
  for (const auto& candidate : candidates) {
    const auto pole = candidate.representative.pole;
    const bool known = std::ranges::any_of(result.model.modes, [&](const FittedMode& m) {
      return is_near(m.pole, pole, options.trial.unmoved);
    });
    if (!known && candidate.representative.damping_ratio() <= options.highest_damping)
      try_more(options, candidate, pole, 1, options.trial.hidden, result);
  }
}

void add_hidden_modes(const IdentifyOptions& options, Identification& result) {
  const auto& trial = options.trial;
  const auto mild = for_pairs(options, trial.hidden_pair);
  const double sharp = trial.damping;
  bool found = !result.model.modes.empty();
  for (int round = 0; round < trial.rounds && found; ++round) {
    found = false;
    const auto places = conspicuous_frequencies(result.responses, result.model, options);
    const auto most = std::min(places.size(), static_cast<std::size_t>(trial.most_places));
    for (std::size_t k = 0; k < most; ++k) {
      const double f = places[k];
      const auto pole = two_pi * f * Complex(-sharp, std::sqrt(1 - sharp * sharp));
      found = found || try_more(options, {}, pole, 1, trial.hidden, result) ||
              try_more(mild, {}, pole, 2, trial.hidden_pair, result);
    }
  }
}

namespace {

/// Is so much more left over below this frequency [Hz] than elsewhere?
bool more_is_left_below(double frequency, double more, const IdentifyOptions& options,
                        const Identification& result) {
  const auto& lines = result.responses.frequency;
  const auto count = std::ranges::lower_bound(lines, frequency) - lines.begin();
  if (count < static_cast<std::ptrdiff_t>(fewest_lines)) return false;
  const VectorXd left =
      signal_to_noise(residual_of(result.responses, result.model, options.fit.taper), 0);
  return left.head(count).mean() > more * left.mean();
}

}  // namespace

void add_pole_below_modes(const IdentifyOptions& options, Identification& result,
                          const PoleBelowOptions& pole) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const auto& m : result.model.modes)
    if (m.damping_ratio() <= options.highest_damping) lowest = std::min(lowest, m.omega());
  if (!std::isfinite(lowest) ||
      !more_is_left_below(pole.side * lowest / two_pi, pole.more, options, result))
    return;
  const auto is_wanted = [&](const FittedMode& added) {
    return added.damping_ratio() > options.highest_damping && added.omega() < lowest;
  };
  const Complex direction(-pole.damping, std::sqrt(1.0 - pole.damping * pole.damping));
  for (const double share : pole.shares) {
    const double omega = share * lowest;
    if (!(omega > two_pi * result.from)) continue;
    if (try_more_if(options, {}, omega * direction, 1, pole.gain, is_wanted, result)) return;
  }
}

void add_second_of_pairs(const IdentifyOptions& given, std::size_t strong, Identification& result) {
  auto asked = given.trial.second;
  const auto options = for_pairs(given, asked);
  asked.damping = options.largest_damping_deviation;
  const std::size_t end = result.model.modes.size();
  for (std::size_t r = strong; r < end; ++r) {
    const auto pole = result.model.modes[r].pole;
    const auto close = std::ranges::count_if(result.model.modes, [&](const FittedMode& m) {
      return is_near(m.pole, pole, options.trial.unmoved);
    });
    if (close == 1) try_more(options, result.clusters[r], pole, 1, asked, result);
  }
}

}  // namespace hydrapod::identification
