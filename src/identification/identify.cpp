#include "hydrapod/identification/identify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ranges>

#include "assumed_errors.hpp"
#include "beside_open.hpp"
#include "combination_tones.hpp"
#include "common_poles.hpp"
#include "conjugated.hpp"
#include "fit_covariance.hpp"
#include "harmonics.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/identification/cross_check.hpp"
#include "hydrapod/identification/responses.hpp"
#include "identify_steps.hpp"
#include "lower_quality.hpp"
#include "peaks_above.hpp"
#include "prune.hpp"
#include "repeated_modes.hpp"
#include "residual_tests.hpp"
#include "search.hpp"
#include "selection.hpp"
#include "set_ups.hpp"
#include "twins.hpp"
#include "usable.hpp"
#include "weak_modes.hpp"
#include "window_effect.hpp"
#include "window_trial.hpp"

namespace hydrapod::identification {

namespace {

/// Resonances that the fit has left over, while there are any.
void add_weak_modes(const IdentifyOptions& options, Identification& result) {
  for (int round = 0; round < options.weak.rounds && !result.model.modes.empty(); ++round) {
    auto weak = weak_poles(result.responses, result.model, options);
    const std::size_t before = result.clusters.size();
    auto clusters = fitted_clusters(result);
    std::ranges::move(weak, std::back_inserter(clusters));
    if (clusters.size() == before) break;
    fit_and_prune(options, std::move(clusters), result);
    if (result.clusters.size() <= before) break;
  }
}

VectorXcd displacement_shape(const FittedMode& mode, const std::vector<data::Channel>& outputs) {
  VectorXcd shape = mode.shape;
  for (Index o = 0; o < shape.size(); ++o)
    shape[o] /=
        std::pow(mode.pole, data::time_derivatives(outputs[static_cast<std::size_t>(o)].unit));
  return shape;
}

/// A little above the highest fitted mode [Hz]; 0: there is none.
double above_modes(const IdentifyOptions& options, const Identification& result) {
  double highest = 0.0;
  for (const auto& m : result.model.modes)
    if (m.damping_ratio() <= options.highest_damping) highest = std::max(highest, m.omega());
  return options.band.fit_room * highest / two_pi;
}

}  // namespace

void leave_out_above(const IdentifyOptions& options, Identification& result) {
  const double to = above_modes(options, result);
  if (options.to || to == 0.0 || to > result.to) return;
  auto narrower = within(result.responses, result.from, to);
  if (narrower.lines() < few_lines) return;
  result.responses = std::move(narrower);
  result.to = result.responses.frequency.back();
}

namespace {

/// Where lines are so coarse that hardly any lie below and among the modes, fits to all that lie
/// above them go wrong: a band of as many lines as are needed [Hz]; none: there are more than that,
/// or the band is hardly wider.
std::optional<Band> band_of_few_lines(const IdentifyOptions& options,
                                      const Identification& result) {
  const auto& frequency = result.responses.frequency;
  const double to = above_modes(options, result);
  if (options.to || to == 0.0 || frequency.size() <= few_lines || frequency[few_lines] < to ||
      frequency[few_lines] > options.band.worth * result.to)
    return std::nullopt;
  return Band{result.from, frequency[few_lines]};
}

/// Poles that covariance-driven subspace identification finds beside those of `s`.
void add_realised(const IdentifyOptions& options, Search& s) {
  const auto chart = realised_poles(impulse_response(s.responses));
  for (auto& cluster : select_poles(chart, options.selection)) {
    const auto& own = cluster.representative;
    const bool in_band = own.omega() >= two_pi * s.responses.frequency.front() &&
                         own.omega() <= two_pi * s.responses.frequency.back();
    const bool known = std::ranges::any_of(s.clusters, [&](const PoleCluster& other) {
      return is_near(own.pole, other.representative.pole, options.selection.frequency) &&
             mac(own.shape, other.representative.shape) > options.selection.vector;
    });
    if (in_band && !known && own.damping_ratio() <= options.highest_damping)
      s.clusters.push_back({.representative = own,
                            .persistence = cluster.persistence,
                            .vector_consistency = cluster.vector_consistency});
  }
}

/// A little above the highest realised pole [Hz]; none: there is none. Half spectra of samples are
/// not those of the machine far above its modes: what is folded back at half the sample rate is no
/// residual term.
std::optional<double> end_of_realised(const IdentifyOptions& options, const FrequencyResponses& r) {
  double highest = 0.0;
  for (const auto& cluster : select_poles(realised_poles(impulse_response(r)), options.selection))
    if (cluster.representative.damping_ratio() <= options.highest_damping)
      highest = std::max(highest, cluster.representative.omega() / two_pi);
  const double to = options.band.fit_room * highest;
  return to > 0.0 && to < r.frequency.back() ? std::optional(to) : std::nullopt;
}

/// Where responses came without errors: those that what is left of them shows.
void settle_errors(const IdentifyOptions& options, Identification& result) {
  if (!result.errors_assumed || result.model.modes.empty()) return;
  const auto rest = residual_of(result.responses, result.model, options.fit.taper);
  result.responses =
      with_assumed_errors(std::move(result.responses), rest.H, true, options.assumed_errors);
  if (result.responses.taper.size() > 0) add_leakage(result.responses, rest.H, result.model);
}

/// Modes from what was found, and such as show only beside them.
Identification fitted(const IdentifyOptions& options, Search s, bool errors_assumed) {
  Identification result;
  result.errors_assumed = errors_assumed;
  if (s.responses.whole) add_realised(options, s);
  result.responses = std::move(s.responses);
  result.chart = std::move(s.chart);
  result.from = result.responses.frequency.front();
  result.to = result.responses.frequency.back();
  fit_and_prune(options, std::move(s.clusters), result);
  // what follows takes errors of lines as independent, which those of half spectra are not
  if (result.responses.whole) return result;
  settle_errors(options, result);
  const std::size_t strong = result.clusters.size();
  add_weak_modes(options, result);
  settle_errors(options, result);
  add_hidden_modes(options, result);
  add_second_of_pairs(options, strong, result);
  add_pole_below_modes(options, result);
  return result;
}

}  // namespace

void add_shape_deviations(const IdentifyOptions& options, Identification& result) {
  if (options.fit.deviations != Deviations::all || result.model.modes.empty()) return;
  const auto start = estimates(result.model);
  auto fit = options.fit;
  fit.max_iterations = 0;
  fit.highest_residual_power =
      lowest_residual_power + static_cast<int>(result.model.residuals.size()) - 1;
  const auto model = fit_modes(result.responses, start, fit);
  for (std::size_t r = 0; r < start.size(); ++r)
    result.model.modes[r].shape_deviation = model.modes[r].shape_deviation;
}

namespace {

/// A tone too weak to be seen in the spectra, of which the fit has made a pole.
void add_harmonic(const FittedMode& fit, FrequencyResponses& half) {
  data::Harmonic harmonic{fit.omega() / two_pi, VectorXd(fit.shape.size())};
  // covariances φ gᵀ e^(iωτ) + conj. are A_o A_i/2 cos ωτ, so Σ_i |4 φ_o g_i|² = A_o² Σ_i A_i²
  double of_references = 0.0;
  const auto& references = half.whole->references;
  for (std::size_t i = 0; i < references.size(); ++i)
    of_references +=
        4.0 * std::abs(fit.shape[references[i]] * fit.participation[static_cast<Index>(i)]);
  harmonic.amplitude = 4.0 * fit.shape.cwiseAbs() * fit.participation.norm() /
                       std::sqrt(std::max(of_references, 1e-300));
  half.harmonics.push_back(std::move(harmonic));
  std::ranges::sort(half.harmonics, {}, &data::Harmonic::frequency);
}

bool is_finite(const FittedMode& m) {
  return std::isfinite(std::abs(m.pole)) && m.shape.allFinite() && m.participation.allFinite() &&
         std::isfinite(m.omega_deviation) && std::isfinite(m.damping_deviation) &&
         m.shape_deviation.allFinite() && std::isfinite(m.significance);
}

/// Beside noise, a deviation of exactly 0 is that of a pole that no response depends on.
bool is_determined(const FittedMode& m, const ModalModel& model) {
  return !(model.misfit > 0.0) || (m.omega_deviation > 0.0 && m.damping_deviation > 0.0);
}

}  // namespace

void list_modes(const IdentifyOptions& options, Identification& result) {
  for (std::size_t r = 0; r < result.model.modes.size(); ++r) {
    const auto& fit = result.model.modes[r];
    if (!is_finite(fit)) {
      result.left_out.push_back({{}, Objection::not_finite});
      continue;
    }
    if (!is_determined(fit, result.model)) {
      result.left_out.push_back({fit.pole, Objection::open_frequency});
      continue;
    }
    if (fit.damping_ratio() > options.highest_damping) {
      result.heavily_damped.push_back(fit);
      continue;
    }
    if (is_endless(result.responses, fit.pole)) {
      add_harmonic(fit, result.responses);
      continue;
    }
    const auto shape = displacement_shape(fit, result.responses.outputs);
    result.modes.push_back({.fit = fit,
                            .displacement = shape,
                            .persistence = result.clusters[r].persistence,
                            .vector_consistency = result.clusters[r].vector_consistency});
  }
  const auto omega = [](const auto& m) { return m.omega(); };
  std::ranges::sort(result.modes, {}, [&](const IdentifiedMode& m) { return omega(m.fit); });
  std::ranges::sort(result.heavily_damped, {}, omega);
  untangle_repeated(result.responses, result.modes);
  for (auto& mode : result.modes) {
    mode.mpc = data::modal_phase_collinearity(mode.displacement);
    mode.mpd = data::mean_phase_deviation(mode.displacement);
  }
}

void test_residual(const IdentifyOptions& options, Identification& result) {
  result.unexplained =
      unexplained_parts(result.responses, result.model, options, result.errors_assumed);
  for (auto& mode : result.modes)
    for (const auto& part : result.unexplained) {
      const double f = mode.fit.omega() / two_pi;
      if (f < part.from || f > part.to) continue;
      mode.explained = std::min({mode.explained, 1.0 / std::max(part.level, 1.0),
                                 1.0 - std::clamp(part.smooth, 0.0, 1.0)});
    }
  if (const double misfit = result.model.misfit; misfit > options.largest_misfit)
    for (auto& mode : result.modes)
      mode.explained = std::min(mode.explained, options.largest_misfit / misfit);
}

namespace {

/// `all`: with errors. Covariances of outputs are no responses: their peaks may be the
/// excitation's.
void warn_of_peaks_above(const FrequencyResponses& all, const IdentifyOptions& asked,
                         Identification& result) {
  if (asked.to || all.whole || result.modes.empty()) return;
  const auto peaks = peaks_above(all, result.to, asked);
  if (peaks.empty()) return;
  result.warnings.push_back({.kind = ModeWarning::Kind::peaks_above,
                             .value = peaks.front(),
                             .from = result.from,
                             .to = result.to,
                             .count = static_cast<std::int64_t>(peaks.size())});
}

/// Modes of conjugates that explain them much better than those of the responses as they are do:
/// then these are none. `responses`: with errors.
void test_conjugates(const FrequencyResponses& responses, const IdentifyOptions& options,
                     bool assumed, const std::function<void(double)>& progress,
                     Identification& result) {
  if (!are_before_cause(responses)) return;
  const auto other = fitted(options,
                            search_in_best_band(conjugated(responses), options,
                                                [&](double) {
                                                  if (progress) progress(1.0);
                                                }),
                            assumed);
  if (std::ranges::none_of(other.model.modes, [&](const FittedMode& mode) {
        return mode.damping_ratio() <= options.highest_damping;
      }))
    return;
  const double left = other.model.error;
  const double left_of_given =
      std::min(1.0, share_left_by(result.model, within(responses, other.from, other.to)));
  if (!(left < of_conjugates * left_of_given)) return;
  result.warnings.push_back({.kind = ModeWarning::Kind::conjugated,
                             .value = left,
                             .from = other.from,
                             .to = other.to,
                             .share = left_of_given});
  for (auto& mode : result.modes) mode.explained = 0.0;
}

/// Forces that nobody measured have a spectrum of their own: below the lowest mode their real poles
/// are no modes, and modes there would have to be them.
void begin_at_lowest_mode(const FrequencyResponses& half, IdentifyOptions options,
                          Identification& result) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const auto& mode : result.model.modes)
    if (mode.damping_ratio() <= options.highest_damping)
      lowest = std::min(lowest, mode.omega() / two_pi);
  const double from = options.band.below * lowest;
  if (!std::isfinite(lowest) || !(from > result.from)) return;
  options.from = from;
  options.to = result.to;
  auto other = fitted(options, search_in_best_band(half, options, {}), false);
  if (other.model.modes.size() >= result.model.modes.size()) result = std::move(other);
}

/// Of responses as they are; with errors, also where these were assumed.
Identification identified(const FrequencyResponses& given, const IdentifyOptions& asked,
                          const std::function<void(double)>& progress) {
  auto options = asked;
  if (given.whole) {
    options.least_significance = asked.least_significance_of_outputs;
    if (!options.to) options.to = end_of_realised(options, given);
  }
  if (given.lines() < fewest_lines)
    throw base::ComputationError(
        fmt::format("{} frequencies are too few to find modes in; at "
                    "least {} are needed",
                    given.lines(), fewest_lines));
  const bool assumed = !given.has_errors();
  if (assumed && given.line_covariance.size() > 1)
    options.assumed_errors.line_covariance = given.line_covariance;
  std::optional<FrequencyResponses> with_errors;  // responses of many lines are large
  if (assumed) with_errors = with_assumed_errors(given, given.H, false, options.assumed_errors);
  const auto& responses = with_errors ? *with_errors : given;
  auto result = fitted(options, search_in_best_band(responses, options, progress), assumed);
  if (const auto narrower = band_of_few_lines(options, result)) {
    auto other = fitted(options, search(responses, *narrower, options, progress), assumed);
    if (!other.model.modes.empty()) result = std::move(other);
  }
  if (given.whole && !asked.from) begin_at_lowest_mode(responses, options, result);
  if (!result.model.modes.empty()) {
    leave_out_above(options, result);
    settle_residuals(options, result);
  }
  add_shape_deviations(options, result);
  if (!given.whole) widen_beside_open_poles(options, result);
  list_modes(options, result);
  if (!given.whole) test_residual(options, result);
  lower_quality(given, result);
  add_warnings(options, result);
  warn_of_peaks_above(responses, asked, result);
  test_conjugates(responses, options, assumed, progress, result);
  return result;
}

}  // namespace

Identification identify_modes(const FrequencyResponses& all, const IdentifyOptions& asked,
                              const std::function<void(double)>& progress) {
  const UsableResponses usable(all);
  const auto& given = usable.get();
  auto result = identified(given, asked, progress);
  try_windows(given, asked, identified, progress, result);
  warn_of_twins(asked, result);
  if (!given.whole) find_common_poles(result);
  warn_of_set_ups(result);
  warn_of_combination_tones(result);
  if (!given.has_errors()) remove_errors(result.responses);
  return result;
}

}  // namespace hydrapod::identification
