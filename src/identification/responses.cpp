#include "hydrapod/identification/responses.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "hydrapod/numerics/parallel.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "names.hpp"
#include "response_checks.hpp"
#include "some_spectra.hpp"

namespace hydrapod::identification {

namespace {

/// Total least squares for one output: the smallest eigenvector of the scaled (u, y) matrix.
Eigen::RowVectorXcd hv_row(const MatrixXcd& S, const std::vector<int>& inputs, int output) {
  auto all = inputs;
  all.push_back(output);
  MatrixXcd A = S(all, all);
  const VectorXd level = A.diagonal().real().cwiseSqrt();
  A = level.cwiseInverse().asDiagonal() * A * level.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXcd> solver(A);
  // vᴴ (u; y) is least: y = −(v_u/v_y)ᴴ u, in scaled channels
  const VectorXcd v = solver.eigenvectors().col(0);
  const Index p = static_cast<Index>(inputs.size());
  Eigen::RowVectorXcd row = -(v.head(p) / v[p]).adjoint();
  return level[p] * row * level.head(p).cwiseInverse().asDiagonal();
}

struct LineEstimates {
  LineMatrix H, Q;
};

LineEstimates estimate_lines(const SomeSpectra& S, const ChannelChoice& c, Estimator estimator) {
  const auto& R = estimator == Estimator::instrumental ? c.instruments : c.inputs;
  const LineMatrix G = inverse(S.part(c.inputs, R));
  LineMatrix Q = times(adjoint(G), times(S.part(R, R), G));
  if (estimator == Estimator::h2)
    return {times(S.part(c.outputs, c.outputs), inverse(S.part(c.inputs, c.outputs))),
            std::move(Q)};
  return {times(S.part(c.outputs, R), G), std::move(Q)};
}

/// (I, −H) S (I, −H)ᴴ: the spectrum of what H does not explain.
LineMatrix residual_spectra(const SomeSpectra& S, const ChannelChoice& c, const LineMatrix& H) {
  const LineMatrix cross = times_adjoint(S.part(c.outputs, c.inputs), H),
                   explained = times_adjoint(times(H, S.part(c.inputs, c.inputs)), H);
  LineMatrix V = S.part(c.outputs, c.outputs);
  for (Index i = 0; i < V.rows(); ++i)
    for (Index j = 0; j < V.cols(); ++j) {
      V(i, j).re += explained(i, j).re - cross(i, j).re - cross(j, i).re;
      V(i, j).im += explained(i, j).im - cross(i, j).im + cross(j, i).im;
    }
  return V;
}

MatrixXcd hv_estimate(const MatrixXcd& S, const ChannelChoice& c) {
  MatrixXcd H(c.outputs.size(), c.inputs.size());
  for (std::size_t o = 0; o < c.outputs.size(); ++o)
    H.row(static_cast<Index>(o)) = hv_row(S, c.inputs, c.outputs[o]);
  return H;
}

/// What all lines have in common.
struct Estimation {
  const CrossSpectra& spectra;
  const ChannelChoice& choice;
  Estimator estimator;
  double noise_divisor;
};

/// Lines `first` … first + together − 1 of `r`, which are `all[first]` … of the spectra.
void estimate(const Estimation& e, const std::vector<Index>& all, std::size_t first,
              FrequencyResponses& r) {
  const auto lines = lines_from(all, first);
  const SomeSpectra S(e.spectra.re, e.spectra.im, lines);
  auto found = estimate_lines(S, e.choice, e.estimator);
  if (e.estimator == Estimator::hv)
    for (int k = 0; k < together; ++k)
      found.H.set(k, hv_estimate(e.spectra.at(lines[static_cast<std::size_t>(k)]), e.choice));
  const LineMatrix V = residual_spectra(
      e.spectra.options.periodic ? SomeSpectra(e.spectra.noise_re, e.spectra.noise_im, lines) : S,
      e.choice, found.H);
  for (std::size_t k = first; k < std::min(first + together, all.size()); ++k) {
    const auto own = static_cast<int>(k - first);
    r.H[k] = found.H.at(own);
    r.input_factor[k] = found.Q.at(own);
    MatrixXcd unexplained = V.at(own);
    keep_positive(e.spectra, all[k], e.choice.outputs, unexplained);
    auto quality = quality_of(e.spectra, all[k], e.choice, unexplained);
    r.noise[k] = unexplained / e.noise_divisor;
    r.coherence[k] = std::move(quality.coherence);
    r.multiple_coherence[k] = std::move(quality.multiple_coherence);
    r.input_density[k] = std::move(quality.input_density);
  }
}

double density(const CrossSpectra& spectra, Index line, Index channel) {
  return spectra.re(line, channel * (channel + 3) / 2);
}

/// Which lines channels have been excited at.
class Excited {
 public:
  explicit Excited(const CrossSpectra& spectra) : spectra_(spectra) {
    const auto channels = static_cast<Index>(spectra.channels.size());
    for (Index c = 0; c < channels; ++c) {
      const auto own = spectra.re.col(c * (c + 3) / 2);
      levels_.push_back(quiet * own.bottomRows(spectra.lines() - 1).maxCoeff());
      repeats_.push_back(spectra.options.periodic && repeats_somewhere(c));
    }
  }
  /// More than rounding is left of a channel there.
  [[nodiscard]] bool is_there(Index line, const Channels& channels) const {
    return std::ranges::all_of(channels, [&](Index c) {
      return density(spectra_, line, c) > levels_[static_cast<std::size_t>(c)];
    });
  }
  /// Of periodic excitation: what is there is that which repeats, in all channels that do.
  [[nodiscard]] bool repeats(Index line, const Channels& channels) const {
    return std::ranges::all_of(channels, [&](Index c) {
      return !repeats_[static_cast<std::size_t>(c)] || ratio(line, c) > some;
    });
  }

 private:
  static constexpr double quiet = 1e-8;  // of the strongest line
  /// |mean of K periods|² > some · variance of that mean. What is in one period only, as where an
  /// excitation is faded in, has a ratio of 1, whatever its size; noise has 1 in the mean, and more
  /// than 10 in one line of 10⁴ if there are 12 periods or more, of 10 if there are two. Below 10
  /// a response is a tenth too small, or more.
  static constexpr double some = 10.0;
  /// Channels of noise alone, as of an axis that stands still, are not asked: one in `chance` of
  /// them would have a line that stands out of so many.
  static constexpr double chance = 1e-3;

  [[nodiscard]] double ratio(Index line, Index c) const {
    const double noise = spectra_.noise_re(line, c * (c + 3) / 2) *
                         static_cast<double>(spectra_.records) /
                         static_cast<double>(spectra_.blocks);
    return noise > 0.0 ? density(spectra_, line, c) / noise
                       : std::numeric_limits<double>::infinity();
  }
  [[nodiscard]] bool repeats_somewhere(Index c) const {
    const double R = spectra_.records, d = static_cast<double>(spectra_.blocks) - R;
    if (!(d > 0.0)) return false;
    const double much = numerics::fisher_quantile(
        1.0 - chance / static_cast<double>(spectra_.lines()), 2.0 * R, 2.0 * d);
    for (Index line = 1; line < spectra_.lines(); ++line)
      if (ratio(line, c) > much && density(spectra_, line, c) > 0.0) return true;
    return false;
  }

  const CrossSpectra& spectra_;
  std::vector<double> levels_{};
  std::vector<bool> repeats_{};
};

/// The same on several threads, which begin sooner than so many lines are done.
int threads_for(const CrossSpectra& spectra, std::size_t lines) {
  constexpr std::size_t worth_threads = 500;
  return lines < worth_threads ? 1 : spectra.options.threads;
}

}  // namespace

VectorXd input_conditions(const CrossSpectra& spectra, const Channels& inputs,
                          const Channels& others) {
  const Excited excited(spectra);
  VectorXd conditions =
      VectorXd::Constant(spectra.lines(), std::numeric_limits<double>::infinity());
  std::vector<Index> lines;
  for (Index line = 0; line < spectra.lines(); ++line)
    // instruments tell what repeats; of inputs beside them noise makes nothing smaller
    if (excited.is_there(line, inputs) && excited.is_there(line, others) &&
        excited.repeats(line, others))
      lines.push_back(line);
  const std::size_t groups = (lines.size() + together - 1) / together;
  numerics::parallel_for(groups, threads_for(spectra, lines.size()), [&](std::size_t group) {
    const auto own = lines_from(lines, group * together);
    LineMatrix A = SomeSpectra(spectra.re, spectra.im, own).part(inputs, others);
    const auto scale = [&](int channel, int k) {
      return 1.0 / std::sqrt(density(spectra, own[static_cast<std::size_t>(k)], channel));
    };
    for (Index i = 0; i < A.rows(); ++i)
      for (Index j = 0; j < A.cols(); ++j)
        for (int k = 0; k < together; ++k) {
          const double s = scale(inputs[static_cast<std::size_t>(i)], k) *
                           scale(others[static_cast<std::size_t>(j)], k);
          A(i, j).re[k] *= s;
          A(i, j).im[k] *= s;
        }
    SomeLines found;
    condition(std::move(A), found);
    for (int k = 0; k < together; ++k) conditions[own[static_cast<std::size_t>(k)]] = found[k];
  });
  return conditions;
}

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
  if (widened) r.taper = lag_taper(spectra);
  // bursts lie within blocks: their windows let in less
  if (widened && estimator == Estimator::h1 && r.degrees > 0.0 &&
      r.taper == lag_taper(spectra.window))
    r.leakage = {spectra.statistics.leakage_rate * std::pow(r.sample_rate, 2) / r.degrees,
                 spectra.statistics.leakage_covariance, spectra.statistics.leakage_relation};
  // the mean and the slow rest of it are in the first lines, in as many as the window is wide
  const Index first = periodic ? 1 : static_cast<Index>(r.line_covariance.size());
  const VectorXd conditions = input_conditions(
      spectra, c.inputs, estimator == Estimator::instrumental ? c.instruments : c.inputs);
  std::vector<Index> lines;
  for (Index line = first; line < spectra.lines() - 1; ++line) {
    if (!(conditions[line] < singular_condition)) continue;
    lines.push_back(line);
    r.frequency.push_back(spectra.frequency(line));
    r.condition.push_back(conditions[line]);
  }
  for (auto* values : {&r.H, &r.input_factor, &r.noise}) values->resize(lines.size());
  r.coherence.resize(lines.size());
  for (auto* values : {&r.multiple_coherence, &r.input_density}) values->resize(lines.size());
  const Estimation estimation{spectra, c, estimator, periodic ? K : K - p};
  numerics::parallel_for(
      (lines.size() + together - 1) / together, threads_for(spectra, lines.size()),
      [&](std::size_t group) { estimate(estimation, lines, group * together, r); });
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
