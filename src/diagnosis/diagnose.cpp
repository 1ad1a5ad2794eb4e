#include "hydrapod/diagnosis/diagnose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>
#include <tuple>

#include "evidence.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/diagnosis/responses.hpp"
#include "hydrapod/simulation/tuning.hpp"
#include "ranking.hpp"
#include "words.hpp"

namespace hydrapod::diagnosis {

namespace {

using calibration::Progress;
using Charges = std::vector<std::vector<std::size_t>>;

/// Share of the work from `from` to `to`; safe to be asked by several threads.
class Watch {
 public:
  explicit Watch(const Progress& progress) : progress_(progress) {}
  [[nodiscard]] bool stopped() const { return stopped_; }
  bool at(double share) {
    if (progress_ && progress_(share)) stopped_ = true;
    return stopped_;
  }

 private:
  const Progress& progress_;
  bool stopped_{false};
};

/// Explanations by `charges`, in their order; those that no machine with modes fits are left out.
std::vector<Explanation> try_charges(const Evidence& evidence, const Charges& charges,
                                     const std::vector<Explanation>& known, int threads,
                                     Watch& watch, double from, double to) {
  std::vector<std::optional<Explanation>> found(charges.size());
  const auto known_of = [&](const std::vector<std::size_t>& blamed) -> const Explanation* {
    if (blamed.size() < 2) return nullptr;
    const Explanation* best = nullptr;
    for (const auto& e : known)
      if (e.suspects.size() == 1 && std::ranges::count(blamed, e.suspects[0]) > 0 &&
          (best == nullptr || e.misfit < best->misfit))
        best = &e;
    return best;
  };
  for_all(
      charges.size(), threads,
      [&](std::size_t k) {
        try {
          found[k] = evidence.explain(charges[k], known_of(charges[k]), {});
        } catch (const base::ComputationError&) {  // no such machine has modes
        } catch (const base::InputError&) {        // nor can it be one: a number out of its bounds
        }
      },
      [&](double share) { return watch.at(from + (to - from) * share); });
  std::vector<Explanation> explanations;
  for (auto& e : found)
    if (e) explanations.push_back(std::move(*e));
  return explanations;
}

/// Pairs that hold one of those that explain most alone: what explains the data together with
/// another also explains most of them alone.
Charges pairs(const Diagnosis& d, std::size_t strongest) {
  std::set<std::vector<std::size_t>> found;
  std::size_t taken = 0;
  for (const auto& e : d.explanations) {
    if (e.suspects.size() != 1) continue;
    const std::size_t a = e.suspects.front();
    if (!d.suspects[a].in_pairs) continue;
    if (taken++ >= strongest) break;
    for (std::size_t b = 0; b < d.suspects.size(); ++b)
      if (can_be_together(d.suspects[a], d.suspects[b]))
        found.insert({std::min(a, b), std::max(a, b)});
  }
  // both seals at once, though either alone may explain little
  for (std::size_t a = 0; a < d.suspects.size(); ++a)
    for (std::size_t b = a + 1; b < d.suspects.size(); ++b) {
      const auto& [sleeves, rings] = std::tie(d.suspects[a], d.suspects[b]);
      if (sleeves.family == "guide sleeves" && rings.family == "piston rings" && !sleeves.leg &&
          !rings.leg)
        found.insert({a, b});
    }
  return {found.begin(), found.end()};
}

/// Those that come first by `criterion`, and all within reach of the first.
void choose(const std::vector<double>& criterion, std::vector<char>& chosen) {
  constexpr std::size_t best = 12;
  constexpr double reach = 40.0;
  std::vector<double> ordered = criterion;
  std::ranges::sort(ordered);
  if (ordered.empty()) return;
  const double limit =
      std::max(ordered[std::min(best, ordered.size()) - 1], ordered.front() + reach);
  for (std::size_t k = 0; k < criterion.size(); ++k) chosen[k] |= criterion[k] <= limit;
}

/// Fits explanations that modes of mechanics found to everything: those that are near the best by
/// those modes or by everything with the same numbers. The others keep these numbers, and what
/// everything makes of them is their misfit.
void fit_to_all(const Evidence& evidence, std::vector<Explanation>& found, double values,
                int threads, Watch& watch, double from, double to) {
  if (!evidence.in_two_steps()) return;
  const auto criteria = [&] {
    std::vector<double> all;
    for (const auto& e : found) all.push_back(e.misfit + e.parameters * std::log(values));
    return all;
  };
  const auto show = [&](double share) { return watch.at(from + (to - from) * share); };
  std::vector<char> chosen(found.size(), 0);
  choose(criteria(), chosen);
  for_all(
      found.size(), threads, [&](std::size_t k) { evidence.see(found[k]); },
      [&](double share) { return show(0.3 * share); });
  choose(criteria(), chosen);
  for_all(
      found.size(), threads,
      [&](std::size_t k) {
        if (chosen[k] == 0) return;
        evidence.polish(found[k], false, {});
        // it may have been led astray by mechanics
        if (found[k].suspects.size() == 1 && found[k].misfit > values)
          evidence.polish(found[k], true, {});
      },
      [&](double share) { return show(0.3 + 0.7 * share); });
}

/// Could a pair that fits perfectly still be the best?
bool pairs_can_win(const Diagnosis& d) {
  const auto n = static_cast<double>(d.values);
  const double least = 2.0 * std::log(n) + hypothesis_penalty(d.suspects.size(), 2);
  return least < d.best().criterion;
}

void describe(const Evidence& evidence, Diagnosis& d, int threads, Watch& watch) {
  constexpr std::size_t first = 16;
  std::vector<std::size_t> described;  // the best, and what is no single leg
  for (std::size_t k = 0; k < d.explanations.size(); ++k) {
    const auto& e = d.explanations[k];
    const bool of_all =
        e.suspects.empty() || (e.suspects.size() == 1 && !d.suspects[e.suspects.front()].leg);
    if (k < first || of_all) described.push_back(k);
  }
  const auto stated = d.as_stated();
  for_all(
      described.size(), threads,
      [&](std::size_t k) {
        auto& e = d.explanations[described[k]];
        e.wrong = what_is_wrong(evidence, e);
        if (e.wrong.empty() || e.suspects.size() != 1) return;
        try {
          const auto against = contrary(evidence, stated, e, {});
          if (!against.empty()) e.wrong.insert(e.wrong.begin(), against);
        } catch (const base::ComputationError&) {
        } catch (const base::InputError&) {
        }
      },
      [&](double share) { return watch.at(0.9 + 0.08 * share); });
}

/// A controller stays as it was tuned for the machine as stated, whatever is wrong with that. Why
/// it cannot be had; empty: it can.
std::string hold_controllers(const model::MachineFile& file, calibration::Targets& targets) {
  if (targets.observed != calibration::Observed::system) return {};
  try {
    for (const auto& pose : file.machine.poses)
      if (std::ranges::count(targets.modes, pose.name, &calibration::ModeTarget::pose) > 0)
        targets.controllers.try_emplace(
            pose.name, simulation::tune_controller(file.machine, pose.X_BP).parameters);
  } catch (const base::ComputationError& error) {
    return error.what();
  }
  return {};
}

/// Deviations of what is blamed, with the model's error.
void widen(const Evidence& evidence, Diagnosis& d, double frequency_error, Watch& watch) {
  for (const auto k : d.alike) {
    if (watch.stopped()) return;
    auto& e = d.explanations[k];
    if (e.suspects.empty()) continue;
    try {
      evidence.widen(e, frequency_error);
    } catch (const base::ComputationError&) {  // no machine near this one has modes
    } catch (const base::InputError&) {
    }
  }
}

/// What is compared: modes with the deviations that count, of the system that was measured or,
/// where the machine as stated cannot be had so, of mechanics; lines of responses.
void take_targets(const model::MachineFile& file, const calibration::Targets& measured,
                  dynamics::ModelKind kind, const DiagnoseOptions& options, Diagnosis& d) {
  d.targets.responses.clear();
  if (d.targets.observed != calibration::Observed::mechanics) {
    auto why = hold_controllers(file, d.targets);
    if (why.empty()) why = plant_refused(file, d.targets, kind);
    if (!why.empty()) {
      d.notes.push_back(fmt::format(
          "compared with mechanics on oil springs, though the {} was measured: the machine as "
          "stated with its hydraulics: {}",
          d.targets.observed == calibration::Observed::plant ? "plant from the drives of the valves"
                                                             : "machine under its controller",
          why));
      d.targets.observed = calibration::Observed::mechanics;
    }
  }
  if (!options.responses) return;
  auto seen = measured;
  seen.observed = d.targets.observed;
  seen.controllers = d.targets.controllers;
  d.targets.responses = chosen_lines(file, seen, kind, options);
}

}  // namespace

const char* name(Finding finding) {
  switch (finding) {
    case Finding::nothing_to_blame:
      return "nothing to blame";
    case Finding::as_stated:
      return "as stated";
    case Finding::guilty:
      return "guilty";
    case Finding::undecided:
      return "undecided";
    case Finding::unexplained:
      return "unexplained";
    case Finding::do_not_belong:
      break;
  }
  return "do not belong together";
}

const Explanation* Diagnosis::find(const std::string& wanted) const {
  const auto at = std::ranges::find(explanations, wanted, &Explanation::name);
  return at == explanations.end() ? nullptr : &*at;
}

const Explanation& Diagnosis::as_stated() const {
  return *std::ranges::find_if(explanations,
                               [](const auto& e) { return e.suspects.empty() && !e.rigid; });
}

Diagnosis diagnose(const model::MachineFile& file, const calibration::Targets& measured,
                   dynamics::ModelKind kind, const std::vector<model::NamedPose>& poses,
                   const DiagnoseOptions& options, const Progress& progress) {
  Diagnosis d{.suspects = suspects_of(file), .targets = weighted_targets(file, measured, options)};
  take_targets(file, measured, kind, options, d);
  d.values = values_in(d.targets);
  const Evidence evidence(file, d.targets, kind, d.suspects);
  Watch watch(progress);
  d.explanations.push_back(evidence.as_stated());
  d.reasons = objections(evidence, d.as_stated());
  if (!d.reasons.empty()) {
    d.finding = Finding::do_not_belong;
    rank(d);
    trace_modes(file, d);
    return d;
  }
  d.explanations.push_back(evidence.rigid());
  Charges alone;
  for (std::size_t a = 0; a < d.suspects.size(); ++a) alone.push_back({a});
  auto singles = try_charges(evidence, alone, {}, options.threads, watch, 0.0, 0.3);
  fit_to_all(evidence, singles, d.values, options.threads, watch, 0.3, 0.4);
  for (auto& e : singles) d.explanations.push_back(std::move(e));
  rank(d);
  if (!watch.stopped() && pairs_can_win(d)) {
    auto found = try_charges(evidence, pairs(d, options.strongest), d.explanations, options.threads,
                             watch, 0.4, evidence.in_two_steps() ? 0.75 : 0.9);
    fit_to_all(evidence, found, d.values, options.threads, watch, 0.75, 0.9);
    for (auto& e : found) d.explanations.push_back(std::move(e));
    rank(d);
  }
  judge(d);
  if (!d.alike.empty()) widen(evidence, d, options.frequency_error, watch);
  trace_modes(file, d);
  if (!watch.stopped()) describe(evidence, d, options.threads, watch);
  if (d.alike.empty()) d.reasons = unexplained(d);
  for (std::size_t k = 1; k < d.alike.size() && !watch.stopped(); ++k)
    if (auto found = discriminate(file, d, d.alike[k], poses, options.frequency_error))
      d.discriminators.push_back(*found);
  d.interrupted = watch.stopped();
  return d;
}

}  // namespace hydrapod::diagnosis
