#include "damped.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <span>

#include "alignment.hpp"
#include "bridge.hpp"
#include "held_values.hpp"
#include "hydrapod/base/error.hpp"
#include "hydrapod/numerics/fft.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "names.hpp"
#include "response_checks.hpp"

namespace hydrapod::identification {

namespace {

constexpr Index kernel_reach = 12;  // lines on either side that a line of the result averages
constexpr double negligible_covariance = 0.03;

/// The factor q(τ) = e^(−aτ)/ρ(τ) on impulse responses, and what it does to their errors.
struct LagWindow {
  double a{};           // [1/s]
  VectorXd rho;         // n/2 + 1 lags
  VectorXd decay;       // e^(−aτ), n/2 lags
  VectorXd mixing;      // n lags: transform of the weights of lines, whose sum is 1
  double noise{};       // c: variance after by variance before
  double more_lines{};  // lines that the kernel averages, in independent ones
  std::vector<Complex> line_covariance;
};

/// Share of the scatter of an averaged cross spectrum at each of n circular lags.
VectorXd lag_scatter(const std::vector<double>& line_covariance, Index lags, Index n) {
  VectorXd v = VectorXd::Constant(lags, 1.0 / static_cast<double>(n));
  for (Index t = 0; t < lags; ++t)
    for (std::size_t d = 1; d < line_covariance.size(); ++d)
      v[t] += 2.0 / static_cast<double>(n) * line_covariance[d] *
              std::cos(two_pi * static_cast<double>(d) * static_cast<double>(t) /
                       static_cast<double>(n));
  return v.cwiseMax(0.0);
}

/// Σ_t x_t e^(2πi d t/n).
Complex line_of(const VectorXd& x, Index d, Index n) {
  Complex sum = 0.0;
  for (Index t = 0; t < x.size(); ++t)
    sum += x[t] * std::polar(1.0, two_pi * static_cast<double>(d) * static_cast<double>(t) /
                                      static_cast<double>(n));
  return sum;
}

LagWindow lag_window(const CrossSpectra& spectra, double decay) {
  const Index n = spectra.options.block_length, m = n / 2;
  const double dt = 1.0 / spectra.sample_rate;
  LagWindow w;
  w.rho = lag_taper(spectra).head(m + 1).cwiseMax(1e-3);
  w.a = decay / (static_cast<double>(m) * dt);
  w.decay = VectorXd(m);
  for (Index t = 0; t < m; ++t) w.decay[t] = std::exp(-w.a * static_cast<double>(t) * dt);
  const VectorXd q = w.decay.cwiseQuotient(w.rho.head(m));
  const auto& before = spectra.statistics.line_covariance;
  const VectorXd scatter = q.cwiseAbs2().cwiseProduct(lag_scatter(before, m, n));
  w.noise = scatter.sum();
  for (Index d = 0; d < std::min<Index>(m / 2, 200); ++d) {
    const Complex sum = line_of(scatter, d, m);
    if (std::abs(sum) < negligible_covariance * w.noise) break;
    w.line_covariance.push_back(sum / w.noise);
  }
  numerics::RealFft fft(static_cast<int>(n));
  std::vector<double> lags(static_cast<std::size_t>(n), 0.0);
  std::copy(q.begin(), q.end(), lags.begin());
  std::vector<Complex> weights(static_cast<std::size_t>(fft.lines()));
  fft.forward(lags, weights);
  for (Complex& weight : weights) weight = std::norm(weight);
  const std::vector<Complex> powers = weights;
  fft.inverse(weights, lags);
  w.mixing = VectorXd::Map(lags.data(), n) / lags.front();
  double together = 0.0, all = 0.0;
  for (Index d = -kernel_reach; d <= kernel_reach; ++d) {
    all += powers[static_cast<std::size_t>(std::abs(d))].real();
    for (Index e = -kernel_reach; e <= kernel_reach; ++e)
      if (const auto apart = static_cast<std::size_t>(std::abs(d - e)); apart < before.size())
        together += powers[static_cast<std::size_t>(std::abs(d))].real() *
                    powers[static_cast<std::size_t>(std::abs(e))].real() * before[apart];
  }
  together /= all * all;
  w.more_lines = 1.0 / together;
  return w;
}

/// H1 from the instruments r to w = (outputs, inputs), at all lines of the spectra.
struct FromInstruments {
  std::vector<MatrixXcd> H;      // w × r
  std::vector<MatrixXcd> noise;  // spectrum of w − H r
  std::vector<MatrixXcd> P;      // S_rr⁻¹; 0 where it cannot be formed
  /// What r explains of the channels w, and what it would explain of noise: means of the shares of
  /// their power.
  VectorXd explained, by_chance;
};

FromInstruments from_instruments(const CrossSpectra& spectra, const ChannelChoice& c,
                                 double averages) {
  auto all = c.outputs;
  all.insert(all.end(), c.inputs.begin(), c.inputs.end());
  const auto rows = static_cast<Index>(all.size()), p = static_cast<Index>(c.instruments.size());
  FromInstruments f;
  f.explained = f.by_chance = VectorXd::Zero(spectra.lines());
  for (Index k = 0; k < spectra.lines(); ++k) {
    f.H.emplace_back(MatrixXcd::Zero(rows, p));
    f.noise.emplace_back(MatrixXcd::Zero(rows, rows));
    f.P.emplace_back(MatrixXcd::Zero(p, p));
    const MatrixXcd S = spectra.at(k);
    const MatrixXcd S_wr = S(all, c.instruments);
    const MatrixXcd P = S(c.instruments, c.instruments).llt().solve(MatrixXcd::Identity(p, p));
    if (!P.allFinite()) continue;
    f.H.back() = S_wr * P;
    const MatrixXcd explained = f.H.back() * S_wr.adjoint();
    f.noise.back() = S(all, all) - explained;
    f.P.back() = P;
    const VectorXd power = S.diagonal().real()(all).cwiseMax(1e-300);
    f.explained[k] = explained.diagonal().real().cwiseQuotient(power).mean();
    f.by_chance[k] =
        (1.0 - f.explained[k]) * static_cast<double>(p) / (averages - static_cast<double>(p));
  }
  return f;
}

/// Lines at which the instruments are strong enough, and seen in outputs and inputs.
std::vector<bool> excited_lines(const CrossSpectra& spectra, const std::vector<int>& instruments,
                                const FromInstruments& f, const DampedOptions& options) {
  const Index lines = spectra.lines();
  std::vector<bool> excited(static_cast<std::size_t>(lines), true);
  for (const int r : instruments) {
    const auto density = spectra.re.col(static_cast<Index>(r) * (r + 3) / 2);
    const double least = options.weakly_excited * density.bottomRows(lines - 1).maxCoeff();
    for (Index k = 0; k < lines; ++k)
      if (!(density[k] > least)) excited[static_cast<std::size_t>(k)] = false;
  }
  const auto seen = [&](Index from, Index to) {
    return f.explained.segment(from, to - from + 1).sum() >
           options.seen * f.by_chance.segment(from, to - from + 1).sum();
  };
  for (Index k = 0; k < lines; ++k)
    if (!seen(std::max<Index>(0, k - options.seen_reach), k) ||
        !seen(k, std::min(lines - 1, k + options.seen_reach)))
      excited[static_cast<std::size_t>(k)] = false;
  return excited;
}

/// Samples t ≥ 0 doubled, so that the phase of the spectrum belongs to a causal sequence.
std::vector<Complex> minimum_phase(const VectorXd& log_magnitude) {
  const auto lines = static_cast<std::size_t>(log_magnitude.size()), n = 2 * (lines - 1);
  numerics::RealFft fft(static_cast<int>(n));
  std::vector<Complex> spectrum(log_magnitude.begin(), log_magnitude.end());
  std::vector<double> cepstrum(n);
  fft.inverse(spectrum, cepstrum);
  for (std::size_t t = 1; t < n / 2; ++t) cepstrum[t] *= 2.0;
  std::fill(cepstrum.begin() + static_cast<std::ptrdiff_t>(n / 2) + 1, cepstrum.end(), 0.0);
  fft.forward(cepstrum, spectrum);
  for (Complex& line : spectrum) line = std::exp(line);
  return spectrum;
}

/// The line k of a spectrum of n/2 + 1 lines, which is even and has the period n.
Index mirrored(Index k, Index lines) {
  const Index n = 2 * (lines - 1), at = ((k % n) + n) % n;
  return std::min(at, n - at);
}

/// A bell of some lines, standard deviation `width`, over a spectrum.
VectorXd smoothed(const VectorXd& x, double width) {
  const auto reach = static_cast<Index>(std::lround(5.0 * width));
  VectorXd bell(2 * reach + 1), result = VectorXd::Zero(x.size());
  for (Index d = -reach; d <= reach; ++d)
    bell[d + reach] = std::exp(-0.5 * std::pow(static_cast<double>(d) / width, 2));
  bell /= bell.sum();
  for (Index k = 0; k < x.size(); ++k)
    for (Index d = -reach; d <= reach; ++d)
      result[k] += bell[d + reach] * x[mirrored(k + d, x.size())];
  return result;
}

/// ln |D| for the edges of the excitation: 0 where all is excited.
VectorXd band_edges(const std::vector<bool>& excited, const DampedOptions& options) {
  const auto lines = static_cast<Index>(excited.size());
  VectorXd outside = VectorXd::Zero(lines);
  if (std::ranges::count(excited, false) == 0) return outside;
  const auto edge = static_cast<Index>(std::lround(options.edge));
  for (Index k = 0; k < lines; ++k)
    for (Index d = -edge; d <= edge; ++d)
      if (!excited[static_cast<std::size_t>(mirrored(k + d, lines))]) outside[k] = 1.0;
  return std::log(options.attenuation) * smoothed(outside, options.edge);
}

/// ln |D| that makes errors of H_wr flat, as a mean over its channels: of excited lines, and over
/// the others bridged.
VectorXd whitening(const FromInstruments& f, const std::vector<bool>& excited,
                   const DampedOptions& options) {
  const auto lines = static_cast<Index>(f.H.size()), rows = f.H[0].rows();
  MatrixXd variance = MatrixXd::Zero(rows, lines);
  for (Index k = 0; k < lines; ++k)
    if (const auto line = static_cast<std::size_t>(k); excited[line])
      variance.col(k) = f.P[line].trace().real() * f.noise[line].diagonal().real().cwiseMax(0.0);
  const VectorXd total = variance.rowwise().sum().cwiseMax(1e-300);
  VectorXd flat = (variance.array().colwise() / total.array()).colwise().sum().transpose();
  const double least = options.deepest * flat.maxCoeff();
  if (!(least > 0.0)) return VectorXd::Zero(lines);  // rounding is all there is
  flat = -0.5 * flat.cwiseMax(least).array().log().matrix();
  bridge(flat, [&](Index k) { return !excited[static_cast<std::size_t>(k)]; });
  return smoothed(flat, options.whitening);
}

/// H'(ω) at every second line, n/4 + 1 of them, from H at excited lines and 0 at others.
std::vector<MatrixXcd> brought_to_shift(const std::vector<MatrixXcd>& H,
                                        const std::vector<Complex>& D, const LagWindow& window) {
  const auto m = static_cast<std::size_t>(window.decay.size());
  numerics::RealFft whole(static_cast<int>(2 * m)), half(static_cast<int>(m));
  std::vector<MatrixXcd> result(static_cast<std::size_t>(half.lines()),
                                MatrixXcd(H[0].rows(), H[0].cols()));
  std::vector<Complex> lines(static_cast<std::size_t>(whole.lines())),
      shifted(static_cast<std::size_t>(half.lines()));
  std::vector<double> h(2 * m);
  for (Index i = 0; i < H[0].rows(); ++i)
    for (Index j = 0; j < H[0].cols(); ++j) {
      for (std::size_t k = 0; k < lines.size(); ++k) lines[k] = H[k](i, j);
      lines.back() = lines.back().real();
      whole.inverse(lines, h);
      for (std::size_t t = 0; t < h.size(); ++t)
        h[t] /= window.rho[static_cast<Index>(std::min(t, h.size() - t))];
      whole.forward(h, lines);
      for (std::size_t k = 0; k < lines.size(); ++k) lines[k] *= D[k];
      whole.inverse(lines, h);
      for (std::size_t t = 0; t < m; ++t) h[t] *= window.decay[static_cast<Index>(t)];
      half.forward(std::span(h).first(m), shifted);
      for (std::size_t k = 0; k < shifted.size(); ++k) result[k](i, j) = shifted[k];
    }
  return result;
}

/// Means over all lines as the lag window mixes them, of what is given at each.
class Mixed {
 public:
  explicit Mixed(const LagWindow& window)
      : mixing_(window.mixing),
        fft_(static_cast<int>(mixing_.size())),
        lags_(static_cast<std::size_t>(mixing_.size())) {}

  void operator()(std::vector<Complex>& lines) {
    lines.back() = lines.back().real();
    fft_.inverse(lines, lags_);
    for (std::size_t t = 0; t < lags_.size(); ++t) lags_[t] *= mixing_[static_cast<Index>(t)];
    fft_.forward(lags_, lines);
  }
  /// Hermitian matrices.
  void operator()(std::vector<MatrixXcd>& matrices) {
    std::vector<Complex> lines(matrices.size());
    for (Index i = 0; i < matrices[0].rows(); ++i)
      for (Index j = 0; j <= i; ++j) {
        for (std::size_t k = 0; k < lines.size(); ++k) lines[k] = matrices[k](i, j);
        (*this)(lines);
        for (std::size_t k = 0; k < lines.size(); ++k) {
          matrices[k](i, j) = lines[k];
          matrices[k](j, i) = std::conj(lines[k]);
        }
      }
  }

 private:
  const VectorXd& mixing_;
  numerics::RealFft fft_;
  std::vector<double> lags_;
};

/// Covariance W by P of the errors D e at each line, means over the lines that are mixed there.
struct Errors {
  std::vector<MatrixXcd> W, P;
};

Errors mixed(const FromInstruments& f, const std::vector<Complex>& D, const LagWindow& window) {
  Errors e;
  std::vector<Complex> sizes;
  for (std::size_t k = 0; k < D.size(); ++k) {
    e.P.push_back(std::norm(D[k]) * f.P[k]);
    sizes.emplace_back(e.P.back().trace().real());
    e.W.push_back(sizes.back() * f.noise[k]);
  }
  Mixed mix(window);
  mix(e.W);
  mix(e.P);
  mix(sizes);
  for (std::size_t k = 0; k < D.size(); ++k) e.W[k] /= sizes[k].real();
  return e;
}

/// F of the weakest mixture of the inputs, of whose errors `noise` (all but scale) and `factor` are
/// the covariance. What is certainly more than `strong` is not told exactly.
double first_stage(const MatrixXcd& noise, const MatrixXcd& factor, double scale, double strong) {
  const double each = scale * static_cast<double>(noise.rows());
  const double all = (noise * factor).trace().real();
  if (!(each * all * strong > 1.0)) return 1.0 / std::max(each * all, 1e-300);
  const MatrixXcd root = Eigen::SelfAdjointEigenSolver<MatrixXcd>(noise).operatorSqrt();
  const Eigen::SelfAdjointEigenSolver<MatrixXcd> product(root * factor * root,
                                                         Eigen::EigenvaluesOnly);
  return 1.0 / std::max(each * product.eigenvalues().maxCoeff(), 1e-300);
}

/// A warning for each run of lines with F < strong; runs with less between them than the wider one
/// has, or than `near` Hz, are one.
void warn_of_weak_excitation(const std::vector<double>& F, double strong, double near,
                             FrequencyResponses& r) {
  std::vector<data::ResponseWarning> runs;
  for (std::size_t k = 0; k < F.size(); ++k) {
    if (!(F[k] < strong)) continue;
    const double f = r.frequency[k];
    if (!runs.empty() &&
        f - runs.back().highest <= std::max(near, runs.back().highest - runs.back().lowest)) {
      runs.back().highest = f;
      runs.back().value = std::min(runs.back().value, F[k]);
      continue;
    }
    runs.push_back({.kind = data::ResponseWarning::Kind::weak_excitation,
                    .value = F[k],
                    .lowest = f,
                    .highest = f});
  }
  for (auto& run : runs) {
    run.share = run.value / strong;
    r.warnings.push_back(std::move(run));
  }
}

/// Returns F.
double add_line(const CrossSpectra& spectra, const ChannelChoice& c, const MatrixXcd& H_wr,
                const Errors& errors, double scale, double strong, Index line,
                FrequencyResponses& r) {
  const MatrixXcd &W = errors.W[static_cast<std::size_t>(line)],
                  &P = errors.P[static_cast<std::size_t>(line)];
  const auto outputs = static_cast<Index>(c.outputs.size()),
             p = static_cast<Index>(c.inputs.size());
  const MatrixXcd G = H_wr.bottomRows(p).partialPivLu().inverse();
  MatrixXcd difference(outputs, outputs + p);
  difference.leftCols(outputs).setIdentity();
  const MatrixXcd H = H_wr.topRows(outputs) * G;
  difference.rightCols(p) = -H;
  MatrixXcd V = difference * W * difference.adjoint();
  keep_positive(spectra, line, c.outputs, V);
  r.frequency.push_back(spectra.frequency(line));
  r.H.push_back(H);
  r.input_factor.push_back(G.adjoint() * P * G);
  r.noise.push_back(scale * V);
  auto quality = quality_of(spectra, line, c, V);
  r.coherence.push_back(std::move(quality.coherence));
  r.multiple_coherence.push_back(std::move(quality.multiple_coherence));
  r.input_density.push_back(std::move(quality.input_density));
  return first_stage(W.bottomRightCorner(p, p), r.input_factor.back(), scale, strong);
}

}  // namespace

FrequencyResponses damped_instrumental(const CrossSpectra& spectra, const ChannelChoice& wanted,
                                       const DampedOptions& options) {
  ChannelChoice c = wanted;
  auto r = without_lines(spectra, Estimator::instrumental, c);
  const double K = r.averages, p = static_cast<double>(c.inputs.size());
  const LagWindow window = lag_window(spectra, options.decay);
  const auto first = static_cast<Index>(spectra.statistics.line_covariance.size());
  auto f = from_instruments(spectra, c, K);
  const auto excited = excited_lines(spectra, c.instruments, f, options);
  for (std::size_t k = 0; k < excited.size(); ++k)
    if (!excited[k]) f.H[k].setZero();
  const VectorXd edges = band_edges(excited, options);
  auto D = minimum_phase(edges + whitening(f, excited, options));
  for (std::size_t k = 0; k < excited.size(); ++k)
    if (!excited[k]) D[k] = 0.0;
  const auto H = brought_to_shift(f.H, D, window);
  const auto errors = mixed(f, D, window);
  r.degrees = (K - p) * window.more_lines;
  r.shift = window.a;
  r.line_covariance = window.line_covariance;
  const VectorXd conditions = input_conditions(spectra, c.inputs, c.instruments);
  constexpr Index apart = 4;  // lines from the first ones and the last
  std::vector<double> F;
  for (Index k = (first + apart) / 2; 2 * k + apart < spectra.lines(); ++k) {
    if (!(edges[2 * k] > std::log(options.least_share))) continue;
    if (!(conditions[2 * k] < singular_condition)) continue;
    F.push_back(add_line(spectra, c, H[static_cast<std::size_t>(k)], errors, window.noise / (K - p),
                         options.strong, 2 * k, r));
    r.condition.push_back(conditions[2 * k]);
  }
  if (r.lines() < options.least_lines) return estimate_responses(spectra, wanted, r.estimator);
  finish_checks(spectra, c, r);
  warn_of_weak_excitation(F, options.strong, options.edge * spectra.frequency(1), r);
  return r;
}

FrequencyResponses responses_for_modes(const CrossSpectra& spectra, const ChannelChoice& choice,
                                       Estimator estimator) {
  auto own = choice;
  std::vector<data::ResponseWarning> warnings;
  leave_out_slow(spectra, own, warnings);
  auto responses = estimator == Estimator::instrumental && !spectra.options.periodic
                       ? damped_instrumental(spectra, own)
                       : estimate_responses(spectra, own, estimator);
  without_hold(spectra, responses);
  align_outputs(responses);
  responses.warnings.insert(responses.warnings.end(), warnings.begin(), warnings.end());
  return responses;
}

}  // namespace hydrapod::identification
