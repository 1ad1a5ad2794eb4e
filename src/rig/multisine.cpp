/// Random-phase multisines, orthogonal over experiments, with phases of low crest factor on
/// request.

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "hydrapod/simulation/gaussian.hpp"
#include "sources.hpp"

namespace hydrapod::rig {

namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
using Complex = std::complex<double>;

/// Smooth sizes for the search; at least 8 samples per cycle of the highest line.
Eigen::Index search_length(long highest) {
  Eigen::Index length = 16;
  while (length < 8 * highest) length *= 2;
  return length;
}

/// Phases whose envelope |Σ A e^{i(ωt + φ)}| has small peaks: the envelope is clipped, the phases
/// of what remains are taken, over and over. A turn of all lines by one angle, which is what makes
/// experiments orthogonal, leaves the envelope as it is.
Eigen::VectorXcd low_crest(const std::vector<long>& cycles, Eigen::VectorXcd lines) {
  const Eigen::Index length = search_length(cycles.back());
  Eigen::FFT<double> fft;
  Eigen::VectorXcd spectrum(length), signal;
  Eigen::VectorXcd best = lines;
  double lowest = std::numeric_limits<double>::infinity();
  constexpr int rounds = 300;
  for (int round = 0; round < rounds; ++round) {
    spectrum.setZero();
    for (std::size_t k = 0; k < cycles.size(); ++k)
      spectrum[cycles[k]] = lines[static_cast<Eigen::Index>(k)];
    fft.inv(signal, spectrum);
    const double peak = signal.cwiseAbs().maxCoeff();
    if (peak < lowest) {
      lowest = peak;
      best = lines;
    }
    const double limit = peak * (0.80 + 0.18 * round / rounds);
    for (Complex& value : signal)
      if (std::abs(value) > limit) value *= limit / std::abs(value);
    fft.fwd(spectrum, signal);
    for (std::size_t k = 0; k < cycles.size(); ++k) {
      Complex& line = lines[static_cast<Eigen::Index>(k)];
      const double size = std::abs(spectrum[cycles[k]]);
      if (size > 0.0) line = std::abs(line) * spectrum[cycles[k]] / size;
    }
  }
  return best;
}

Eigen::Matrix<double, 6, Eigen::Dynamic> one_period(const MultisineLines& lines) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> period(6, lines.samples);
  Eigen::FFT<double> fft;
  Eigen::VectorXcd spectrum(lines.samples), signal;
  for (int i = 0; i < 6; ++i) {
    spectrum.setZero();
    for (std::size_t k = 0; k < lines.cycles.size(); ++k)
      spectrum[lines.cycles[k]] = lines.amplitude(static_cast<Eigen::Index>(k), i);
    fft.inv(signal, spectrum);
    period.row(i) = static_cast<double>(lines.samples) * signal.real().transpose();
  }
  return period;
}

}  // namespace

MultisineLines multisine_lines(const Multisine& spec, double rate, std::uint64_t seed,
                               std::uint64_t stream) {
  MultisineLines lines;
  lines.samples = whole_samples("multisine: period", spec.period, rate);
  const double base = rate / static_cast<double>(lines.samples);
  constexpr double slack = 1e-6;  // bands that end on a line include it
  const long first = std::max(1L, static_cast<long>(std::ceil(spec.from / base - slack)));
  const long last = static_cast<long>(std::floor(spec.to / base + slack));
  require(last >= first, "multisine: period", spec.period,
          "one so long that a multiple of 1/period lies in the band");
  for (long k = first; k <= last && 2 * k < lines.samples; ++k) lines.cycles.push_back(k);
  const auto count = static_cast<Eigen::Index>(lines.cycles.size());
  Eigen::VectorXd shape(count);
  for (Eigen::Index k = 0; k < count; ++k)
    shape[k] = std::pow(10.0, spec.slope / 20.0 *
                                  std::log2(static_cast<double>(lines.cycles[k]) /
                                            static_cast<double>(lines.cycles.front())));
  shape *= std::numbers::sqrt2 / shape.norm();
  lines.amplitude.resize(count, 6);
  for (int i = 0; i < 6; ++i) {
    simulation::Gaussian random(seed, stream + static_cast<std::uint64_t>(i));
    Eigen::VectorXcd line(count);
    for (Eigen::Index k = 0; k < count; ++k)
      line[k] = std::polar(shape[k], two_pi * random.uniform());
    if (spec.low_crest && spec.rms[i] != 0.0) line = low_crest(lines.cycles, line);
    const double turn = two_pi / 6.0 * i * spec.experiment.value_or(0);
    lines.amplitude.col(i) = spec.rms[i] * std::polar(1.0, turn) * line;
  }
  return lines;
}

std::unique_ptr<SignalSource> make_source(const Multisine& spec, const SourceContext& context) {
  require_levels("multisine", spec.rms);
  require_band("multisine", spec.from, spec.to, context.rate, false);
  require(std::abs(spec.slope) <= 24.0, "multisine: slope", spec.slope, "−24 … 24 dB/octave");
  require(!spec.experiment || (*spec.experiment >= 0 && *spec.experiment <= 5),
          "multisine: experiment", spec.experiment.value_or(0) + 1, "1 … 6");
  return std::make_unique<PeriodicSource>(
      one_period(multisine_lines(spec, context.rate, context.seed, context.stream)));
}

}  // namespace hydrapod::rig
