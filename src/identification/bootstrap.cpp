#include "hydrapod/identification/identify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "damped.hpp"
#include "hydrapod/base/error.hpp"
#include "names.hpp"
#include "refit.hpp"

namespace hydrapod::identification {

namespace {

/// Standard deviation of each row.
VectorXd row_deviation(const MatrixXd& values) {
  const VectorXd mean = values.rowwise().mean();
  return ((values.colwise() - mean).rowwise().squaredNorm() /
          static_cast<double>(values.cols() - 1))
      .cwiseSqrt();
}

}  // namespace

CrossSpectra averaged_spectra(const std::vector<CrossSpectra>& groups,
                              const std::vector<std::size_t>& picks) {
  CrossSpectra sum = groups.at(picks.at(0));
  sum.re.setZero();
  sum.im.setZero();
  sum.input_power.setZero();
  if (sum.noise_re.size() > 0)
    throw std::invalid_argument("periods are averaged as signals, not as spectra");
  // a group of which it is not known: a sample beyond all bounds
  const bool is_known = std::ranges::all_of(picks, [&](std::size_t g) {
    return groups.at(g).input_power.size() == sum.input_power.size();
  });
  if (!is_known) sum.input_power.resize(0);
  sum.blocks = 0;
  sum.records = 0;
  for (const std::size_t g : picks) {
    const auto& group = groups.at(g);
    const auto weight = static_cast<double>(group.blocks);
    sum.re += weight * group.re;
    sum.im += weight * group.im;
    if (is_known) sum.input_power += weight * group.input_power;
    sum.blocks += group.blocks;
    sum.records += group.records;
  }
  sum.re /= static_cast<double>(sum.blocks);
  sum.im /= static_cast<double>(sum.blocks);
  sum.input_power /= static_cast<double>(sum.blocks);
  const int hop = sum.options.block_length -
                  static_cast<int>(std::lround(sum.options.overlap * sum.options.block_length));
  sum.statistics = average_statistics(sum.window, hop, static_cast<long>(sum.blocks));
  return sum;
}

BootstrapScatter bootstrap_modes(const std::vector<CrossSpectra>& groups,
                                 const ChannelChoice& choice, Estimator estimator,
                                 const Identification& found, const BootstrapOptions& options,
                                 const numerics::Progress& progress) {
  constexpr std::size_t fewest = 4;
  if (groups.size() < fewest)
    throw std::invalid_argument(fmt::format(
        "a bootstrap needs at least {} groups of blocks, not {}", fewest, groups.size()));
  if (found.modes.empty()) throw std::invalid_argument("there is no mode to bootstrap");
  std::mt19937_64 random(options.seed);
  const auto modes = static_cast<Index>(found.modes.size());
  MatrixXd omega(modes, options.resamples), damping(modes, options.resamples);
  BootstrapScatter scatter{.groups = static_cast<int>(groups.size())};
  for (int b = 0; b < options.resamples; ++b) {
    std::vector<std::size_t> picks(groups.size());
    for (auto& pick : picks) pick = random() % groups.size();
    try {
      const auto one =
          refitted_modes(responses_for_modes(averaged_spectra(groups, picks), choice, estimator),
                         found, options.identify.fit, Deviations::none);
      for (Index r = 0; r < modes; ++r) {
        omega(r, scatter.resamples) = one[static_cast<std::size_t>(r)].omega();
        damping(r, scatter.resamples) = one[static_cast<std::size_t>(r)].damping_ratio();
      }
      ++scatter.resamples;
    } catch (const base::ComputationError&) {  // this draw has too little in it
    }
    if (progress && progress(static_cast<double>(b + 1) / options.resamples)) break;
  }
  if (scatter.resamples < 2)
    throw base::ComputationError("most resamples of the blocks could not be fitted");
  const auto G = static_cast<double>(groups.size());
  const double correction = std::sqrt(G / (G - 1.0));
  scatter.omega_deviation = correction * row_deviation(omega.leftCols(scatter.resamples));
  scatter.damping_deviation = correction * row_deviation(damping.leftCols(scatter.resamples));
  return scatter;
}

}  // namespace hydrapod::identification
