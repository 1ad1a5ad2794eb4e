#include "hydrapod/diagnosis/diagnose.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>

#include "evidence.hpp"
#include "ranking.hpp"

namespace hydrapod::diagnosis {

double ChiSquared::probability() const {
  if (degrees <= 0 || !(sum > 0.0)) return 1.0;
  if (!std::isfinite(sum)) return 0.0;
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(degrees), sum));
}

double least_response_misfit(const Diagnosis& d) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& e : d.hypotheses)
    if (!e.fit.responses.empty()) least = std::min(least, e.response_misfit());
  return std::isfinite(least) ? least : 0.0;
}

namespace {

double frequency_misfit(const observation::Targets& targets, const calibration::Candidate& fit) {
  Eigen::VectorXd differences(static_cast<Eigen::Index>(fit.targets.size()));
  for (std::size_t i = 0; i < fit.targets.size(); ++i)
    differences[static_cast<Eigen::Index>(i)] = fit.targets[i].difference;
  return observation::CommonError(targets.modes).whitened(differences).squaredNorm();
}

}  // namespace

Goodness goodness(const Diagnosis& d, const Hypothesis& e) {
  Goodness g;
  g.frequencies.sum = frequency_misfit(d.targets, e.fit);
  for (const auto& response : d.targets.responses) g.responses.values += response.values;
  g.frequencies.values = static_cast<int>(e.fit.targets.size());
  g.shapes.values = std::max(0, d.values - g.frequencies.values - g.responses.values);
  const bool seen = !e.fit.responses.empty();
  g.responses.sum = seen ? e.response_misfit() : least_response_misfit(d);
  g.shapes.sum = std::max(0.0, e.misfit - g.frequencies.sum - g.responses.sum);
  // numbers that the frequencies cannot determine alone are those of the shapes
  const int of_frequencies = std::min(e.parameters, std::max(0, g.frequencies.values - 1));
  g.frequencies.degrees = g.frequencies.values - of_frequencies;
  g.shapes.degrees = std::max(0, g.shapes.values - (e.parameters - of_frequencies));
  g.responses.degrees = seen ? g.responses.values : 0;
  const int degrees = d.values - e.parameters;
  g.reduced = degrees > 0 ? e.misfit / degrees : 0.0;
  int kinds = 0;
  g.probability = 1.0;
  for (const auto* kind : {&g.frequencies, &g.shapes, &g.responses}) {
    if (kind->degrees == 0) continue;
    ++kinds;
    g.probability = std::min(g.probability, kind->probability());
  }
  g.probability = std::min(1.0, kinds * g.probability);
  return g;
}

double unlisted_bic(const Diagnosis& d) {
  const auto g = goodness(d, d.nominal());
  const double scale = d.scatter * d.scatter;
  double bic = 0.0;
  for (const auto* kind : {&g.frequencies, &g.shapes, &g.responses}) {
    const double sum = kind->sum / scale;
    const auto n = static_cast<double>(kind->values);
    if (kind->values > 0 && sum > n)
      bic += n * (1.0 + std::log(sum / n)) + std::log(static_cast<double>(d.values));
    else
      bic += sum;
  }
  return bic;
}

namespace {

/// Has the nominal machine these modes, shapes included?
bool has_modes(const model::MachineFile& file, const observation::Targets& targets,
               dynamics::ModelKind kind) {
  double misfit = std::numeric_limits<double>::infinity();
  if_possible([&] {
    const auto fit = calibration::compare(file, targets, kind);
    if (fit.fitted) misfit = fit.misfit;
  });
  return ChiSquared{.sum = misfit, .degrees = values_in(targets)}.probability() >=
         usual_frequencies;
}

}  // namespace

void find_slips(const model::MachineFile& file, dynamics::ModelKind kind, Diagnosis& d) {
  constexpr std::size_t most = 50;  // poses that are tried
  if (d.finding == Finding::nominal || d.finding == Finding::nothing_to_blame ||
      d.finding == Finding::interrupted)
    return;
  auto targets = d.targets;
  targets.responses.clear();
  const std::string stated = targets.modes.front().pose;
  // a controller is tuned for each pose that was measured, and not for others
  const bool one_pose =
      targets.observed != observation::Observed::system &&
      std::ranges::all_of(targets.modes, [&](const auto& mode) { return mode.pose == stated; });
  for (std::size_t k = 0; one_pose && k < std::min(most, file.machine.poses.size()); ++k) {
    const auto& name = file.machine.poses[k].name;
    if (name == stated) continue;
    auto there = targets;
    for (auto& mode : there.modes) mode.pose = name;
    if (has_modes(file, there, kind)) d.nominal_at.push_back(name);
  }
  if (!d.equivalent.empty() || std::ssize(targets.modes) <= fewest_modes) return;
  int odd = 0;
  for (std::size_t i = 0; i < targets.modes.size(); ++i) {
    auto others = targets;
    others.modes.erase(others.modes.begin() + static_cast<std::ptrdiff_t>(i));
    if (!has_modes(file, others, kind)) continue;
    if (odd > 0) return;
    odd = static_cast<int>(i) + 1;
  }
  d.odd_mode = odd;
}

double raw_scatter2(const Diagnosis& d) {
  const double least = least_scatter(d);
  return std::isfinite(least) ? least * least : 0.0;
}

}  // namespace hydrapod::diagnosis
