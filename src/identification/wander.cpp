#include "hydrapod/identification/identify.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "damped.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "names.hpp"
#include "refit.hpp"

namespace hydrapod::identification {

namespace {

/// Modes × groups.
struct GroupFits {
  MatrixXd omega{}, omega_deviation{}, damping{}, damping_deviation{};
};

/// False where a channel is dead in this group.
bool add_fit(const FrequencyResponses& responses, const Identification& found,
             const IdentifyOptions& options, Index group, GroupFits& fits) {
  if (responses.outputs.size() != found.responses.outputs.size() ||
      responses.inputs.size() != found.responses.inputs.size())
    return false;
  const auto modes = refitted_modes(responses, found, options.fit, Deviations::poles);
  for (Index r = 0; r < fits.omega.rows(); ++r) {
    const auto& mode = modes[static_cast<std::size_t>(r)];
    fits.omega(r, group) = mode.omega();
    fits.omega_deviation(r, group) = mode.omega_deviation;
    fits.damping(r, group) = mode.damping_ratio();
    fits.damping_deviation(r, group) = mode.damping_deviation;
  }
  return true;
}

/// Neighbours put together until each has averages enough; empty where there are not two such.
std::vector<CrossSpectra> large_enough(std::vector<CrossSpectra> groups, double averages) {
  const auto have_enough = [&](const std::vector<CrossSpectra>& list) {
    return std::ranges::all_of(
        list, [&](const auto& s) { return s.statistics.effective_averages >= averages; });
  };
  if (groups.size() >= 2 && have_enough(groups)) return groups;
  for (std::size_t together = 2; 2 * together <= groups.size(); together *= 2) {
    std::vector<CrossSpectra> joined;
    for (std::size_t g = 0; g + together <= groups.size(); g += together) {
      std::vector<std::size_t> picks(together);
      std::iota(picks.begin(), picks.end(), g);
      joined.push_back(averaged_spectra(groups, picks));
    }
    if (have_enough(joined)) return joined;
  }
  return {};
}

struct Spread {
  double mean{}, deviation{};  ///< between groups, less what the estimates scatter
  double chi_squared{};
  int degrees{};
};

Spread spread_of(const VectorXd& values, const VectorXd& deviations) {
  const VectorXd weight = deviations.cwiseAbs2().cwiseInverse();
  Spread s{.mean = weight.dot(values) / weight.sum(),
           .degrees = static_cast<int>(values.size()) - 1};
  const Eigen::ArrayXd off = values.array() - s.mean;
  s.chi_squared = (off.square() * weight.array()).sum();
  // E χ² = degrees + variance · (Σ w − Σ w²/Σ w)
  s.deviation = std::sqrt(std::max(0.0, s.chi_squared - s.degrees) /
                          (weight.sum() - weight.squaredNorm() / weight.sum()));
  return s;
}

}  // namespace

std::vector<Wandering> wandering_modes(std::vector<CrossSpectra> groups,
                                       const ChannelChoice& choice, Estimator estimator,
                                       const Identification& found, const IdentifyOptions& identify,
                                       const WanderOptions& options) {
  const auto modes = static_cast<Index>(found.modes.size());
  if (modes == 0) return {};
  const auto inputs = static_cast<double>(choice.inputs.size());
  auto parts = large_enough(std::move(groups), inputs + options.least_degrees);
  GroupFits fits;
  for (auto* m : {&fits.omega, &fits.omega_deviation, &fits.damping, &fits.damping_deviation})
    m->resize(modes, static_cast<Index>(parts.size()));
  Index fitted = 0;
  for (auto& part : parts) {
    try {
      fitted +=
          add_fit(responses_for_modes(part, choice, estimator), found, identify, fitted, fits);
    } catch (const base::ComputationError&) {  // this part has too little in it
    }
    part.re = part.im = {};  // no longer needed, and large
  }
  std::vector<Wandering> list;
  if (fitted < 2) return list;
  const double probability = 1.0 - options.level / static_cast<double>(modes);
  double degrees = 0.0;  // of the noise estimates
  for (const auto& part : parts) degrees += part.statistics.effective_averages - inputs;
  for (Index r = 0; r < modes; ++r) {
    const auto& mode = found.modes[static_cast<std::size_t>(r)].fit;
    const VectorXd omega = fits.omega.row(r).head(fitted),
                   deviation = fits.omega_deviation.row(r).head(fitted);
    if (!(deviation.minCoeff() > 0.0) || !deviation.allFinite() || !omega.allFinite()) continue;
    const auto spread = spread_of(omega, deviation);
    const double between = spread.degrees;
    if (!(spread.chi_squared / between >
          numerics::fisher_quantile(probability, between, degrees)) ||
        !(spread.deviation > options.least_spread * mode.damping_ratio() * mode.omega()))
      continue;
    const auto damping =
        spread_of(fits.damping.row(r).head(fitted), fits.damping_deviation.row(r).head(fitted));
    list.push_back({.mode = static_cast<std::size_t>(r),
                    .chi_squared = spread.chi_squared,
                    .groups = static_cast<int>(fitted),
                    .lowest = omega.minCoeff(),
                    .highest = omega.maxCoeff(),
                    .deviation = spread.deviation,
                    .damping_in_groups = damping.mean});
  }
  return list;
}

void add_wandering(const std::vector<Wandering>& wandering, Identification& found) {
  for (const auto& w : wandering) {
    auto& mode = found.modes.at(w.mode);
    const double half_width = mode.fit.damping_ratio() * mode.fit.omega();
    mode.steadiness = half_width / (half_width + w.deviation);
    found.warnings.push_back(
        {.kind = ModeWarning::Kind::wanders,
         .value = mode.fit.omega() / two_pi,
         .from = w.lowest / two_pi,
         .to = w.highest / two_pi,
         .share = mode.fit.damping_ratio() / std::max(w.damping_in_groups, 1e-12) - 1.0,
         .count = w.groups});
  }
}

}  // namespace hydrapod::identification
