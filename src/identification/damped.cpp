#include "damped.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "hydrapod/base/error.hpp"
#include "hydrapod/numerics/fft.hpp"
#include "names.hpp"
#include "response_checks.hpp"

namespace hydrapod::identification {

namespace {

constexpr double decay = 4.0;            // a times half a block: e⁻⁴ of h is cut off
constexpr Index kernel_reach = 12;       // lines of the spectra on either side that are mixed
constexpr Index edge = 16;               // lines over which an excited band ends
constexpr double weakly_excited = 1e-5;  // of the strongest line of an instrument
constexpr std::size_t least_lines = 16;
constexpr double negligible_covariance = 0.03;

/// The factor q(τ) on impulse responses, and what it does to their errors.
struct LagWindow {
  double a{};           // [1/s]
  VectorXd q;           // n/2 lags
  VectorXd kernel;      // weight of lines −reach … reach, sum 1
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

LagWindow lag_window(const CrossSpectra& spectra) {
  const Index n = spectra.options.block_length, m = n / 2;
  const double dt = 1.0 / spectra.sample_rate;
  const VectorXd rho = lag_taper(spectra.window);
  LagWindow w;
  w.a = decay / (static_cast<double>(m) * dt);
  w.q = VectorXd(m);
  for (Index t = 0; t < m; ++t)
    w.q[t] = std::exp(-w.a * static_cast<double>(t) * dt) / std::max(rho[t], 1e-3);
  const auto& before = spectra.statistics.line_covariance;
  const VectorXd scatter = w.q.cwiseAbs2().cwiseProduct(lag_scatter(before, m, n));
  w.noise = scatter.sum();
  for (Index d = 0; d < std::min<Index>(m / 2, 200); ++d) {
    const Complex sum = line_of(scatter, d, m);
    if (std::abs(sum) < negligible_covariance * w.noise) break;
    w.line_covariance.push_back(sum / w.noise);
  }
  w.kernel = VectorXd(2 * kernel_reach + 1);
  for (Index d = -kernel_reach; d <= kernel_reach; ++d)
    w.kernel[d + kernel_reach] = std::norm(line_of(w.q, -d, n));
  w.kernel /= w.kernel.sum();
  double together = 0.0;
  for (Index d = 0; d < w.kernel.size(); ++d)
    for (Index e = 0; e < w.kernel.size(); ++e)
      if (const auto apart = static_cast<std::size_t>(std::abs(d - e)); apart < before.size())
        together += w.kernel[d] * w.kernel[e] * before[apart];
  w.more_lines = 1.0 / together;
  return w;
}

/// Share of each line that is used: 1 inside excited bands, falling to 0 at their ends.
VectorXd excited_share(const CrossSpectra& spectra, const std::vector<int>& instruments) {
  const Index lines = spectra.lines();
  std::vector<bool> excited(static_cast<std::size_t>(lines), true);
  for (const int r : instruments) {
    const auto density = spectra.re.col(static_cast<Index>(r) * (r + 3) / 2);
    const double least = weakly_excited * density.bottomRows(lines - 1).maxCoeff();
    for (Index k = 0; k < lines; ++k)
      if (k > 0 && !(density[k] > least)) excited[static_cast<std::size_t>(k)] = false;
  }
  VectorXd share = VectorXd::Zero(lines);
  Index since = edge;  // lines since the last one that is not excited; below 0 Hz mirrors
  for (Index k = 0; k < lines; ++k) {
    since = excited[static_cast<std::size_t>(k)] ? std::min(edge, since + 1) : 0;
    share[k] = static_cast<double>(since) / edge;
  }
  since = edge;
  for (Index k = lines; k-- > 0;) {
    since = excited[static_cast<std::size_t>(k)] ? std::min(edge, since + 1) : 0;
    share[k] = std::min(share[k], static_cast<double>(since) / edge);
  }
  for (double& s : share) s = 0.5 - 0.5 * std::cos(std::numbers::pi * s);
  return share;
}

/// H1 from the instruments r to w = (outputs, inputs), at all lines of the spectra.
struct FromInstruments {
  std::vector<MatrixXcd> H;      // w × r, times the share that is used
  std::vector<MatrixXcd> noise;  // spectrum of w − H r
  std::vector<MatrixXcd> P;      // S_rr⁻¹
};

FromInstruments from_instruments(const CrossSpectra& spectra, const ChannelChoice& c,
                                 const VectorXd& share, Index first) {
  auto all = c.outputs;
  all.insert(all.end(), c.inputs.begin(), c.inputs.end());
  const auto rows = static_cast<Index>(all.size()), p = static_cast<Index>(c.instruments.size());
  FromInstruments f;
  for (Index k = 0; k < spectra.lines(); ++k) {
    f.H.emplace_back(MatrixXcd::Zero(rows, p));
    f.noise.emplace_back(MatrixXcd::Zero(rows, rows));
    f.P.emplace_back(MatrixXcd::Zero(p, p));
    if (k < first || !(share[k] > 0.0)) continue;
    const MatrixXcd S = spectra.at(k);
    const MatrixXcd S_wr = S(all, c.instruments);
    const MatrixXcd P = S(c.instruments, c.instruments).llt().solve(MatrixXcd::Identity(p, p));
    if (!P.allFinite()) continue;
    f.H.back() = share[k] * S_wr * P;
    f.noise.back() = S(all, all) - S_wr * P * S_wr.adjoint();
    f.P.back() = P;
  }
  for (Index k = 0; k < first; ++k) {  // the mean was taken out: as at the first line, and real
    const auto from = static_cast<std::size_t>(first), to = static_cast<std::size_t>(k);
    f.H[to] = f.H[from].real().cast<Complex>();
    f.noise[to] = f.noise[from];
    f.P[to] = f.P[from];
  }
  return f;
}

/// H'(ω) at every second line, n/4 + 1 of them.
std::vector<MatrixXcd> brought_to_shift(const std::vector<MatrixXcd>& H, const VectorXd& q) {
  const auto m = static_cast<int>(q.size());
  numerics::RealFft whole(2 * m), half(m);
  std::vector<MatrixXcd> result(static_cast<std::size_t>(half.lines()),
                                MatrixXcd(H[0].rows(), H[0].cols()));
  std::vector<Complex> lines(static_cast<std::size_t>(whole.lines())),
      shifted(static_cast<std::size_t>(half.lines()));
  std::vector<double> h(static_cast<std::size_t>(2 * m));
  for (Index i = 0; i < H[0].rows(); ++i)
    for (Index j = 0; j < H[0].cols(); ++j) {
      for (std::size_t k = 0; k < lines.size(); ++k) lines[k] = H[k](i, j);
      lines.back() = lines.back().real();
      whole.inverse(lines, h);
      for (int t = 0; t < m; ++t) h[static_cast<std::size_t>(t)] *= q[t];
      half.forward(std::span(h).first(static_cast<std::size_t>(m)), shifted);
      for (std::size_t k = 0; k < shifted.size(); ++k) result[k](i, j) = shifted[k];
    }
  return result;
}

/// Mean over the lines that the lag window mixes, of those that were used.
MatrixXcd mixed(const std::vector<MatrixXcd>& values, const VectorXd& share, Index line,
                const VectorXd& kernel) {
  MatrixXcd sum = MatrixXcd::Zero(values[0].rows(), values[0].cols());
  double weight = 0.0;
  for (Index d = -kernel_reach; d <= kernel_reach; ++d) {
    const Index k = std::abs(line + d);
    if (k >= share.size() || !(share[k] > 0.0)) continue;
    const double w = kernel[d + kernel_reach];
    const auto& value = values[static_cast<std::size_t>(k)];
    sum += w * (line + d < 0 ? MatrixXcd(value.conjugate()) : value);
    weight += w;
  }
  return sum / weight;
}

void add_line(const CrossSpectra& spectra, const ChannelChoice& c, const MatrixXcd& H_wr,
              const MatrixXcd& noise, const MatrixXcd& P, double scale, Index line,
              FrequencyResponses& r) {
  const auto outputs = static_cast<Index>(c.outputs.size()),
             p = static_cast<Index>(c.inputs.size());
  const MatrixXcd G = H_wr.bottomRows(p).partialPivLu().inverse();
  MatrixXcd difference(outputs, outputs + p);
  difference.leftCols(outputs).setIdentity();
  const MatrixXcd H = H_wr.topRows(outputs) * G;
  difference.rightCols(p) = -H;
  MatrixXcd V = difference * noise * difference.adjoint();
  const MatrixXcd S = spectra.at(line);
  keep_positive(S, c.outputs, V);
  r.frequency.push_back(spectra.frequency(line));
  r.H.push_back(H);
  r.input_factor.push_back(G.adjoint() * P * G);
  r.noise.push_back(scale * V);
  add_quality(S, c, V, r);
}

}  // namespace

FrequencyResponses damped_instrumental(const CrossSpectra& spectra, const ChannelChoice& wanted) {
  ChannelChoice c = wanted;
  auto r = without_lines(spectra, Estimator::instrumental, c);
  const double K = r.averages, p = static_cast<double>(c.inputs.size());
  const LagWindow window = lag_window(spectra);
  const auto first = static_cast<Index>(spectra.statistics.line_covariance.size());
  const VectorXd share = excited_share(spectra, c.instruments);
  const auto f = from_instruments(spectra, c, share, first);
  const auto H = brought_to_shift(f.H, window.q);
  r.degrees = (K - p) * window.more_lines;
  r.shift = window.a;
  r.line_covariance = window.line_covariance;
  const auto quiet = quiet_levels(spectra);
  constexpr Index apart = 4;  // lines from where the excitation is less, or the mean was
  for (Index k = (first + apart) / 2; 2 * k + apart < spectra.lines(); ++k) {
    if (share.segment(std::max<Index>(0, 2 * k - apart), 2 * apart + 1).minCoeff() < 1.0) continue;
    const double condition = input_condition(spectra.at(2 * k), c.inputs, c.instruments, quiet);
    if (!(condition < singular_condition)) continue;
    add_line(spectra, c, H[static_cast<std::size_t>(k)],
             mixed(f.noise, share, 2 * k, window.kernel), mixed(f.P, share, 2 * k, window.kernel),
             window.noise / (K - p), 2 * k, r);
    r.condition.push_back(condition);
  }
  if (r.lines() < least_lines) return estimate_responses(spectra, wanted, r.estimator);
  finish_checks(spectra, c, r);
  return r;
}

FrequencyResponses responses_for_modes(const CrossSpectra& spectra, const ChannelChoice& choice,
                                       Estimator estimator) {
  return estimator == Estimator::instrumental && !spectra.options.periodic
             ? damped_instrumental(spectra, choice)
             : estimate_responses(spectra, choice, estimator);
}

}  // namespace hydrapod::identification
