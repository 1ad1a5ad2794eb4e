#include "signals.hpp"

#include <algorithm>
#include <cmath>

#include "hydrapod/numerics/fft.hpp"

namespace hydrapod::identification {

namespace {

/// Worth a change of the sample rate.
constexpr double much_lower = 0.8;
/// Samples at the ends that are touched by what the sharp edge of the band makes of a step there.
constexpr Index edge = 8;

MatrixXd detrended(const MatrixXd& samples) {
  const Index n = samples.rows();
  if (n < 2) return samples;
  const VectorXd t = VectorXd::LinSpaced(n, -1.0, 1.0);
  const Eigen::RowVectorXd mean = samples.colwise().mean();
  const Eigen::RowVectorXd slope = (t.transpose() * samples) / t.squaredNorm();
  return samples.rowwise() - mean - t * slope;
}

/// `kept` samples in the time of the first `n`.
MatrixXd resampled(const MatrixXd& samples, Index n, Index kept) {
  MatrixXd result(kept, samples.cols());
  for (Index c = 0; c < samples.cols(); ++c) {
    // without the step from the end to the beginning
    const double first = samples(0, c), last = samples(n - 1, c);
    const auto line = [&](double share) { return first + (last - first) * share; };
    std::vector<Complex> all(static_cast<std::size_t>(n));
    for (Index t = 0; t < n; ++t)
      all[static_cast<std::size_t>(t)] =
          samples(t, c) - line(static_cast<double>(t) / static_cast<double>(n));
    const auto lines = numerics::complex_fft(all);
    std::vector<Complex> some(static_cast<std::size_t>(kept));
    for (Index k = 0; k < kept; ++k) {
      const Index at = 2 * k < kept ? k : k - kept;
      if (2 * at == -kept) continue;
      some[static_cast<std::size_t>(k)] = lines[static_cast<std::size_t>(at < 0 ? at + n : at)];
    }
    const auto back = numerics::inverse_complex_fft(some);
    for (Index t = 0; t < kept; ++t)
      result(t, c) = back[static_cast<std::size_t>(t)].real() / static_cast<double>(n) +
                     line(static_cast<double>(t) / static_cast<double>(kept));
  }
  return result;
}

}  // namespace

Index good_length(Index count) {
  for (Index n = count / 2 * 2; n > 2; n -= 2) {
    Index rest = n;
    for (const Index factor : {2, 3, 5})
      while (rest % factor == 0) rest /= factor;
    if (rest == 1) return n;
  }
  return std::min<Index>(count, 2);
}

Signals detrended(Signals signals) {
  for (auto& piece : signals.pieces)
    for (auto* part : {&piece.inputs, &piece.outputs}) *part = detrended(*part);
  return signals;
}

Signals decimated(const Signals& signals, double highest, double room) {
  const double ratio = 2.0 * highest / room / signals.sample_rate;
  if (!(ratio < much_lower)) return signals;
  Signals slower{.sample_rate = 0.0, .pieces = {}, .touched = edge};
  for (const auto& piece : signals.pieces) {
    const Index n = good_length(piece.outputs.rows());
    const Index kept = std::max<Index>(2, std::llround(ratio * static_cast<double>(n) / 2.0) * 2);
    const auto slow = [&](const MatrixXd& samples) {
      return samples.cols() == 0 ? MatrixXd() : resampled(samples, n, kept);
    };
    slower.pieces.push_back({slow(piece.inputs), slow(piece.outputs)});
    slower.sample_rate = signals.sample_rate * static_cast<double>(kept) / static_cast<double>(n);
  }
  return slower;
}

MatrixXcd lines_of(const MatrixXd& samples) {
  const Index n = good_length(samples.rows());
  numerics::RealFft fft(static_cast<int>(n));
  MatrixXcd lines(fft.lines(), samples.cols());
  std::vector<Complex> spectrum(static_cast<std::size_t>(fft.lines()));
  for (Index c = 0; c < samples.cols(); ++c) {
    const VectorXd column = samples.col(c).head(n);
    fft.forward({column.data(), static_cast<std::size_t>(n)}, spectrum);
    for (Index k = 0; k < lines.rows(); ++k)
      lines(k, c) = 2.0 / static_cast<double>(n) * spectrum[static_cast<std::size_t>(k)];
  }
  return lines;
}

}  // namespace hydrapod::identification
