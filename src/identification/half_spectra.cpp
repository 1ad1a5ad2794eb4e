#include "hydrapod/identification/responses.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "excitation_ends.hpp"
#include "harmonics.hpp"
#include "held_values.hpp"
#include "hydrapod/identification/identify.hpp"
#include "hydrapod/numerics/fft.hpp"
#include "names.hpp"
#include "references.hpp"
#include "response_checks.hpp"

namespace hydrapod::identification {

namespace {

/// Densities from 0 to half the sample rate, discrete: Σ_k R_k e^(−iωkT).
std::vector<MatrixXcd> discrete_spectra(const CrossSpectra& spectra,
                                        const std::vector<int>& outputs) {
  std::vector<MatrixXcd> lines;
  for (Index k = 0; k < spectra.lines(); ++k)
    lines.emplace_back(0.5 * spectra.sample_rate * spectra.at(k)(outputs, outputs));
  // the first lines hold what is left of the mean
  const auto first = std::min(lines.size() - 1, spectra.statistics.line_covariance.size());
  for (std::size_t k = 0; k < first; ++k) lines[k] = lines[first].real().cast<Complex>();
  lines.back() = lines[lines.size() - 2].real().cast<Complex>();
  return lines;
}

/// ε_k times the taper.
VectorXd half_weights(const VectorXd& taper) {
  VectorXd weights = taper;
  weights[0] *= 0.5;
  return weights;
}

/// Mean over ν of |Q(ω − ν)|² X(ν) for real X at the lines, at every second of them. Q is that of
/// both halves of the lags, of which |Q|² has the same mean over ν and hardly any tails.
class Mixing {
 public:
  explicit Mixing(const VectorXd& taper)
      : fft_(2 * static_cast<int>(taper.size())), kernel_(2 * taper.size()) {
    std::vector<double> padded(static_cast<std::size_t>(kernel_.size()), 0.0);
    const VectorXd half = taper * std::sqrt(0.5);
    VectorXd::Map(padded.data(), half.size()) = half;
    for (Index k = 1; k < half.size(); ++k)
      padded[padded.size() - static_cast<std::size_t>(k)] = half[k];
    lines_.resize(static_cast<std::size_t>(fft_.lines()));
    fft_.forward(padded, lines_);
    for (auto& line : lines_) line = std::norm(line);
    fft_.inverse(lines_, padded);
    kernel_ = VectorXd::Map(padded.data(), kernel_.size());
  }
  VectorXd operator()(const VectorXd& values) {
    for (std::size_t k = 0; k < lines_.size(); ++k) lines_[k] = values[static_cast<Index>(k)];
    VectorXd lags(kernel_.size());
    fft_.inverse(lines_, {lags.data(), static_cast<std::size_t>(lags.size())});
    lags = lags.cwiseProduct(kernel_);
    fft_.forward({lags.data(), static_cast<std::size_t>(lags.size())}, lines_);
    VectorXd mixed(static_cast<Index>(lines_.size() / 2) + 1);
    for (Index k = 0; k < mixed.size(); ++k)
      mixed[k] = std::max(0.0, lines_[static_cast<std::size_t>(2 * k)].real());
    return mixed;
  }

 private:
  numerics::RealFft fft_;
  VectorXd kernel_;  // by lag
  std::vector<Complex> lines_;
};

/// H at all lines of the half spectra.
std::vector<MatrixXcd> transformed(const std::vector<MatrixXcd>& S, const std::vector<int>& inputs,
                                   const VectorXd& weights, double interval) {
  const Index outputs = S[0].rows(), count = static_cast<Index>(inputs.size()), L = weights.size();
  numerics::RealFft back(2 * static_cast<int>(L)), forward(static_cast<int>(L));
  std::vector<Complex> whole(S.size()), half(static_cast<std::size_t>(forward.lines()));
  std::vector<double> lags(2 * static_cast<std::size_t>(L));
  std::vector<MatrixXcd> H(half.size(), MatrixXcd(outputs, count));
  for (Index o = 0; o < outputs; ++o)
    for (Index i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < S.size(); ++k)
        whole[k] = S[k](o, inputs[static_cast<std::size_t>(i)]);
      back.inverse(whole, lags);
      for (Index k = 0; k < L; ++k) lags[static_cast<std::size_t>(k)] *= interval * weights[k];
      forward.forward(std::span(lags).first(static_cast<std::size_t>(L)), half);
      for (std::size_t k = 0; k < H.size(); ++k) H[k](o, i) = half[k];
    }
  return H;
}

/// Variances of H, a number per output times one per reference.
void add_variances(const std::vector<MatrixXcd>& S, const std::vector<int>& inputs,
                   const VectorXd& taper, double factor, FrequencyResponses& all) {
  const Index outputs = S[0].rows(), count = static_cast<Index>(inputs.size());
  MatrixXd own(static_cast<Index>(S.size()), outputs);
  for (Index k = 0; k < own.rows(); ++k)
    own.row(k) = S[static_cast<std::size_t>(k)].diagonal().real().transpose();
  VectorXd level = VectorXd::Zero(own.rows());  // of all references
  for (const int i : inputs) level += own.col(i) / own.col(i).mean();
  Mixing mixed(taper);
  const VectorXd square = mixed(level.cwiseAbs2()).cwiseMax(1e-300);
  MatrixXd by_output(square.size(), outputs);
  for (Index o = 0; o < outputs; ++o)
    by_output.col(o) = factor * mixed(own.col(o).cwiseProduct(level));
  for (Index k = 0; k < square.size(); ++k) {
    VectorXd by_input(count);
    for (Index i = 0; i < count; ++i)
      by_input[i] = by_output(k, inputs[static_cast<std::size_t>(i)]) / (factor * square[k]);
    all.noise.emplace_back(by_output.row(k).transpose().cast<Complex>().asDiagonal());
    all.input_factor.emplace_back(by_input.cast<Complex>().asDiagonal());
  }
}

/// Σ ε² τ² e^(−2πi dk/L), in proportion to d = 0.
std::vector<Complex> covariance_of_lines(const VectorXd& weights) {
  std::vector<Complex> square(static_cast<std::size_t>(weights.size()));
  for (Index k = 0; k < weights.size(); ++k)
    square[static_cast<std::size_t>(k)] = weights[k] * weights[k];
  const auto lines = numerics::complex_fft(square);
  constexpr double negligible = 1e-3;
  constexpr std::size_t most = 12;
  std::vector<Complex> covariance;
  for (std::size_t d = 0; d < most && std::abs(lines[d]) > negligible * std::abs(lines[0]); ++d)
    covariance.push_back(lines[d] / lines[0].real());
  return covariance;
}

/// cos²(πk/2L): 1 at lag 0, 0 at lag L.
VectorXd squared_cosine(Index L) {
  const Eigen::ArrayXd turn = Eigen::ArrayXd::LinSpaced(L, 0.0, static_cast<double>(L - 1)) *
                              (std::numbers::pi / (2.0 * static_cast<double>(L)));
  return turn.cos().square();
}

/// `highest`: [Hz] above which lines are not used anyway.
void warn_of_ends(ExcitationEnds ends, double spacing, double highest, FrequencyResponses& all) {
  if (static_cast<double>(ends.last) * spacing > highest) ends.upper_step = 0.0;
  const double step = std::max(std::abs(ends.lower_step), std::abs(ends.upper_step));
  if (step == 0.0) return;
  const double decibels = 10.0 / std::numbers::ln10;
  all.warnings.push_back(
      {.kind = data::ResponseWarning::Kind::excited_band,
       .value = decibels * step,
       .lowest = ends.lower_step != 0.0 ? static_cast<double>(ends.first) * spacing : 0.0,
       .highest = ends.upper_step != 0.0 ? static_cast<double>(ends.last) * spacing : 0.0,
       .estimator = Estimator::half_spectra});
}

/// Outputs, averages and warnings, without lines and inputs; and the outputs that live.
std::pair<FrequencyResponses, std::vector<int>> channels_of(const CrossSpectra& spectra,
                                                            const std::vector<int>& outputs) {
  ChannelChoice choice{.outputs = outputs};
  const auto lives = [&](int o) { return !spectra.health[static_cast<std::size_t>(o)].constant(); };
  const auto first = std::ranges::find_if(outputs, lives);
  choice.inputs = {first == outputs.end() ? outputs.at(0) : *first};
  auto all = without_lines(spectra, Estimator::half_spectra, choice);
  all.inputs.clear();
  return {std::move(all), std::move(choice.outputs)};
}

}  // namespace

std::vector<int> choose_references(const std::vector<MatrixXcd>& S, Index most) {
  const Index outputs = S[0].rows();
  VectorXd size = VectorXd::Zero(outputs);
  for (const auto& s : S) size += s.diagonal().real();
  const VectorXd unit = size.cwiseSqrt().cwiseInverse();
  MatrixXd rest = MatrixXd::Zero(outputs, outputs);
  for (const auto& s : S) {
    const MatrixXd scaled = unit.asDiagonal() * s.real() * unit.asDiagonal();
    rest += scaled / std::max(scaled.trace(), 1e-300);
  }
  std::vector<int> chosen;
  while (static_cast<Index>(chosen.size()) < std::min(most, outputs)) {
    Index at = 0;
    if (!(rest.diagonal().maxCoeff(&at) > 0.0)) break;
    chosen.push_back(static_cast<int>(at));
    const VectorXd column = rest.col(at) / rest(at, at);
    rest -= (rest(at, at) * column * column.transpose()).eval();
    rest.row(at).setZero();
    rest.col(at).setZero();
  }
  std::ranges::sort(chosen);
  return chosen;
}

FrequencyResponses half_spectra(const CrossSpectra& spectra, const std::vector<int>& outputs,
                                const HalfSpectraOptions& options) {
  ChannelChoice choice{.outputs = outputs};
  std::vector<data::ResponseWarning> slow;
  leave_out_slow(spectra, choice, slow);
  auto [all, living] = channels_of(spectra, choice.outputs);
  all.warnings.insert(all.warnings.end(), slow.begin(), slow.end());
  const Index L = spectra.options.block_length / 2;
  const double interval = 1.0 / spectra.sample_rate;
  auto S = discrete_spectra(spectra, living);
  all.harmonics = find_harmonics(spectra, living);
  leave_out_harmonics(all.harmonics, spectra.frequency(1), S);
  for (const auto& tone : options.wandering) leave_out_wandering(spectra, living, tone, S, all);
  const auto ends = excitation_ends(S);
  continue_beyond(ends, S);
  warn_of_ends(ends, spectra.frequency(1), options.below_nyquist * spectra.sample_rate, all);
  const auto references = choose_references(S, options.most_references);
  for (const int i : references) all.inputs.push_back(all.outputs[static_cast<std::size_t>(i)]);
  const VectorXd window = lag_taper(spectra.window);
  all.taper = window.head(L).cwiseProduct(squared_cosine(L));
  const double samples = all.averages * (2.0 * window.squaredNorm() - 1.0);
  const VectorXd weights = half_weights(all.taper);
  all.line_covariance = covariance_of_lines(weights);
  all.H = transformed(S, references, weights, interval);
  add_variances(S, references, all.taper, interval * interval / samples, all);
  for (std::size_t k = 0; k < all.H.size(); ++k)
    all.frequency.push_back(static_cast<double>(k) * spectra.sample_rate / static_cast<double>(L));
  all.whole = std::make_shared<data::OutputSpectra>(data::OutputSpectra{
      .S = std::move(S), .samples = samples, .averages = all.averages, .references = references});
  const auto first = std::max(ends.first, std::ssize(spectra.statistics.line_covariance));
  return within(all, static_cast<double>(first) * spectra.frequency(1),
                std::min(options.below_nyquist * spectra.sample_rate,
                         static_cast<double>(ends.last) * spectra.frequency(1)));
}

}  // namespace hydrapod::identification
