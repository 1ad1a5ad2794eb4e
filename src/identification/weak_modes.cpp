#include "weak_modes.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "fit_covariance.hpp"
#include "hydrapod/identification/identify.hpp"

namespace hydrapod::identification {

namespace {

constexpr Index reach = 2;             // lines on either side that a place is judged with
constexpr Index least_half_band = 12;  // lines around a place that poles are fitted to
constexpr double half_band = 0.02;     // of its frequency, if that is more
constexpr std::size_t most_places = 8;

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

/// Mean of |residual|²/variance around each line.
VectorXd conspicuousness(const FrequencyResponses& rest) {
  const auto count = static_cast<Index>(rest.lines());
  VectorXd own = VectorXd::Zero(count), smooth(count);
  for (Index k = 0; k < count; ++k) {
    const auto& H = rest.H[static_cast<std::size_t>(k)];
    for (Index o = 0; o < H.rows(); ++o)
      for (Index i = 0; i < H.cols(); ++i)
        own[k] +=
            std::norm(H(o, i)) / std::max(rest.variance(static_cast<std::size_t>(k),
                                                        static_cast<int>(o), static_cast<int>(i)),
                                          1e-300);
    own[k] /= static_cast<double>(H.size());
  }
  for (Index k = 0; k < count; ++k) {
    const Index from = std::max<Index>(0, k - reach), to = std::min(count - 1, k + reach);
    smooth[k] = own.segment(from, to - from + 1).mean();
  }
  return smooth;
}

/// Lines where the residual is most conspicuous, apart from each other, while it stands out.
std::vector<Index> places(const FrequencyResponses& rest) {
  VectorXd value = conspicuousness(rest);
  const auto& frequency = rest.frequency;
  const double entries = static_cast<double>(rest.H[0].size() * (2 * reach + 1));
  VectorXd sorted = value;
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  // a mean of `entries` squared numbers of two parts each scatters by 1/√entries
  const double least = sorted[sorted.size() / 2] * (1.0 + 4.0 / std::sqrt(entries)) + 1e-300;
  std::vector<Index> found;
  while (found.size() < most_places) {
    Index at = 0;
    if (!(value.maxCoeff(&at) > least)) break;
    found.push_back(at);
    const double f = frequency[static_cast<std::size_t>(at)];
    for (Index k = 0; k < value.size(); ++k)
      if (std::abs(k - at) <= least_half_band ||
          std::abs(frequency[static_cast<std::size_t>(k)] - f) <= half_band * f)
        value[k] = 0.0;
  }
  return found;
}

FrequencyResponses around(const FrequencyResponses& rest, Index place) {
  const auto last = static_cast<Index>(rest.lines()) - 1;
  const double f = rest.frequency[static_cast<std::size_t>(place)];
  const auto at = [&](Index k) {
    return rest.frequency[static_cast<std::size_t>(std::clamp<Index>(k, 0, last))];
  };
  return within(rest, std::min(at(place - least_half_band), f * (1.0 - half_band)),
                std::max(at(place + least_half_band), f * (1.0 + half_band)));
}

}  // namespace

std::vector<PoleCluster> weak_poles(const FrequencyResponses& responses, const ModalModel& model,
                                    bool taper, double highest_damping) {
  std::vector<PoleCluster> found;
  if (!responses.has_errors()) return found;
  const auto rest = residual_of(responses, model, taper);
  SelectionOptions selection;
  selection.damping = 0.5;  // of a weak mode it is known that badly
  selection.damping_floor = 0.004;
  selection.fewest = 3;
  selection.highest_damping = highest_damping;
  for (const Index place : places(rest)) {
    const auto band = around(rest, place);
    if (band.lines() < 2 * least_half_band) continue;
    for (auto& cluster : select_poles(poly_reference_poles(band, {1, 6, 1}), selection)) {
      const double f = cluster.representative.omega() / two_pi;
      if (f > band.frequency.front() && f < band.frequency.back())
        found.push_back(std::move(cluster));
    }
  }
  return found;
}

std::vector<double> conspicuous_frequencies(const FrequencyResponses& responses,
                                            const ModalModel& model, bool taper) {
  std::vector<double> found;
  if (!responses.has_errors()) return found;
  const auto rest = residual_of(responses, model, taper);
  for (const Index place : places(rest))
    found.push_back(rest.frequency[static_cast<std::size_t>(place)]);
  return found;
}

std::vector<PoleEstimate> modes_in_residual(const FrequencyResponses& responses,
                                            const ModalModel& model, std::complex<double> pole,
                                            std::size_t count, bool taper) {
  const auto rest = residual_of(responses, model, taper);
  const auto g = PoleBasis(responses, taper).at(pole).g;
  MatrixXcd residue = MatrixXcd::Zero(rest.H[0].rows(), rest.H[0].cols());
  VectorXd outputs = VectorXd::Zero(residue.rows()), inputs = VectorXd::Zero(residue.cols());
  for (std::size_t k = 0; k < rest.lines(); ++k) {
    const double near = std::norm(g[static_cast<Index>(k)]);
    residue += std::conj(g[static_cast<Index>(k)]) * rest.H[k];
    outputs += near * rest.noise[k].diagonal().real();
    inputs += near * rest.input_factor[k].diagonal().real();
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
