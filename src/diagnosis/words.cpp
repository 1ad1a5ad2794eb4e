#include "words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/units.hpp"
#include "hydrapod/diagnosis/diagnose.hpp"
#include "hydrapod/observation/pairing.hpp"

namespace hydrapod::diagnosis {

namespace {

using observation::ModeTarget;
using observation::Targets;

using base::two_pi;
constexpr double notable = 3.0;  // deviations

const char* count_word(int count) {
  constexpr std::array words{"no", "one", "two", "three", "four", "five", "six"};
  return words.at(static_cast<std::size_t>(std::clamp(count, 0, 6)));
}

std::string resonances(int count) {
  return fmt::format("{} resonance{}", count_word(count), count == 1 ? "" : "s");
}

std::string where(const Targets& targets, const std::string& pose) {
  const bool several = std::any_of(targets.modes.begin(), targets.modes.end(),
                                   [&](const auto& m) { return m.pose != pose; });
  return several ? fmt::format(" at pose {}", pose) : "";
}

std::string mode_words(const ModeTarget& mode, const Targets& targets) {
  return (mode.direction ? std::string(direction_name(*mode.direction)) : mode.name) +
         where(targets, mode.pose);
}

/// Measured frequencies that are one resonance count once.
int count_measured(const Targets& targets, const std::string& pose, int direction) {
  std::vector<std::complex<double>> poles;
  for (const auto& mode : targets.modes)
    if (mode.pose == pose && mode.direction == direction) poles.emplace_back(0.0, mode.omega);
  return static_cast<int>(observation::groups_of(poles).size());
}

/// "moves otherwise than measured at 8.52 Hz when driven (MAC 0.61)", "misses the response to
/// forces at 8.52 Hz by 47 %": of the lines of responses, where these are missed by more than
/// `notable` deviations in all, that which is missed most.
std::optional<std::string> missed_response(const Evidence& evidence, const Explanation& e) {
  std::map<std::pair<std::size_t, std::size_t>, std::pair<double, double>> lines;  // misfit, share
  double all = 0.0;
  for (const auto& response : e.fit.responses) {
    const std::pair<std::size_t, std::size_t> line{response.target, response.line};
    auto& [misfit, missed] = lines.try_emplace(line, 0.0, 0.0).first->second;
    misfit += response.difference * response.difference;
    missed = std::max(missed, response.missed);
    all += response.difference * response.difference;
  }
  int values = 0;
  for (const auto& target : evidence.targets().responses) values += target.values;
  if (all < std::max(notable * notable, static_cast<double>(values))) return std::nullopt;
  const auto worst =
      std::ranges::max_element(lines, {}, [](const auto& line) { return line.second.first; });
  const auto& target = evidence.targets().responses[worst->first.first];
  const double missed = worst->second.second;
  const auto place = fmt::format("at {:.2f} Hz{}", target.s[worst->first.second].imag() / two_pi,
                                 where(evidence.targets(), target.pose));
  return target.entry == observation::Entry::forces
             ? fmt::format("differs from the response to forces {} by {:.0f} %", place,
                           100.0 * missed)
             : fmt::format(
                   "shape of the response to drives differs from the measured one {} (MAC {:.2f})",
                   place, 1.0 - missed * missed);
}

/// "predicts one resonance in x, two were measured"
void add_missing(const Evidence& evidence, const Explanation& e, const model::Machine& machine,
                 std::vector<std::string>& words) {
  std::set<std::string> poses;
  for (const auto& mode : evidence.targets().modes) poses.insert(mode.pose);
  std::map<std::pair<int, int>, std::vector<std::string>> found;  // predicted, measured
  for (const auto& named : machine.poses) {
    if (!poses.contains(named.name)) continue;
    const auto seen = observation::visible_resonances(machine, named.X_BP, e.kind);
    for (int direction = 0; direction < 6; ++direction) {
      const auto predicted = static_cast<int>(std::count_if(
          seen.begin(), seen.end(), [&](const auto& r) { return r.direction == direction; }));
      const int measured = count_measured(evidence.targets(), named.name, direction);
      if (predicted < measured)
        found[{predicted, measured}].push_back(direction_name(direction) +
                                               where(evidence.targets(), named.name));
    }
  }
  for (const auto& [counts, places] : found)
    words.push_back(fmt::format("predicts {} in {}, {} {} measured", resonances(counts.first),
                                fmt::join(places, ", "), count_word(counts.second),
                                counts.second == 1 ? "was" : "were"));
}

}  // namespace

std::vector<std::string> what_is_wrong(const Evidence& evidence, const Explanation& e) {
  constexpr std::size_t most = 3;
  constexpr double other_motion = 0.8;
  std::vector<std::string> words;
  try {
    add_missing(evidence, e, machine_of(evidence.file(), e), words);
  } catch (const base::ComputationError&) {  // no equilibrium at one of the poses
  }
  const auto response = missed_response(evidence, e);
  const std::size_t of_modes = most - (response ? 1 : 0);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < e.fit.targets.size(); ++i) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(e.fit.targets[a].difference) > std::abs(e.fit.targets[b].difference);
  });
  for (const auto i : order) {
    if (words.size() >= of_modes) break;
    const auto& target = evidence.targets().modes[i];
    const auto& fit = e.fit.targets[i];
    const std::string mode = mode_words(target, evidence.targets());
    if (std::abs(fit.difference) >= notable)
      words.push_back(fmt::format("predicts {} at {:.2f} Hz, {:.2f} Hz {} than measured", mode,
                                  fit.omega / two_pi, std::abs(fit.omega - target.omega) / two_pi,
                                  fit.omega > target.omega ? "higher" : "lower"));
    else if (target.shape && fit.shape_mac < other_motion)
      words.push_back(
          fmt::format("mode shape differs from the measured one in {} at {:.2f} Hz (MAC {:.2f})",
                      mode, target.omega / two_pi, fit.shape_mac));
  }
  if (response) words.push_back(*response);
  return words;
}

std::string contrary(const Evidence& evidence, const Explanation& as_stated,
                     const Explanation& explanation, const numerics::Progress& stop) {
  if (explanation.suspects.size() != 1 || explanation.parameters != 1) return {};
  // the direction that is missed most
  const auto& targets = evidence.targets();
  int direction = -1;
  double largest = notable;
  for (std::size_t i = 0; i < targets.modes.size(); ++i)
    if (targets.modes[i].direction && std::abs(as_stated.fit.targets[i].difference) > largest) {
      largest = std::abs(as_stated.fit.targets[i].difference);
      direction = *targets.modes[i].direction;
    }
  if (direction < 0) return {};
  const auto part = evidence.explain_direction(explanation.suspects.front(), direction, stop);
  if (!part) return {};
  const auto& fitted = part->explanation;
  const auto some = static_cast<double>(targets.modes.size() - part->rest.modes.size());
  if (fitted.misfit / some > notable * notable * 4.0) return {};  // it does not explain even that
  const auto& p = fitted.fit.parameters.front();
  const auto& at = part->at_rest;
  if (!at.fitted) return {};
  std::size_t worst = 0;
  for (std::size_t i = 1; i < at.targets.size(); ++i)
    if (std::abs(at.targets[i].difference) > std::abs(at.targets[worst].difference)) worst = i;
  if (std::abs(at.targets[worst].difference) < notable) return {};
  const auto& target = part->rest.modes[worst];
  return fmt::format("the value that explains {} ({}) contradicts {} by {:.2g} Hz",
                     direction_name(direction), amount_text(p.value, p.deviation, p.unit),
                     mode_words(target, targets),
                     std::abs(at.targets[worst].omega - target.omega) / two_pi);
}

namespace {

/// What was measured in a direction at a pose beside the first resonance predicted there.
struct Beside {
  double predicted{};
  std::vector<double> measured{};  ///< ascending [rad/s]
};

std::vector<Beside> beside_predicted(const Evidence& evidence, const Explanation& as_stated) {
  std::vector<Beside> all;
  const auto& machine = evidence.file().machine;
  for (const auto& named : machine.poses) {
    std::array<std::vector<double>, 6> measured;
    for (const auto& mode : evidence.targets().modes)
      if (mode.pose == named.name && mode.direction)
        measured[static_cast<std::size_t>(*mode.direction)].push_back(mode.omega);
    if (std::ranges::all_of(measured, [](const auto& some) { return some.empty(); })) continue;
    for (const auto& r : first_resonances(machine, named.X_BP, as_stated.kind)) {
      auto& here = measured[static_cast<std::size_t>(r.main_direction)];
      if (here.empty() || !(r.omega > 0.0)) continue;
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
std::string slip(const std::vector<Beside>& all) {
  struct Slip {
    double ratio;
    const char* words;
  };
  constexpr std::array slips{
      Slip{1e3, "a unit wrong by 1000 in the frequencies"}, Slip{two_pi, "rad/s taken for Hz"},
      Slip{60.0, "cycles per minute taken for Hz"},
      Slip{31.622776601683793, "a mass or a stiffness wrong by 1000 in the machine file"}};
  double least = std::log(1.2);
  std::string words;
  for (const auto& one : slips)
    for (const double factor : {one.ratio, 1.0 / one.ratio}) {
      std::vector<double> off;
      for (const auto& [predicted, measured] : all) {
        double nearest = std::abs(std::log(measured.front() / (factor * predicted)));
        for (const double omega : measured)
          nearest = std::min(nearest, std::abs(std::log(omega / (factor * predicted))));
        off.push_back(nearest);
      }
      if (median(off) >= least) continue;
      least = median(off);
      words = one.words;
    }
  return words;
}

}  // namespace

std::vector<std::string> objections(const Evidence& evidence, const Explanation& as_stated) {
  constexpr std::size_t fewest = 4;
  constexpr int fewest_directions = 3;
  constexpr double far = 2.5;
  const auto& modes = evidence.targets().modes;
  std::vector<std::string> reasons;
  if (modes.size() < fewest)
    reasons.push_back(fmt::format(
        "{} {} measured; with fewer than {} every candidate cause explains them",
        modes.size() == 1 ? "only one mode" : fmt::format("only {} modes", modes.size()),
        modes.size() == 1 ? "was" : "were", fewest));
  std::set<int> directions;
  for (const auto& mode : modes)
    if (mode.direction) directions.insert(*mode.direction);
  if (static_cast<int>(directions.size()) < fewest_directions)
    reasons.push_back(
        directions.empty()
            ? "the measured modes have neither directions nor shapes; frequencies alone fit many "
              "machines (give x … rz, or a shape, with every mode)"
            : fmt::format("the measured modes move the platform in {} of its six directions only; "
                          "at least {} are needed",
                          directions.size(), fewest_directions));
  if (!reasons.empty()) return reasons;
  const auto all = beside_predicted(evidence, as_stated);
  if (all.empty()) return reasons;
  std::vector<double> ratios;
  for (const auto& [predicted, measured] : all) ratios.push_back(measured.front() / predicted);
  const double ratio = median(ratios);
  if (ratio > far || ratio < 1.0 / far) {
    const auto why = slip(all);
    reasons.push_back(fmt::format(
        "the measured frequencies are {:.3g} times those of this machine, direction by direction "
        "(median){}",
        ratio, why.empty() ? "" : fmt::format("; possible reason: {}", why)));
  }
  return reasons;
}

}  // namespace hydrapod::diagnosis
