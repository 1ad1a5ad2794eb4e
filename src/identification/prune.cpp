#include "prune.hpp"

#include <algorithm>
#include <cmath>

#include "names.hpp"
#include "search.hpp"
#include "trial_fit.hpp"

namespace hydrapod::identification {

namespace {

Objection objection_to(const FittedMode& m, const Band& band, const IdentifyOptions& options) {
  const double f = m.omega() / two_pi;
  if (f < band.from || f > band.to) return Objection::left_band;
  if (m.significance < options.least_significance) return Objection::in_noise;
  if (m.omega_deviation > options.largest_frequency_deviation * m.omega())
    return Objection::open_frequency;
  if (m.damping_deviation >
      options.largest_damping_deviation * std::max(m.damping_ratio(), options.prune.damping_floor))
    return Objection::open_damping;
  return Objection::none;
}

/// Two poles closer than the mean of their decay rates, with the same shape and participation, are
/// one.
bool is_double(const FittedMode& a, const FittedMode& b, double same) {
  const double apart = std::abs(a.pole - b.pole);
  const double width = 0.5 * (std::abs(a.pole.real()) + std::abs(b.pole.real()));
  return apart < width && mac(a.shape, b.shape) > same &&
         mac(a.participation, b.participation) > same;
}

/// Of modes that overlap so much that none of them is determined, one less may determine the
/// others: does another go first?
bool another_first(const ModalModel& model, std::size_t r, const Band& band,
                   const IdentifyOptions& options) {
  const auto& mode = model.modes[r];
  const auto badly = [](const FittedMode& m) { return m.omega_deviation / m.omega(); };
  return std::ranges::any_of(model.modes, [&](const FittedMode& m) {
    return badly(m) > badly(mode) &&
           std::abs(m.pole - mode.pole) < std::abs(m.pole.real()) + std::abs(mode.pole.real()) &&
           m.damping_ratio() <= options.highest_damping &&
           objection_to(m, band, options) != Objection::none;
  });
}

/// What is taken out is judged by its pole. False where `tried` is given and a mode from there on
/// does not stand above the noise.
bool fit_clusters(const IdentifyOptions& options, const std::vector<PoleCluster>& clusters,
                  std::optional<std::size_t> tried, Identification& result) {
  std::vector<PoleEstimate> start;
  for (const auto& c : clusters) start.push_back(c.representative);
  auto poles_alone = options.fit;
  poles_alone.deviations = Deviations::poles;
  if (!tried) {
    result.model = fit_modes(result.responses, start, poles_alone);
    return true;
  }
  auto model = fit_if_worth(result.responses, start, poles_alone,
                            {*tried, options.least_significance, options.trial.patience});
  if (model) result.model = std::move(*model);
  return model.has_value();
}

/// Of each mode of the model, which are as many as clusters.
std::vector<Objection> objections(const IdentifyOptions& options, const Band& band,
                                  const std::vector<PoleCluster>& clusters,
                                  const Identification& result) {
  const auto& modes = result.model.modes;
  std::vector<Objection> all;
  for (std::size_t r = 0; r < clusters.size(); ++r) {
    const auto& mode = modes[r];
    // a heavily damped pole may be anywhere: it is no mode and only helps the fit
    const bool heavy = mode.damping_ratio() > options.highest_damping;
    auto objection = !heavy ? objection_to(mode, band, options)
                     : mode.significance < options.least_significance ? Objection::in_noise
                                                                      : Objection::none;
    for (std::size_t q = 0; q < clusters.size() && objection == Objection::none; ++q)
      if (q != r && is_double(mode, modes[q], options.prune.same_vector) &&
          (clusters[q].members.size() > clusters[r].members.size() ||
           (clusters[q].members.size() == clusters[r].members.size() && q < r)))
        objection = Objection::doubles;
    const bool open = objection == Objection::open_frequency ||
                      objection == Objection::open_damping ||
                      (objection == Objection::in_noise && result.responses.whole);
    if (open && another_first(result.model, r, band, options)) objection = Objection::none;
    all.push_back(objection);
  }
  return all;
}

/// It may be a mode, of which too little is known.
bool is_open(Objection objection) {
  return objection == Objection::in_noise || objection == Objection::open_frequency ||
         objection == Objection::open_damping;
}

/// What the fit was before something was taken out.
struct Before {
  std::vector<PoleCluster> clusters{};
  ModalModel model{};
  std::size_t left_out{};
};

/// The one that stands out least of those that are objected to; none: none is.
std::optional<std::size_t> weakest(const std::vector<Objection>& objections,
                                   const ModalModel& model) {
  std::optional<std::size_t> at;
  for (std::size_t r = 0; r < objections.size(); ++r)
    if (objections[r] != Objection::none &&
        (!at || model.modes[r].significance < model.modes[*at].significance))
      at = r;
  return at;
}

/// Of half spectra: takes out one after the other what is objected to, but for what the rest cannot
/// be fitted without. `before`: that fit.
void prune_one_by_one(const IdentifyOptions& options, const Band& band, Before before,
                      Identification& result) {
  std::vector<char> needed(before.clusters.size());
  while (!before.clusters.empty()) {
    result.model = before.model;
    result.left_out.resize(before.left_out);
    auto against = objections(options, band, before.clusters, result);
    for (std::size_t r = 0; r < needed.size(); ++r)
      if (needed[r]) against[r] = Objection::none;
    const auto worst = weakest(against, result.model);
    if (!worst) break;
    auto kept = before.clusters;
    const auto at = static_cast<std::ptrdiff_t>(*worst);
    kept.erase(kept.begin() + at);
    if (kept.empty()) {  // nothing is left that could miss it
      result.left_out.push_back({before.model.modes[*worst].pole, against[*worst]});
      before.clusters.clear();
      break;
    }
    fit_clusters(options, kept, {}, result);
    if (is_open(against[*worst]) && result.model.misfit > needed_by_others * before.model.misfit) {
      needed[*worst] = 1;
      continue;
    }
    result.left_out.push_back({before.model.modes[*worst].pole, against[*worst]});
    needed.erase(needed.begin() + at);
    for (std::size_t r = 0; r < kept.size(); ++r) kept[r].representative = result.model.modes[r];
    before = {std::move(kept), result.model, result.left_out.size()};
  }
  if (before.clusters.empty()) result.model = {};
  result.clusters = std::move(before.clusters);
}

/// `tried`: false where something was objected to, which then is the end.
bool fit_and_judge(const IdentifyOptions& options, std::vector<PoleCluster> clusters,
                   std::optional<std::size_t> tried, Identification& result) {
  const Band band{result.from, result.to};
  std::optional<Before> before;
  for (int round = 0; round < options.prune.rounds && !clusters.empty(); ++round) {
    if (!fit_clusters(options, clusters, tried, result)) return false;
    if (before && result.model.misfit > needed_by_others * before->model.misfit) {
      prune_one_by_one(options, band, std::move(*before), result);
      return true;
    }
    const auto against = objections(options, band, clusters, result);
    std::vector<PoleCluster> kept;
    const std::size_t left_out = result.left_out.size();
    for (std::size_t r = 0; r < clusters.size(); ++r) {
      if (against[r] != Objection::none) {
        result.left_out.push_back({result.model.modes[r].pole, against[r]});
        continue;
      }
      kept.push_back(clusters[r]);
      kept.back().representative = result.model.modes[r];
    }
    if (kept.size() == clusters.size()) break;
    if (tried) return false;
    if (result.responses.whole) before = {std::move(clusters), result.model, left_out};
    clusters = std::move(kept);
    if (clusters.empty()) result.model = {};
  }
  // the last round took something out: model and clusters are indexed alike
  if (result.model.modes.size() != clusters.size()) fit_clusters(options, clusters, {}, result);
  result.clusters = std::move(clusters);
  return true;
}

}  // namespace

void fit_and_prune(const IdentifyOptions& options, std::vector<PoleCluster> clusters,
                   Identification& result) {
  fit_and_judge(options, std::move(clusters), {}, result);
}

bool fit_if_all_stay(const IdentifyOptions& options, std::vector<PoleCluster> clusters,
                     std::size_t tried, Identification& result) {
  return fit_and_judge(options, std::move(clusters), tried, result);
}

std::vector<PoleEstimate> estimates(const ModalModel& model) {
  return {model.modes.begin(), model.modes.end()};
}

std::vector<PoleCluster> fitted_clusters(const Identification& result) {
  auto clusters = result.clusters;
  for (std::size_t r = 0; r < clusters.size(); ++r)
    clusters[r].representative = result.model.modes[r];
  return clusters;
}

}  // namespace hydrapod::identification
