#include "hydrapod/identification/responses.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "names.hpp"
#include "response_checks.hpp"

namespace hydrapod::identification {

namespace {

MatrixXcd part(const MatrixXcd& S, const std::vector<int>& rows, const std::vector<int>& columns) {
  return S(rows, columns);
}

/// Total least squares for one output: the smallest eigenvector of the scaled (u, y) matrix.
Eigen::RowVectorXcd hv_row(const MatrixXcd& S, const std::vector<int>& inputs, int output) {
  auto all = inputs;
  all.push_back(output);
  MatrixXcd A = part(S, all, all);
  const VectorXd level = A.diagonal().real().cwiseSqrt();
  A = level.cwiseInverse().asDiagonal() * A * level.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXcd> solver(A);
  // vᴴ (u; y) is least: y = −(v_u/v_y)ᴴ u, in scaled channels
  const VectorXcd v = solver.eigenvectors().col(0);
  const Index p = static_cast<Index>(inputs.size());
  Eigen::RowVectorXcd row = -(v.head(p) / v[p]).adjoint();
  return level[p] * row * level.head(p).cwiseInverse().asDiagonal();
}

struct LineEstimate {
  MatrixXcd H, Q;
};

LineEstimate estimate_line(const MatrixXcd& S, const ChannelChoice& c, Estimator estimator) {
  const bool instrumental = estimator == Estimator::instrumental;
  const auto& R = instrumental ? c.instruments : c.inputs;
  const MatrixXcd S_uR = part(S, c.inputs, R);
  const MatrixXcd G = S_uR.partialPivLu().inverse();
  LineEstimate e;
  e.Q = G.adjoint() * part(S, R, R) * G;
  if (estimator == Estimator::h2) {
    e.H = part(S, c.outputs, c.outputs) * part(S, c.inputs, c.outputs).partialPivLu().inverse();
  } else if (estimator == Estimator::hv) {
    e.H.resize(static_cast<Index>(c.outputs.size()), static_cast<Index>(c.inputs.size()));
    for (std::size_t o = 0; o < c.outputs.size(); ++o)
      e.H.row(static_cast<Index>(o)) = hv_row(S, c.inputs, c.outputs[o]);
  } else {
    e.H = part(S, c.outputs, R) * G;
  }
  return e;
}

/// (I, −H) S (I, −H)ᴴ: the spectrum of what H does not explain.
MatrixXcd residual_spectrum(const MatrixXcd& S, const ChannelChoice& c, const MatrixXcd& H) {
  const MatrixXcd S_yu = part(S, c.outputs, c.inputs);
  const MatrixXcd cross = S_yu * H.adjoint();
  MatrixXcd V = part(S, c.outputs, c.outputs) - cross - cross.adjoint() +
                H * part(S, c.inputs, c.inputs) * H.adjoint();
  keep_positive(S, c.outputs, V);
  return V;
}

}  // namespace

double confidence_radius(double probability, double degrees) {
  if (!(degrees > 0.0)) return std::sqrt(-std::log1p(-probability));  // F(2, ∞)
  return std::sqrt(numerics::fisher_quantile(probability, 2.0, 2.0 * degrees));
}

FrequencyResponses estimate_responses(const CrossSpectra& spectra, const ChannelChoice& wanted,
                                      Estimator estimator) {
  ChannelChoice c = wanted;
  auto r = without_lines(spectra, estimator, c);
  const bool periodic = spectra.options.periodic;
  const double K = r.averages, p = static_cast<double>(c.inputs.size());
  r.degrees = periodic ? static_cast<double>(spectra.blocks - spectra.records) : K - p;
  const auto& covariance = spectra.statistics.line_covariance;
  r.line_covariance.assign(covariance.begin(), covariance.end());
  const bool widened = !periodic && estimator != Estimator::instrumental;
  if (widened) r.taper = lag_taper(spectra.window);
  // the mean and the slow rest of it are in the first lines, in as many as the window is wide
  const Index first = periodic ? 1 : static_cast<Index>(r.line_covariance.size());
  const auto quiet = quiet_levels(spectra);
  const auto& others = estimator == Estimator::instrumental ? c.instruments : c.inputs;
  for (Index line = first; line < spectra.lines() - 1; ++line) {
    const MatrixXcd S = spectra.at(line);
    const double condition = input_condition(S, c.inputs, others, quiet);
    if (!(condition < singular_condition)) continue;
    const LineEstimate e = estimate_line(S, c, estimator);
    const MatrixXcd V = residual_spectrum(periodic ? spectra.noise_at(line) : S, c, e.H);
    r.frequency.push_back(spectra.frequency(line));
    r.H.push_back(e.H);
    r.input_factor.push_back(e.Q);
    r.noise.push_back(periodic ? MatrixXcd(V / K) : MatrixXcd(V / (K - p)));
    r.condition.push_back(condition);
    add_quality(S, c, V, r);
  }
  finish_checks(spectra, c, r);
  return r;
}

BiasFinding compare_responses(const FrequencyResponses& plain,
                              const FrequencyResponses& instrumental) {
  BiasFinding finding;
  const double radius = confidence_radius(0.95, instrumental.degrees);
  std::vector<double> relative;
  std::size_t beyond = 0;
  for (std::size_t a = 0, b = 0; a < plain.lines() && b < instrumental.lines();) {
    if (plain.frequency[a] != instrumental.frequency[b]) {
      (plain.frequency[a] < instrumental.frequency[b] ? a : b) += 1;
      continue;
    }
    for (Index o = 0; o < plain.H[a].rows(); ++o)
      for (Index i = 0; i < plain.H[a].cols(); ++i) {
        const double off = std::abs(plain.H[a](o, i) - instrumental.H[b](o, i));
        const double deviation = std::sqrt(instrumental.variance(b, o, i));
        if (off > radius * deviation) ++beyond;
        relative.push_back(off / std::abs(instrumental.H[b](o, i)));
      }
    ++a;
    ++b;
  }
  if (relative.empty()) return finding;
  finding.median = numerics::upper_median(relative);
  finding.share = static_cast<double>(beyond) / static_cast<double>(relative.size());
  return finding;
}

}  // namespace hydrapod::identification
