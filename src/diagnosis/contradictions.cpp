#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "evidence.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/observation/pairing.hpp"
#include "predictions.hpp"

namespace hydrapod::diagnosis {

namespace {

using observation::ModeTarget;
using observation::Targets;

constexpr double notable = 3.0;  // deviations

Place place_of(const ModeTarget& mode) {
  if (mode.direction) return {mode.pose, *mode.direction, {}};
  return {mode.pose, -1, mode.name};
}

Contradiction contradiction(Contradiction::Kind kind, std::vector<Place> places) {
  Contradiction made{kind};
  made.places = std::move(places);
  return made;
}

/// Measured frequencies that are one resonance count once, and one that was measured at several
/// amplitudes too.
int count_measured(const Targets& targets, const std::string& pose, int direction) {
  std::map<double, std::vector<std::complex<double>>> poles;  // at an amplitude
  for (const auto& mode : targets.modes)
    if (mode.pose == pose && mode.direction == direction)
      poles[mode.amplitude].emplace_back(0.0, mode.omega);
  std::size_t most = 0;
  for (const auto& [amplitude, some] : poles)
    most = std::max(most, observation::groups_of(some).size());
  return static_cast<int>(most);
}

/// Of the lines of responses, where these are missed by more than `notable` deviations in all, that
/// which is missed most.
std::optional<Contradiction> missed_response(const Targets& targets, const Hypothesis& e) {
  std::map<std::pair<std::size_t, std::size_t>, std::pair<double, double>> lines;  // misfit, share
  for (const auto& response : e.fit.responses) {
    const std::pair<std::size_t, std::size_t> line{response.target, response.line};
    auto& [misfit, missed] = lines.try_emplace(line, 0.0, 0.0).first->second;
    misfit += response.difference * response.difference;
    missed = std::max(missed, response.missed);
  }
  int values = 0;
  for (const auto& target : targets.responses) values += target.values;
  if (e.response_misfit() < std::max(notable * notable, static_cast<double>(values)))
    return std::nullopt;
  const auto worst =
      std::ranges::max_element(lines, {}, [](const auto& line) { return line.second.first; });
  const auto& target = targets.responses[worst->first.first];
  const double missed = worst->second.second;
  const bool forces = target.entry == observation::Entry::forces;
  auto found = contradiction(forces ? Contradiction::Kind::forces : Contradiction::Kind::drives,
                             {{.pose = target.pose}});
  found.omega = target.s[worst->first.second].imag();
  found.mac = 1.0 - missed * missed;
  found.missed = missed;
  return found;
}

/// Where fewer resonances are predicted than were measured, by these numbers.
std::vector<Contradiction> missing_resonances(const Evidence& evidence, const Hypothesis& e) {
  const auto& targets = evidence.targets();
  Predictions predictions(evidence.file(), targets, evidence.nominal().kind);
  std::map<std::pair<int, int>, std::vector<Place>> found;  // predicted, measured
  for (const auto& named : evidence.file().machine.poses) {
    if (std::ranges::count(targets.modes, named.name, &ModeTarget::pose) == 0) continue;
    const auto seen = predictions.at(e, named);
    for (int direction = 0; direction < 6; ++direction) {
      const auto predicted =
          static_cast<int>(std::ranges::count(seen, direction, &observation::Resonance::direction));
      const int measured = count_measured(targets, named.name, direction);
      if (predicted < measured) found[{predicted, measured}].push_back({named.name, direction, {}});
    }
  }
  std::vector<Contradiction> all;
  for (const auto& [counts, places] : found) {
    all.push_back(contradiction(Contradiction::Kind::resonances, places));
    std::tie(all.back().predicted, all.back().measured) = counts;
  }
  return all;
}

}  // namespace

std::vector<Contradiction> what_is_wrong(const Evidence& evidence, const Hypothesis& e) {
  constexpr std::size_t most = 3;
  constexpr double other_motion = 0.8, beyond = 10.0;
  const auto& targets = evidence.targets();
  std::vector<Contradiction> wrong;
  if_possible([&] { wrong = missing_resonances(evidence, e); });  // or it folds at a pose
  const auto response = missed_response(targets, e);
  const std::size_t of_modes = most - (response ? 1 : 0);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < e.fit.targets.size(); ++i) order.push_back(i);
  const auto difference = [&](std::size_t i) { return std::abs(e.fit.targets[i].difference); };
  std::ranges::stable_sort(order, std::greater{}, difference);
  for (const auto i : order) {
    if (wrong.size() >= of_modes) break;
    const auto& target = targets.modes[i];
    const auto& fit = e.fit.targets[i];
    if (e.rigid && fit.omega > beyond * target.omega) continue;  // of seals made rigid: no mode
    if (difference(i) >= notable) {
      wrong.push_back(contradiction(Contradiction::Kind::frequency, {place_of(target)}));
      wrong.back().omega = fit.omega;
      wrong.back().difference = fit.omega - target.omega;
    } else if (target.shape && fit.shape_mac < other_motion) {
      wrong.push_back(contradiction(Contradiction::Kind::shape, {place_of(target)}));
      wrong.back().omega = target.omega;
      wrong.back().mac = fit.shape_mac;
    }
  }
  if (response) wrong.push_back(*response);
  return wrong;
}

std::optional<Contradiction> contrary(const Evidence& evidence, const Hypothesis& nominal,
                                      const Hypothesis& hypothesis,
                                      const numerics::Progress& stop) {
  if (hypothesis.causes.size() != 1 || hypothesis.parameters != 1) return {};
  // the direction that is missed most
  const auto& targets = evidence.targets();
  int direction = -1;
  double largest = notable;
  for (std::size_t i = 0; i < targets.modes.size(); ++i)
    if (targets.modes[i].direction && std::abs(nominal.fit.targets[i].difference) > largest) {
      largest = std::abs(nominal.fit.targets[i].difference);
      direction = *targets.modes[i].direction;
    }
  if (direction < 0) return {};
  const auto part = evidence.explain_direction(hypothesis.causes.front(), direction, stop);
  if (!part) return {};
  const auto& fitted = part->hypothesis;
  const auto some = static_cast<double>(targets.modes.size() - part->rest.modes.size());
  if (fitted.misfit / some > notable * notable * 4.0) return {};  // it does not explain even that
  const auto& at = part->at_rest;
  if (!at.fitted) return {};
  const auto worst = std::ranges::max_element(
      at.targets, {}, [](const auto& target) { return std::abs(target.difference); });
  if (std::abs(worst->difference) < notable) return {};
  const auto& p = fitted.fit.parameters.front();
  const auto& target = part->rest.modes[static_cast<std::size_t>(worst - at.targets.begin())];
  auto found = contradiction(Contradiction::Kind::value, {place_of(target)});
  found.omega = worst->omega;
  found.difference = worst->omega - target.omega;
  found.direction = direction;
  found.value = p.value;
  found.deviation = p.deviation;
  found.unit = p.unit;
  return found;
}

namespace {

/// What was measured in a direction at a pose beside the first resonance predicted there.
struct Beside {
  double predicted{};
  std::vector<double> measured{};  ///< ascending [rad/s]
};

std::vector<Beside> beside_predicted(const Evidence& evidence, const Hypothesis& nominal) {
  std::vector<Beside> all;
  const auto& machine = evidence.file().machine;
  for (const auto& named : machine.poses) {
    std::array<std::vector<double>, 6> measured;
    for (const auto& mode : evidence.targets().modes)
      if (mode.pose == named.name && mode.direction)
        measured[static_cast<std::size_t>(*mode.direction)].push_back(mode.omega);
    if (std::ranges::all_of(measured, [](const auto& some) { return some.empty(); })) continue;
    // the lowest one that was measured may hold a small share of its direction
    for (const auto& r : first_resonances(machine, named.X_BP, nominal.kind,
                                          {.of_largest = 0.0, .least = resonance_mac})) {
      auto& here = measured[static_cast<std::size_t>(r.main_direction)];
      if (here.empty() || !(r.omega > 0.0)) continue;  // no mode, or legs that fold
      std::ranges::sort(here);
      all.push_back({r.omega, here});
    }
  }
  return all;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

/// The slip of units with which undone the measured resonances that are nearest to the predicted
/// ones lie within a fifth of them (median); a fault may have moved them besides.
Objection::Slip slip_of(const std::vector<Beside>& all) {
  using Slip = Objection::Slip;
  const std::array slips{std::pair{1e3, Slip::thousand}, std::pair{base::two_pi, Slip::radians},
                         std::pair{60.0, Slip::per_minute},
                         std::pair{31.622776601683793, Slip::mass_or_stiffness}};
  double least = std::log(1.2);
  Slip found = Slip::none;
  for (const auto& [ratio, slip] : slips)
    for (const double factor : {ratio, 1.0 / ratio}) {
      std::vector<double> off;
      for (const auto& [predicted, measured] : all) {
        double nearest = std::abs(std::log(measured.front() / (factor * predicted)));
        for (const double omega : measured)
          nearest = std::min(nearest, std::abs(std::log(omega / (factor * predicted))));
        off.push_back(nearest);
      }
      if (median(off) >= least) continue;
      least = median(off);
      found = slip;
    }
  return found;
}

}  // namespace

std::vector<Objection> objections(const Evidence& evidence, const Hypothesis& nominal) {
  using Kind = Objection::Kind;
  constexpr double far = 2.5;
  const auto& modes = evidence.targets().modes;
  std::vector<Objection> found;
  const auto count = static_cast<int>(modes.size());
  if (count < fewest_modes) found.push_back({Kind::few_modes, count});
  std::set<int> directions;
  for (const auto& mode : modes)
    if (mode.direction) directions.insert(*mode.direction);
  if (directions.empty())
    found.push_back({Kind::no_directions});
  else if (std::ssize(directions) < fewest_directions)
    found.push_back({Kind::few_directions, static_cast<int>(directions.size())});
  if (!found.empty()) return found;
  const auto all = beside_predicted(evidence, nominal);
  if (all.empty()) return found;
  std::vector<double> ratios;
  for (const auto& [predicted, measured] : all) ratios.push_back(measured.front() / predicted);
  const double ratio = median(ratios);
  if (ratio > far || ratio < 1.0 / far)
    found.push_back({Kind::frequencies, count, ratio, slip_of(all)});
  return found;
}

}  // namespace hydrapod::diagnosis
