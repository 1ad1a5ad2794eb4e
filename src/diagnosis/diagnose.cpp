#include "hydrapod/diagnosis/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "evidence.hpp"
#include "hydrapod/numerics/parallel.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "ranking.hpp"
#include "responses.hpp"

namespace hydrapod::diagnosis {

namespace {

using numerics::parallel_for;
using numerics::Progress;
using numerics::Watch;
using Charges = std::vector<std::vector<std::size_t>>;

/// Hypotheses by `charges`, in their order; those that no machine with modes fits go to `untested`.
std::vector<Hypothesis> try_charges(const Evidence& evidence, const Charges& charges,
                                    const std::vector<Hypothesis>& known, int threads, Watch& watch,
                                    double from, double to, std::vector<Untested>& untested) {
  std::vector<std::optional<Hypothesis>> found(charges.size());
  std::vector<std::optional<std::string>> errors(charges.size());
  const auto known_of = [&](const std::vector<std::size_t>& causes) -> const Hypothesis* {
    if (causes.size() < 2) return nullptr;
    const Hypothesis* best = nullptr;
    for (const auto& e : known)
      if (e.causes.size() == 1 && std::ranges::count(causes, e.causes[0]) > 0 &&
          (best == nullptr || e.misfit < best->misfit))
        best = &e;
    return best;
  };
  parallel_for(
      charges.size(), threads,
      [&](std::size_t k) {
        errors[k] = why_impossible(
            [&] { found[k] = evidence.explain(charges[k], known_of(charges[k]), {}); });
      },
      [&](double share) { return watch.at(from + (to - from) * share); });
  std::vector<Hypothesis> hypotheses;
  for (auto& e : found)
    if (e) hypotheses.push_back(std::move(*e));
  // of a pair with a cause that was not tested alone nothing else is to be said
  const auto singles = untested;
  for (std::size_t k = 0; k < charges.size(); ++k)
    if (errors[k] && std::ranges::none_of(singles, [&](const Untested& one) {
          return one.causes.size() == 1 && std::ranges::count(charges[k], one.causes[0]) > 0;
        }))
      untested.push_back({charges[k], *errors[k]});
  return hypotheses;
}

/// The causes that explain most alone: what explains the data together with another mostly
/// explains much of them alone.
std::vector<std::size_t> strongest(const Diagnosis& d, std::size_t count) {
  std::vector<std::size_t> found;
  for (const auto& e : d.hypotheses)
    if (e.causes.size() == 1 && d.causes[e.causes.front()].in_pairs() && found.size() < count)
      found.push_back(e.causes.front());
  return found;
}

/// Pairs of `some` with all others, and both seals at once, though either alone may explain little;
/// without those of `tried`, to which they are added.
Charges pairs_of(const std::vector<std::size_t>& some, const Diagnosis& d,
                 std::set<std::vector<std::size_t>>& tried) {
  Charges found;
  const auto add = [&](std::size_t a, std::size_t b) {
    std::vector<std::size_t> pair{std::min(a, b), std::max(a, b)};
    if (tried.insert(pair).second) found.push_back(std::move(pair));
  };
  for (const auto a : some)
    for (std::size_t b = 0; b < d.causes.size(); ++b)
      if (can_be_together(d.causes[a], d.causes[b])) add(a, b);
  const auto of_all = [&](Cause::Kind kind) {
    return std::ranges::find_if(d.causes, [&](const Cause& s) { return s.kind == kind && !s.leg; });
  };
  const auto sleeves = of_all(Cause::Kind::guide_sleeves);
  const auto rings = of_all(Cause::Kind::piston_rings);
  if (sleeves != d.causes.end() && rings != d.causes.end())  // struts have none
    add(static_cast<std::size_t>(sleeves - d.causes.begin()),
        static_cast<std::size_t>(rings - d.causes.begin()));
  std::ranges::sort(found);
  return found;
}

/// Those that come first by `bic`, and all within reach of the first.
void choose(const std::vector<double>& bic, std::vector<char>& near_best) {
  constexpr std::size_t best = 12;
  constexpr double reach = 40.0;
  std::vector<double> ordered = bic;
  std::ranges::sort(ordered);
  if (ordered.empty()) return;
  const double limit =
      std::max(ordered[std::min(best, ordered.size()) - 1], ordered.front() + reach);
  for (std::size_t k = 0; k < bic.size(); ++k) near_best[k] |= bic[k] <= limit;
}

/// Fits hypotheses that modes of mechanics found to everything: those that are near the best by
/// those modes or by everything with the same numbers. The others keep these numbers, and what
/// everything makes of them is their misfit.
void fit_to_all(const Evidence& evidence, std::vector<Hypothesis>& found, double values,
                int threads, Watch& watch, double from, double to) {
  if (!evidence.in_two_steps()) return;
  const auto criteria = [&] {
    std::vector<double> all;
    for (const auto& e : found) all.push_back(e.misfit + e.parameters * std::log(values));
    return all;
  };
  const auto show = [&](double share) { return watch.at(from + (to - from) * share); };
  std::vector<char> near_best(found.size(), 0);
  choose(criteria(), near_best);
  parallel_for(
      found.size(), threads, [&](std::size_t k) { evidence.see(found[k]); },
      [&](double share) { return show(0.3 * share); });
  choose(criteria(), near_best);
  parallel_for(
      found.size(), threads,
      [&](std::size_t k) {
        const bool single = found[k].causes.size() == 1;
        if (near_best[k] != 0) {
          evidence.polish(found[k], false, {});
          // it may have been led astray by mechanics
          if (single && found[k].misfit > values) evidence.polish(found[k], true, {});
        }
        if (single && found[k].misfit > values) evidence.scan_seals(found[k], {});
      },
      [&](double share) { return show(0.3 + 0.7 * share); });
}

/// Hypotheses that hold a cause, best first, each with numbers of its own for it: at most
/// `most` of them for each cause.
std::vector<std::vector<const Hypothesis*>> by_cause(const std::vector<Hypothesis>& all,
                                                     std::size_t causes, std::size_t most) {
  std::vector<const Hypothesis*> ordered;
  for (const auto& e : all) ordered.push_back(&e);
  std::ranges::stable_sort(ordered, {}, &Hypothesis::misfit);
  std::vector<std::vector<const Hypothesis*>> found(causes);
  for (const auto* e : ordered)
    for (const auto k : e->causes)
      if (found[k].size() < most && std::ranges::none_of(found[k], [&](const auto* other) {
            return same_numbers(*e, *other);
          }))
        found[k].push_back(e);
  return found;
}

/// A fit may end beside the best numbers: singles, and pairs near the best, go on from what others
/// found for the same causes, where that is better than their own.
void learn_from_each_other(const Evidence& evidence, Diagnosis& d, int threads, Watch& watch,
                           double from, double to) {
  constexpr double near = 60.0;
  constexpr std::size_t most = 4;
  const double limit = d.best().bic + near;
  const auto before = d.hypotheses;
  const auto found = by_cause(before, d.causes.size(), most);
  parallel_for(
      before.size(), threads,
      [&](std::size_t k) {
        auto& e = d.hypotheses[k];
        const bool single = e.causes.size() == 1, pair = e.causes.size() == 2;
        if (single || (pair && e.bic < limit)) evidence.learn(e, found, {});
      },
      [&](double share) { return watch.at(from + (to - from) * share); });
}

/// Could a pair that fits perfectly still be the best?
bool pairs_can_win(const Diagnosis& d) {
  const auto n = static_cast<double>(d.values);
  const double least = 2.0 * std::log(n) + hypothesis_penalty(d.causes.size(), 2);
  return least < d.best().bic;
}

/// Pairs of the strongest with all others; where a pair explains the data best, also of its two
/// with all others, of which one may have explained little alone.
void try_pairs(const Evidence& evidence, const DiagnoseOptions& options, Diagnosis& d,
               Watch& watch) {
  constexpr int rounds = 3;
  constexpr double begin = 0.4, most = 0.8, end = 0.85;
  std::set<std::vector<std::size_t>> tried;
  auto some = strongest(d, options.strongest);
  for (int round = 0; round < rounds && !watch.stopped(); ++round) {
    const auto charges = pairs_of(some, d, tried);
    const double from = round == 0 ? begin : most, to = round == 0 ? most : end;
    const double found_at = evidence.in_two_steps() ? from + 0.8 * (to - from) : to;
    auto found = try_charges(evidence, charges, d.hypotheses, options.threads, watch, from,
                             found_at, d.untested);
    fit_to_all(evidence, found, d.values, options.threads, watch, found_at, to);
    for (auto& e : found) d.hypotheses.push_back(std::move(e));
    rank(d);
    some = d.best().causes;
    if (some.size() < 2) break;
  }
  learn_from_each_other(evidence, d, options.threads, watch, end, 0.9);
  rank(d);
}

void describe(const Evidence& evidence, Diagnosis& d, int threads, Watch& watch) {
  constexpr std::size_t first = 16;
  std::vector<std::size_t> described;  // the best, and what is no single leg
  for (std::size_t k = 0; k < d.hypotheses.size(); ++k) {
    const auto& e = d.hypotheses[k];
    const bool of_all =
        e.causes.empty() || (e.causes.size() == 1 && !d.causes[e.causes.front()].leg);
    if (k < first || of_all) described.push_back(k);
  }
  const auto stated = d.nominal();
  parallel_for(
      described.size(), threads,
      [&](std::size_t k) {
        auto& e = d.hypotheses[described[k]];
        e.wrong = what_is_wrong(evidence, e);
        if (e.wrong.empty() || e.causes.size() != 1) return;
        if_possible([&] {
          if (const auto against = contrary(evidence, stated, e, {}))
            e.wrong.insert(e.wrong.begin(), *against);
        });
      },
      [&](double share) { return watch.at(0.9 + 0.08 * share); });
}

/// A controller stays as it was tuned for the nominal machine, whatever is wrong with that. Why
/// it cannot be had; none: it can.
std::optional<std::string> hold_controllers(const model::MachineFile& file,
                                            observation::Targets& targets) {
  if (targets.observed != observation::Observed::system) return {};
  try {
    for (const auto& pose : file.machine.poses)
      if (std::ranges::count(targets.modes, pose.name, &observation::ModeTarget::pose) > 0)
        targets.controllers.try_emplace(
            pose.name, simulation::tune_controller(file.machine, pose.X_BP).parameters);
  } catch (const base::ComputationError& error) {
    return error.what();
  }
  return {};
}

/// Deviations of what is blamed, with the model's error.
void widen(const Evidence& evidence, Diagnosis& d, double frequency_error, Watch& watch) {
  for (const auto k : d.equivalent) {
    if (watch.stopped()) return;
    auto& e = d.hypotheses[k];
    if (!e.causes.empty()) if_possible([&] { evidence.widen(e, frequency_error); });
  }
}

/// What is compared: modes with the deviations that count, of the system that was measured or,
/// where the nominal machine cannot be had so, of mechanics; lines of responses.
void take_targets(const model::MachineFile& file, const observation::Targets& measured,
                  dynamics::ModelKind kind, const DiagnoseOptions& options, Diagnosis& d) {
  d.targets.responses.clear();
  if (d.targets.observed != observation::Observed::mechanics) {
    auto error = hold_controllers(file, d.targets);
    if (!error) error = plant_refused(file, d.targets, kind);
    if (error) {
      d.substitution = {d.targets.observed, *error};
      d.targets.observed = observation::Observed::mechanics;
    }
  }
  if (!options.responses) return;
  auto seen = measured;
  seen.observed = d.targets.observed;
  seen.controllers = d.targets.controllers;
  d.targets.responses = chosen_lines(file, seen, kind, options);
}

}  // namespace

double Hypothesis::response_misfit() const {
  double sum = 0.0;
  for (const auto& response : fit.responses) sum += response.difference * response.difference;
  return sum;
}

const Hypothesis& Diagnosis::nominal() const {
  return *std::ranges::find_if(hypotheses,
                               [](const auto& e) { return e.causes.empty() && !e.rigid; });
}

Diagnosis diagnose(const model::MachineFile& file, const observation::Targets& measured,
                   dynamics::ModelKind kind, const std::vector<model::NamedPose>& poses,
                   const DiagnoseOptions& options, const Progress& progress) {
  Diagnosis d{.causes = causes_of(file), .targets = weighted_targets(file, measured, options)};
  take_targets(file, measured, kind, options, d);
  settle_air(file, d.targets, kind, d.causes);
  d.values = values_in(d.targets);
  const Evidence evidence(file, d.targets, kind, d.causes);
  Watch watch(progress);
  d.hypotheses.push_back(evidence.nominal());
  d.objections = objections(evidence, d.nominal());
  if (!d.objections.empty()) {
    d.finding = Finding::do_not_belong;
    rank(d);
    trace_modes(file, d);
    return d;
  }
  d.hypotheses.push_back(evidence.rigid());
  Charges alone;
  for (std::size_t a = 0; a < d.causes.size(); ++a) alone.push_back({a});
  auto singles = try_charges(evidence, alone, {}, options.threads, watch, 0.0, 0.3, d.untested);
  fit_to_all(evidence, singles, d.values, options.threads, watch, 0.3, 0.4);
  for (auto& e : singles) d.hypotheses.push_back(std::move(e));
  rank(d);
  if (!watch.stopped() && pairs_can_win(d)) try_pairs(evidence, options, d, watch);
  if (watch.stopped())  // what is best so far may not be so in the end
    d.finding = Finding::interrupted;
  else
    judge(d);
  find_slips(file, kind, d);
  if (!d.equivalent.empty() && options.common_share == 0.0)
    widen(evidence, d, options.frequency_error, watch);
  trace_modes(file, d);
  if (!watch.stopped()) describe(evidence, d, options.threads, watch);
  Predictions predictions(file, d.targets, kind);
  for (std::size_t k = 1; k < d.equivalent.size() && !watch.stopped(); ++k)
    if (auto found = discriminate(predictions, d, d.equivalent[k], poses, options.frequency_error))
      d.discriminators.push_back(*found);
  d.interrupted = watch.stopped();
  return d;
}

}  // namespace hydrapod::diagnosis
