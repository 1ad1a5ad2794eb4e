#include "hydrapod/identification/cross_check.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "selection.hpp"
#include "usable.hpp"

namespace hydrapod::identification {

namespace {

constexpr double reach = 0.03;         // of the frequency
constexpr double shape_weight = 0.03;  // a wrong shape counts like so much in frequency

/// Mean pole of a cluster and its shape.
struct Realised {
  Complex pole{};
  VectorXcd shape{};
};

std::vector<Realised> realised(const FrequencyResponses& responses) {
  const auto chart = realised_poles(impulse_response(responses));
  std::vector<Realised> all;
  for (const auto& cluster : select_poles(chart))
    all.push_back({mean_pole(cluster, chart), cluster.representative.shape});
  return all;
}

/// Share of `shape` in what the realised modes within `neighbourhood` of `pole` span: of repeated
/// modes any mix is right.
double likeness(const VectorXcd& shape, Complex pole, const std::vector<Realised>& others,
                double neighbourhood) {
  MatrixXcd span;
  for (const auto& other : others)
    if (std::abs(std::abs(other.pole) / std::abs(pole) - 1.0) <= neighbourhood)
      add_direction(other.shape, span);
  return share_in(shape, span);
}

struct Candidate {
  double cost{};
  std::size_t mode{}, other{};
};

}  // namespace

std::vector<std::optional<CrossCheck>> cross_check(const Identification& found,
                                                   const FrequencyResponses& responses) {
  const auto others = realised(within(UsableResponses(responses).get(), 0.0, found.to));
  std::vector<Candidate> candidates;
  for (std::size_t r = 0; r < found.modes.size(); ++r)
    for (std::size_t q = 0; q < others.size(); ++q) {
      const auto& fit = found.modes[r].fit;
      const double apart = std::abs(std::abs(others[q].pole) / fit.omega() - 1.0);
      if (apart <= reach)
        candidates.push_back(
            {apart + shape_weight * (1.0 - mac(fit.shape, others[q].shape)), r, q});
    }
  std::ranges::stable_sort(candidates, {}, &Candidate::cost);
  std::vector<std::optional<CrossCheck>> cross_checks(found.modes.size());
  std::vector<bool> taken(others.size(), false);
  const SelectionOptions limits;
  for (const auto& [cost, r, q] : candidates) {
    if (cross_checks[r] || taken[q]) continue;
    taken[q] = true;
    const auto& fit = found.modes[r].fit;
    CrossCheck cross_check{
        .omega = std::abs(others[q].pole),
        .damping_ratio = -others[q].pole.real() / std::abs(others[q].pole),
        .mac = likeness(fit.shape, others[q].pole, others, limits.neighbourhood)};
    cross_check.agrees = cross_check.mac >= limits.vector &&
                         std::abs(cross_check.omega / fit.omega() - 1.0) <= limits.frequency &&
                         same_damping(cross_check.damping_ratio, fit.damping_ratio(), limits);
    cross_checks[r] = cross_check;
  }
  return cross_checks;
}

}  // namespace hydrapod::identification
