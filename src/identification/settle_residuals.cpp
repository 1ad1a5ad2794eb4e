#include <algorithm>
#include <cmath>
#include <utility>

#include "fit_covariance.hpp"
#include "identify_steps.hpp"
#include "line_weights.hpp"
#include "prune.hpp"

namespace hydrapod::identification {

namespace {

/// 2 n ln(sum of squares) + 2 k (Akaike) by the k numbers of residual terms; n: lines and entries,
/// as many as are independent.
double residual_criterion(const FrequencyResponses& r, const ModalModel& model) {
  const auto entries = static_cast<double>(r.H[0].size());
  const double n =
      static_cast<double>(r.lines()) * numbers_per_line(r) / std::max(1.0, lines_in_step(r));
  const double k = entries * static_cast<double>(model.residuals.size());
  return 2.0 * n * std::log(std::max(model.cost, 1e-300)) + 2.0 * k;
}

}  // namespace

void settle_residuals(const IdentifyOptions& options, Identification& result) {
  auto better = options;
  better.fit.deviations = Deviations::none;
  auto best = fit_modes(result.responses, estimates(result.model), better.fit);
  double least = residual_criterion(result.responses, best);
  for (int power = options.fit.highest_residual_power + 1; power <= options.highest_residual_power;
       ++power) {
    auto fit = better.fit;
    fit.highest_residual_power = power;
    auto model = fit_modes(result.responses, estimates(best), fit);
    const double criterion = residual_criterion(result.responses, model);
    if (criterion >= least) break;
    least = criterion;
    best = std::move(model);
    better.fit = fit;
  }
  result.model = std::move(best);
  better.fit.deviations = options.fit.deviations;
  fit_and_prune(better, fitted_clusters(result), result);
}

}  // namespace hydrapod::identification
