#include "hydrapod/report/measured_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "fitted_parameter.hpp"
#include "hydrapod/base/units.hpp"

namespace hydrapod::report {

namespace {

using namespace calibration;
using observation::ModeTarget;
using observation::Targets;

using base::two_pi;

}  // namespace

const char* verdict_word(Verdict verdict) {
  static constexpr std::array words{"determined", "not determined", "one of several",
                                    "at its bound", "by the prior"};
  return words.at(static_cast<std::size_t>(verdict));
}

template <class Fields>
void describe(Fields& f, FittedParameter& p) {
  describe_parameter(f, p, true);
}

template <class Fields>
void describe(Fields& f, Trade& trade) {
  f("parameters", trade.parameters);
  f("relative_direction", trade.direction);
  f("relative_deviation", trade.deviation);
  f("words", trade.words);
}

template <class Fields>
void describe(Fields& f, Identifiability& found) {
  f("singular_values", found.singular_values);
  f("directions", found.directions);
  f("rank", found.rank);
  f("numerical_rank", found.numerical_rank);
  f("correlations", found.correlations);
  f("trade_offs", found.trades);
}

template <class Fields>
void describe(Fields& f, Candidate::Unbound& unbound) {
  f("misfit", unbound.misfit);
  f("worst_rad_s", unbound.worst);
  f("violated", unbound.violated);
  f("values", unbound.values);
}

namespace {

/// Absent where there is none.
template <class Fields>
void describe_direction(Fields& f, const char* key, std::optional<int>& direction) {
  std::optional<std::string> name;
  if (direction) name = spatial::direction_name(*direction);
  f.optional(key, name);
  if constexpr (Fields::reads) {
    if (!name) return;
    direction = spatial::direction_from_name(*name);
    if (!direction)
      f.bad(key, fmt::format("is \"{}\", expected one of x, y, z, rx, ry, rz", *name));
  }
}

template <class Fields>
void describe_target(Fields& f, ModeTarget& target, FittedTarget& fit) {
  f("name", target.name);
  f("pose", target.pose);
  f.unless(0.0, "amplitude_m", target.amplitude);
  f.counted("mode", fit.mode);
  f("target_rad_s", target.omega);
  f.unless(false, "damped", target.damped);
  f("model_rad_s", fit.omega);
  f("deviation_rad_s", target.deviation);
  f("difference_in_deviations", fit.difference);
  f("outlier", fit.outlier);
  describe_direction(f, "direction", target.direction);
  describe_direction(f, "mode_direction", fit.mode_direction);
  f.optional("target_damping_ratio", target.damping);
  if (target.damping) f("model_damping_ratio", fit.damping);
  if (target.shape || f.has("shape_mac")) f("shape_mac", fit.shape_mac);
  if (Fields::reads && f.has("shape_mac")) target.shape.emplace();  // what it is, is not said
}

/// Misfit per degree of freedom as it comes out, where `scatter` is 1 at least: outliers and the
/// combinations of parameters that the data determine are no degrees. None without degrees.
std::optional<double> raw_reduced_misfit(const Candidate& candidate, const Targets& targets) {
  constexpr int of_shape = 6;
  int degrees = -candidate.identifiability.numerical_rank;
  for (const auto& mode : targets.modes)
    degrees += 1 + (mode.damping ? 1 : 0) + (mode.shape ? of_shape : 0);
  for (const auto& target : candidate.targets) degrees -= target.outlier ? 1 : 0;
  if (degrees <= 0) return std::nullopt;
  return candidate.misfit / degrees;
}

template <class Fields>
void describe_candidate(Fields& f, Candidate& candidate, Targets& targets) {
  f("name", candidate.name);
  f("overrides", candidate.overrides);
  f("fitted", candidate.fitted);
  f.derived("admissible", candidate.admissible());
  if (!candidate.fitted) return f("problem", candidate.problem);
  static constexpr std::array losses{"squares", "cauchy"};
  f("violated", candidate.violated);
  f("converged", candidate.converged);
  f("starts", candidate.starts);
  f("starts_that_agree", candidate.starts_that_agree);
  f.word("loss", candidate.robust, losses);
  f("misfit", candidate.misfit);
  f("worst_rad_s", candidate.worst);
  f("scatter", candidate.scatter);
  f("parameters", candidate.parameters);
  if constexpr (Fields::reads) {
    candidate.targets.resize(f.size("targets"));
    targets.modes.resize(candidate.targets.size());
  }
  f.list("targets", candidate.targets.size(), [&](auto& item, std::size_t k) {
    describe_target(item, targets.modes[k], candidate.targets[k]);
  });
  f("identifiability", candidate.identifiability);
  if constexpr (!Fields::reads)
    f.derived("raw_reduced_misfit", raw_reduced_misfit(candidate, targets));
  f.optional("unconstrained", candidate.unbound);
}

template <class Fields>
void describe_calibration(Fields& f, Calibration& result, Targets& targets) {
  f("targets_title", targets.title);
  f("targets_source", targets.source);
  f("deviations_given", targets.deviations_given);
  f("interrupted", result.interrupted);
  if constexpr (!Fields::reads) f.derived("remarks", calibration_remarks(result, targets));
  if constexpr (Fields::reads) result.candidates.resize(f.size("candidates"));
  f.list("candidates", result.candidates.size(), [&](auto& item, std::size_t k) {
    describe_candidate(item, result.candidates[k], targets);
  });
}

}  // namespace

Json calibration_json(const Calibration& result, const Targets& targets) {
  Writer fields;  // changes nothing
  describe_calibration(fields, const_cast<Calibration&>(result), const_cast<Targets&>(targets));
  return std::move(fields.json);
}

ReadCalibration calibration_from_json(const Json& json, const std::string& file) {
  ReadCalibration read;
  Reader fields(json, file);
  describe_calibration(fields, read.result, read.targets);
  if (read.result.candidates.empty()) fields.bad("candidates", "is empty");
  return read;
}

Json profile_json(const Profile& profile, const Candidate& candidate) {
  std::vector<double> values, misfits;
  for (const auto& point : profile.points) {
    values.push_back(point.value);
    misfits.push_back(point.misfit);
  }
  return {{"paths", candidate.parameters.at(static_cast<std::size_t>(profile.parameter)).paths},
          {"interval_95", written(std::array{profile.interval_low, profile.interval_high})},
          {"values", values},
          {"misfits", written(misfits)}};
}

template <class Fields>
void describe(Fields& f, model::FileNumber& number) {
  f("path", number.path);
  f("unit", number.unit);
  f("value", number.value);
}

template <class Fields>
void describe(Fields& f, Sensitivities& s) {
  if constexpr (Fields::reads) s.omega.resize(static_cast<Eigen::Index>(f.size("modes")));
  f.list("modes", static_cast<std::size_t>(s.omega.size()), [&](auto& mode, std::size_t k) {
    double& omega = s.omega[static_cast<Eigen::Index>(k)];
    mode("omega_rad_s", omega);
    mode.derived("frequency_hz", omega / two_pi);
  });
  f("parameters", s.parameters);
  f("percent_per_percent", s.percent_per_percent);
}

Json sensitivity_json(const Sensitivities& sensitivities) { return written(sensitivities); }

Sensitivities sensitivity_from_json(const Json& json, const std::string& file) {
  return read<Sensitivities>(json, file);
}

namespace {

/// Targets at several poses or amplitudes may have one name.
std::string at_pose(const Targets& targets, std::size_t i) {
  const auto& [pose, amplitude] = std::tie(targets.modes[i].pose, targets.modes[i].amplitude);
  const bool several =
      std::ranges::any_of(targets.modes, [&](const auto& mode) { return mode.pose != pose; });
  return (several ? fmt::format(" at pose {}", pose) : "") +
         (amplitude > 0.0 ? fmt::format(" at {:g} mm", 1e3 * amplitude) : "");
}

}  // namespace

namespace {

/// The target that is missed by most deviations.
std::string unmet_text(const Candidate& best, const Targets& targets) {
  std::string farthest;
  double most = 3.0;  // σ; below it shapes or damping ratios are what is missed
  for (std::size_t i = 0; i < best.targets.size(); ++i) {
    const auto& fit = best.targets[i];
    if (fit.outlier || !(std::abs(fit.difference) > most)) continue;
    most = std::abs(fit.difference);
    farthest = fmt::format(": target {}{} is {:.3g} Hz or {:.3g} σ from its mode",
                           targets.modes[i].name, at_pose(targets, i),
                           std::abs(fit.omega - targets.modes[i].omega) / base::two_pi, most);
  }
  return fmt::format(
      "the targets cannot be met{}; an effect is missing in the model, a bound is too tight, or a "
      "target is wrong",
      farthest);
}

}  // namespace

std::vector<std::string> calibration_remarks(const Calibration& result, const Targets& targets) {
  std::vector<std::string> remarks;
  const auto& best = result.best();
  if (result.interrupted) remarks.push_back("interrupted: these are the best values so far");
  for (std::size_t i = 0; i < best.targets.size(); ++i)
    if (best.targets[i].outlier)
      remarks.push_back(fmt::format(
          "target {} does not fit the others: it differs by {:.1f} σ and was left out; check it",
          targets.modes[i].name, std::abs(best.targets[i].difference)));
  for (std::size_t i = 0; i < best.targets.size(); ++i)
    if (best.targets[i].mode_direction)
      remarks.push_back(fmt::format(
          "target {}{}: its direction {} contradicts the mode paired with it, which mainly moves "
          "the platform in {}; check the directions of the targets",
          targets.modes[i].name, at_pose(targets, i),
          spatial::direction_name(targets.modes[i].direction.value_or(0)),
          spatial::direction_name(*best.targets[i].mode_direction)));
  const double count = static_cast<double>(best.targets.size());
  if (best.misfit > 9.0 * count) remarks.push_back(unmet_text(best, targets));
  if (!best.converged && !result.interrupted)
    remarks.push_back("the fit has not converged; more steps (`max_iterations` in [fit]) may help");
  if (best.targets.size() < best.parameters.size())
    remarks.push_back(fmt::format("{} parameters are free, but there {} only {} target{}",
                                  best.parameters.size(), best.targets.size() == 1 ? "is" : "are",
                                  best.targets.size(), best.targets.size() == 1 ? "" : "s"));
  for (const auto& p : best.parameters) {
    if (p.verdict == Verdict::undetermined && p.value == p.start)
      remarks.push_back(fmt::format("{}: not determined by the data, left at its start, {:.5g}{}",
                                    p.paths.front(), p.start, p.unit == "1" ? "" : " " + p.unit));
    if (p.verdict == Verdict::by_prior)
      remarks.push_back(
          fmt::format("{}: determined by its prior, not by the data", p.paths.front()));
    if (p.verdict == Verdict::ambiguous)
      remarks.push_back(fmt::format(
          "{}: {:.5g} {} fits the targets equally well; bounds or a prior can select one",
          p.paths.front(), *p.other_value, p.unit == "1" ? "" : p.unit));
    if (p.verdict == Verdict::at_bound)
      remarks.push_back(fmt::format("{} ended at its bound, {:.5g} {}; check the bound",
                                    p.paths.front(), p.value, p.unit == "1" ? "" : p.unit));
  }
  for (const auto& broken : best.violated)
    remarks.push_back("the fitted machine is not admissible; violated: " + broken);
  if (!targets.deviations_given)
    remarks.push_back(
        fmt::format("the targets state no standard deviations; {:g} % was assumed, and the "
                    "uncertainties follow from the scatter of the residuals",
                    100.0 * observation::default_deviation));
  return remarks;
}

}  // namespace hydrapod::report
