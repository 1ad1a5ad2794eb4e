#include "leakage.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "hydrapod/numerics/statistics.hpp"
#include "line_weights.hpp"
#include "pole_basis.hpp"

namespace hydrapod::identification {

namespace {

/// dH/dω [s] at all lines, of the responses as the window widens them: g depends on λ − iω alone.
std::vector<MatrixXcd> slopes_of(const FrequencyResponses& responses, const ModalModel& model) {
  constexpr Complex i(0.0, 1.0);
  const PoleBasis basis(responses, true);
  std::vector<MatrixXcd> slopes(
      responses.lines(), MatrixXcd::Zero(model.residuals[0].rows(), model.residuals[0].cols()));
  for (const auto& mode : model.modes) {
    const MatrixXcd A = mode.shape * mode.participation.transpose();
    const auto lines = basis.at(mode.pole);
    for (std::size_t k = 0; k < slopes.size(); ++k) {
      const auto at = static_cast<Index>(k);
      slopes[k] -= i * (lines.slope[at] * A + lines.slope_conjugate[at] * A.conjugate());
    }
  }
  for (std::size_t k = 0; k < slopes.size(); ++k) {
    const Complex s = i * two_pi * responses.frequency[k];
    int power = lowest_residual_power;
    for (const auto& C : model.residuals) {
      if (power != 0)
        slopes[k] +=
            i * (static_cast<double>(power) / s * std::pow(s / model.omega_scale, power)) * C;
      ++power;
    }
  }
  return slopes;
}

/// Noise by what of it would be leakage, at the lines that have most leakage.
double noise_by_leakage(const FrequencyResponses& r, const std::vector<MatrixXcd>& factors) {
  std::vector<double> ratios;
  for (Index o = 0; o < r.H[0].rows(); ++o) {
    VectorXd leak(std::ssize(factors));
    for (Index k = 0; k < leak.size(); ++k)
      leak[k] = factors[static_cast<std::size_t>(k)].row(o).squaredNorm();
    for (const auto k : largest_tenth(leak))
      if (const double one = leak[static_cast<Index>(k)]; one > 0.0)
        ratios.push_back(r.noise[k](o, o).real() / one);
  }
  return ratios.empty() ? 0.0 : numerics::upper_median(std::move(ratios));
}

}  // namespace

std::vector<std::size_t> largest_tenth(const VectorXd& values) {
  constexpr std::size_t fewest = 8, share = 10;
  std::vector<std::size_t> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, std::greater{},
                    [&](std::size_t k) { return std::pair(values[static_cast<Index>(k)], k); });
  order.resize(std::min(order.size(), std::max(fewest, order.size() / share)));
  return order;
}

LeakageParts leakage_parts(const FrequencyResponses& responses, const ModalModel& model,
                           const FitOptions& options) {
  constexpr Index reach = 8;
  const auto& leakage = responses.leakage;
  if (leakage.line_covariance.empty() || !(leakage.rate > 0.0) || !responses.has_errors() ||
      !options.taper || responses.shift > 0.0)
    return {};
  LeakageParts parts;
  const auto lines = static_cast<Index>(responses.lines()), outputs = responses.H[0].rows();
  auto slopes = slopes_of(responses, model);
  for (std::size_t k = 0; k < responses.lines(); ++k) {
    const MatrixXcd half = slopes[k] * std::sqrt(leakage.rate);
    // L Lᴴ = Q: half L⁻ᴴ
    const Eigen::LLT<MatrixXcd> Q(responses.input_factor[k]);
    parts.D.push_back(Q.matrixL().solve(half.adjoint()).adjoint());
  }
  if (noise_by_leakage(responses, parts.D) < options.leakage_seen) return {};
  parts.share.resize(lines, outputs);
  for (Index o = 0; o < outputs; ++o) {
    VectorXd ratio(lines);
    for (Index k = 0; k < lines; ++k) {
      const auto at = static_cast<std::size_t>(k);
      ratio[k] =
          responses.noise[at](o, o).real() / std::max(parts.D[at].row(o).squaredNorm(), 1e-300);
    }
    // beside a resonance leakage is little, and the mean says nothing of its middle
    constexpr double scatter = 2.0;
    ratio = running_mean(ratio, reach).cwiseMin(scatter * ratio).eval();
    for (Index k = 0; k < lines; ++k)
      parts.D[static_cast<std::size_t>(k)].row(o) *= std::sqrt(std::min(1.0, ratio[k]));
    parts.share.col(o) = ratio.cwiseMax(1.0).cwiseInverse();
  }
  return parts;
}

}  // namespace hydrapod::identification
