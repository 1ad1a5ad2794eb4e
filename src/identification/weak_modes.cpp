#include "weak_modes.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "fit_covariance.hpp"
#include "hydrapod/numerics/dense.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "line_weights.hpp"

namespace hydrapod::identification {

namespace {

/// Lines where the residual is most conspicuous, apart from each other, while it stands out.
std::vector<Index> places(const FrequencyResponses& rest, const WeakModeOptions& options) {
  VectorXd value = signal_to_noise(rest, options.reach);
  const auto frequency = VectorXd::Map(rest.frequency.data(), value.size());
  const double numbers = numbers_per_line(rest) * static_cast<double>(2 * options.reach + 1);
  const double median = numerics::upper_median({value.begin(), value.end()});
  const double least = median * (1.0 + options.stands_out / std::sqrt(numbers)) + 1e-300;
  std::vector<Index> found;
  while (static_cast<int>(found.size()) < options.most_places) {
    Index at = 0;
    if (!(value.maxCoeff(&at) > least)) break;
    found.push_back(at);
    for (Index k = 0; k < value.size(); ++k)
      if (std::abs(k - at) <= options.least_half_band ||
          std::abs(frequency[k] - frequency[at]) <= options.half_band * frequency[at])
        value[k] = 0.0;
  }
  return found;
}

FrequencyResponses around(const FrequencyResponses& rest, Index place,
                          const WeakModeOptions& options) {
  const auto last = static_cast<Index>(rest.lines()) - 1;
  const double f = rest.frequency[static_cast<std::size_t>(place)];
  const auto at = [&](Index k) {
    return rest.frequency[static_cast<std::size_t>(std::clamp<Index>(k, 0, last))];
  };
  return within(rest, std::min(at(place - options.least_half_band), f * (1.0 - options.half_band)),
                std::max(at(place + options.least_half_band), f * (1.0 + options.half_band)));
}

}  // namespace

FrequencyResponses residual_of(const FrequencyResponses& responses, const ModalModel& model,
                               bool taper) {
  const PoleBasis basis(responses, taper);
  std::vector<PoleLines> lines;
  for (const auto& mode : model.modes) lines.push_back(basis.at(mode.pole));
  FrequencyResponses rest = responses;
  for (std::size_t k = 0; k < rest.lines(); ++k)
    rest.H[k] -= modelled(model, lines, static_cast<Index>(k), responses);
  return rest;
}

std::vector<PoleCluster> weak_poles(const FrequencyResponses& responses, const ModalModel& model,
                                    const IdentifyOptions& options) {
  std::vector<PoleCluster> found;
  if (!responses.has_errors()) return found;
  const auto rest = residual_of(responses, model, options.fit.taper);
  auto selection = options.weak.selection;
  selection.highest_damping = options.highest_damping;
  for (const Index place : places(rest, options.weak)) {
    const auto band = around(rest, place, options.weak);
    if (static_cast<int>(band.lines()) < 2 * options.weak.least_half_band) continue;
    for (auto& cluster : select_poles(poly_reference_poles(band, options.weak.orders), selection)) {
      const double f = cluster.representative.omega() / two_pi;
      if (f > band.frequency.front() && f < band.frequency.back())
        found.push_back(std::move(cluster));
    }
  }
  return found;
}

std::vector<double> conspicuous_frequencies(const FrequencyResponses& responses,
                                            const ModalModel& model,
                                            const IdentifyOptions& options) {
  std::vector<double> found;
  if (!responses.has_errors()) return found;
  const auto rest = residual_of(responses, model, options.fit.taper);
  for (const Index place : places(rest, options.weak))
    found.push_back(rest.frequency[static_cast<std::size_t>(place)]);
  return found;
}

std::vector<PoleEstimate> modes_in_residual(const FrequencyResponses& responses,
                                            const ModalModel& model, std::complex<double> pole,
                                            std::size_t count, bool taper) {
  const auto rest = residual_of(responses, model, taper);
  const auto g = PoleBasis(responses, taper).at(pole).g;
  MatrixXcd residue = MatrixXcd::Zero(rest.H[0].rows(), rest.H[0].cols());
  MatrixXcd excited = MatrixXcd::Zero(residue.cols(), residue.cols());
  VectorXd outputs = VectorXd::Zero(residue.rows()), inputs = VectorXd::Zero(residue.cols());
  for (std::size_t k = 0; k < rest.lines(); ++k) {
    const double near = std::norm(g[static_cast<Index>(k)]);
    if (rest.excitation.empty()) {
      residue += std::conj(g[static_cast<Index>(k)]) * rest.H[k];
    } else {
      const VectorXcd& U = rest.excitation[k];
      residue += std::conj(g[static_cast<Index>(k)]) * (rest.H[k] * U) * U.adjoint();
      excited += near * U * U.adjoint();
    }
    outputs += near * rest.noise[k].diagonal().real();
    inputs += near * rest.input_factor[k].diagonal().real();
  }
  if (!rest.excitation.empty()) {
    excited.diagonal().array() += 1e-9 * excited.diagonal().real().mean();
    residue = numerics::solve(excited, residue.adjoint()).adjoint();
  }
  const VectorXd row = outputs.cwiseMax(1e-300).cwiseSqrt(),
                 column = inputs.cwiseMax(1e-300).cwiseSqrt();
  const Eigen::JacobiSVD<MatrixXcd> svd(
      row.cwiseInverse().asDiagonal() * residue * column.cwiseInverse().asDiagonal(),
      Eigen::ComputeThinU | Eigen::ComputeThinV);
  std::vector<PoleEstimate> modes;
  for (Index r = 0; r < std::min(static_cast<Index>(count), svd.matrixU().cols()); ++r)
    modes.push_back({pole, row.asDiagonal() * svd.matrixU().col(r),
                     column.asDiagonal() * svd.matrixV().col(r).conjugate()});
  return modes;
}

}  // namespace hydrapod::identification
