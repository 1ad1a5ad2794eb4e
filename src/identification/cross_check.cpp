#include "hydrapod/identification/cross_check.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>

#include "names.hpp"

namespace hydrapod::identification {

namespace {

constexpr double reach = 0.03;         // of the frequency
constexpr double shape_weight = 0.03;  // a wrong shape counts like so much in frequency

/// Mean pole of a cluster and its shape.
struct Realised {
  std::complex<double> pole{};
  VectorXcd shape{};
};

std::vector<Realised> realised(const FrequencyResponses& responses) {
  const auto chart = realised_poles(impulse_response(responses));
  std::vector<Realised> all;
  for (const auto& cluster : select_poles(chart)) {
    Realised mode{.shape = cluster.representative.shape};
    for (const auto& [n, i] : cluster.members)
      mode.pole += chart[n].poles[i].pole / static_cast<double>(cluster.members.size());
    all.push_back(std::move(mode));
  }
  return all;
}

/// Share of `shape` in what the realised modes within `neighbourhood` of `pole` span: of repeated
/// modes any mix is right.
double likeness(const VectorXcd& shape, std::complex<double> pole,
                const std::vector<Realised>& others, double neighbourhood) {
  MatrixXcd span;
  for (const auto& other : others) {
    if (std::abs(std::abs(other.pole) / std::abs(pole) - 1.0) > neighbourhood) continue;
    span.conservativeResize(shape.size(), span.cols() + 1);
    span.rightCols<1>() = other.shape.normalized();
  }
  const Eigen::ColPivHouseholderQR<MatrixXcd> qr(span);
  const VectorXcd part = qr.householderQ().adjoint() * shape;
  return part.head(std::min(qr.rank(), part.size())).squaredNorm() / shape.squaredNorm();
}

struct Candidate {
  double cost{};
  std::size_t mode{}, other{};
};

}  // namespace

std::vector<std::optional<CrossCheck>> cross_check(const Identification& found,
                                                   const FrequencyResponses& responses) {
  const auto others = realised(within(responses, 0.0, found.to));
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
                         std::abs(cross_check.damping_ratio - fit.damping_ratio()) <=
                             limits.damping * fit.damping_ratio() + limits.damping_floor;
    cross_checks[r] = cross_check;
  }
  return cross_checks;
}

}  // namespace hydrapod::identification
