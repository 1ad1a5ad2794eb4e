#include "hydrapod/identification/identify.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>

#include "names.hpp"

namespace hydrapod::identification {

namespace {

double share_in(const VectorXcd& vector, const MatrixXcd& span) {
  const Eigen::ColPivHouseholderQR<MatrixXcd> qr(span);
  const VectorXcd coordinates = qr.householderQ().adjoint() * vector;
  const double whole = vector.squaredNorm();
  return whole > 0.0
             ? coordinates.head(std::min(qr.rank(), coordinates.size())).squaredNorm() / whole
             : 0.0;
}

PoleStability stability_of(const PoleEstimate& e, const OrderPoles& before,
                           const SelectionOptions& options) {
  auto found = PoleStability::fresh;
  MatrixXcd shapes, participations;
  for (const auto& other : before.poles) {
    const double apart = std::abs(other.omega() / e.omega() - 1.0);
    if (apart <= options.neighbourhood) {
      shapes.conservativeResize(other.shape.size(), shapes.cols() + 1);
      shapes.rightCols<1>() = other.shape.normalized();
      participations.conservativeResize(other.participation.size(), participations.cols() + 1);
      participations.rightCols<1>() = other.participation.normalized();
    }
    if (apart > options.frequency) continue;
    found = std::max(found, PoleStability::frequency);
    if (std::abs(other.damping_ratio() - e.damping_ratio()) <=
        options.damping * e.damping_ratio() + options.damping_floor)
      found = PoleStability::damping;
  }
  if (found == PoleStability::damping && share_in(e.shape, shapes) >= options.vector &&
      share_in(e.participation, participations) >= options.vector)
    found = PoleStability::vector;
  return found;
}

}  // namespace

std::string_view stability_text(PoleStability stability) {
  static constexpr std::array<std::string_view, 4> words{"new", "frequency", "damping", "vector"};
  return words[static_cast<std::size_t>(stability)];
}

std::vector<std::vector<PoleStability>> pole_stability(const std::vector<OrderPoles>& chart,
                                                       const SelectionOptions& options) {
  std::vector<std::vector<PoleStability>> all;
  for (std::size_t n = 0; n < chart.size(); ++n) {
    all.emplace_back();
    for (const auto& e : chart[n].poles)
      all.back().push_back(n == 0 ? PoleStability::fresh : stability_of(e, chart[n - 1], options));
  }
  return all;
}

}  // namespace hydrapod::identification
