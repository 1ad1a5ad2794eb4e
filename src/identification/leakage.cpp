#include "leakage.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "hydrapod/numerics/statistics.hpp"
#include "line_weights.hpp"

namespace hydrapod::identification {

namespace {

/// dH/dω [per rad/s].
MatrixXcd slope_of(const ModalModel& model, double frequency) {
  constexpr Complex i(0.0, 1.0);
  const Complex s = i * two_pi * frequency;
  MatrixXcd slope = MatrixXcd::Zero(model.residuals[0].rows(), model.residuals[0].cols());
  for (const auto& mode : model.modes) {
    const MatrixXcd A = mode.shape * mode.participation.transpose();
    slope -= A / std::pow(s - mode.pole, 2) + A.conjugate() / std::pow(s - std::conj(mode.pole), 2);
  }
  int power = lowest_residual_power;
  for (const auto& C : model.residuals) {
    if (power != 0)
      slope += static_cast<double>(power) / s * std::pow(s / model.omega_scale, power) * C;
    ++power;
  }
  return i * slope;
}

/// Noise by what of it would be leakage, at the tenth of the lines that have most leakage.
double noise_by_leakage(const FrequencyResponses& r, const std::vector<MatrixXcd>& factors) {
  constexpr std::size_t fewest = 8, share = 10;
  std::vector<double> ratios;
  for (Index o = 0; o < r.H[0].rows(); ++o) {
    std::vector<std::pair<double, std::size_t>> most;
    for (std::size_t k = 0; k < r.lines(); ++k)
      most.emplace_back(factors[k].row(o).squaredNorm(), k);
    std::ranges::sort(most, std::greater{});
    most.resize(std::min(most.size(), std::max(fewest, most.size() / share)));
    for (const auto& [leak, k] : most)
      if (leak > 0.0) ratios.push_back(r.noise[k](o, o).real() / leak);
  }
  return ratios.empty() ? 0.0 : numerics::upper_median(std::move(ratios));
}

}  // namespace

LeakageParts leakage_parts(const FrequencyResponses& responses, const ModalModel& model,
                           const FitOptions& options) {
  constexpr Index reach = 8;
  const auto& leakage = responses.leakage;
  if (leakage.line_covariance.empty() || !(leakage.rate > 0.0) || !responses.has_errors() ||
      !options.taper || responses.shift > 0.0)
    return {};
  LeakageParts parts;
  const auto lines = static_cast<Index>(responses.lines()), outputs = responses.H[0].rows();
  for (std::size_t k = 0; k < responses.lines(); ++k) {
    const MatrixXcd half = slope_of(model, responses.frequency[k]) * std::sqrt(leakage.rate);
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
    ratio = running_mean(ratio, reach);
    for (Index k = 0; k < lines; ++k)
      parts.D[static_cast<std::size_t>(k)].row(o) *= std::sqrt(std::min(1.0, ratio[k]));
    parts.share.col(o) = ratio.cwiseMax(1.0).cwiseInverse();
  }
  return parts;
}

}  // namespace hydrapod::identification
