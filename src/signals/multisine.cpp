/// Random-phase multisines, orthogonal over experiments, with phases of low crest factor on
/// request.

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>

#include "hydrapod/base/units.hpp"
#include "hydrapod/numerics/fft.hpp"
#include "sources.hpp"

namespace hydrapod::signals {

namespace {

using base::two_pi;
using Complex = std::complex<double>;

/// Smooth sizes for the search; at least 8 samples per cycle of the highest line.
std::size_t search_length(long highest) {
  std::size_t length = 16;
  while (length < 8 * static_cast<std::size_t>(highest)) length *= 2;
  return length;
}

/// Phases whose envelope |Σ A e^{i(ωt + φ)}| has small peaks: the envelope is clipped, the phases
/// of what remains are taken, over and over. A turn of all lines by one angle, which is what makes
/// experiments orthogonal, leaves the envelope as it is.
Eigen::VectorXcd low_crest(const std::vector<long>& cycles, Eigen::VectorXcd lines) {
  std::vector<Complex> spectrum(search_length(cycles.back()));
  Eigen::VectorXcd best = lines;
  double lowest = std::numeric_limits<double>::infinity();
  constexpr int rounds = 300;
  for (int round = 0; round < rounds; ++round) {
    std::ranges::fill(spectrum, 0.0);
    for (std::size_t k = 0; k < cycles.size(); ++k)
      spectrum[cycles[k]] = lines[static_cast<Eigen::Index>(k)];
    auto signal = numerics::inverse_complex_fft(spectrum);
    double peak = 0.0;
    for (const Complex& value : signal) peak = std::max(peak, std::abs(value));
    if (peak < lowest) {
      lowest = peak;
      best = lines;
    }
    const double limit = peak * (0.80 + 0.18 * round / rounds);
    for (Complex& value : signal)
      if (std::abs(value) > limit) value *= limit / std::abs(value);
    spectrum = numerics::complex_fft(signal);
    for (std::size_t k = 0; k < cycles.size(); ++k) {
      Complex& line = lines[static_cast<Eigen::Index>(k)];
      const double size = std::abs(spectrum[cycles[k]]);
      if (size > 0.0) line = std::abs(line) * spectrum[cycles[k]] / size;
    }
  }
  return best;
}

/// Lines of one period: cosine amplitudes and phases, U = A e^{iφ} with Σ A²/2 = size².
struct Lines {
  long samples{};  ///< of the period
  std::vector<long> cycles{};
  Eigen::MatrixXcd amplitude{};  ///< row per line, column per direction
};

Lines multisine_lines(const Multisine& spec, const Context& context) {
  Lines lines{.samples = whole_samples(spec.period, context.rate)};
  const auto [first, last] = line_range(spec, context.rate);
  for (long k = first; k <= last; ++k) lines.cycles.push_back(k);
  const auto count = static_cast<Eigen::Index>(lines.cycles.size());
  Eigen::VectorXd shape(count);
  for (Eigen::Index k = 0; k < count; ++k)
    shape[k] = std::pow(10.0, spec.slope / 20.0 *
                                  std::log2(static_cast<double>(lines.cycles[k]) /
                                            static_cast<double>(lines.cycles.front())));
  shape *= std::numbers::sqrt2 / shape.norm();
  lines.amplitude.resize(count, 6);
  for (int i = 0; i < 6; ++i) {
    auto random = context.random(static_cast<std::size_t>(i));
    Eigen::VectorXcd line(count);
    for (Eigen::Index k = 0; k < count; ++k)
      line[k] = std::polar(shape[k], two_pi * random.uniform());
    if (spec.low_crest && context.size[i] != 0.0) line = low_crest(lines.cycles, line);
    const double turn = two_pi / 6.0 * i * (spec.experiment.value_or(1) - 1);
    lines.amplitude.col(i) = context.size[i] * std::polar(1.0, turn) * line;
  }
  return lines;
}

/// Σ U e^{2πi·cycles·k/n}, k = 0 … n − 1, the real part.
class Synthesis {
 public:
  explicit Synthesis(const Lines& lines) : lines_(lines) {
    // A transform takes as long as the sum of the prime factors of its length; where that is longer
    // than the sum over the lines, the sum is taken, from a table of the circle.
    const long slow = std::max(1000L, static_cast<long>(lines.cycles.size()));
    if (largest_prime_factor(lines.samples) < slow) return;
    circle_.resize(lines.samples);
    for (long k = 0; k < lines.samples; ++k)
      circle_[k] =
          std::polar(1.0, two_pi * static_cast<double>(k) / static_cast<double>(lines.samples));
  }

  Eigen::VectorXd operator()(const Eigen::VectorXcd& amplitude) {
    const auto count = static_cast<Eigen::Index>(lines_.cycles.size());
    if (circle_.size() > 0) {
      Eigen::VectorXd sum = Eigen::VectorXd::Zero(lines_.samples);
      for (Eigen::Index line = 0; line < count; ++line)
        for (long k = 0; k < lines_.samples; ++k)
          sum[k] += (amplitude[line] * circle_[lines_.cycles[line] * k % lines_.samples]).real();
      return sum;
    }
    std::vector<Complex> spectrum(static_cast<std::size_t>(lines_.samples));
    for (Eigen::Index line = 0; line < count; ++line)
      spectrum[lines_.cycles[line]] = amplitude[line];
    const auto signal = numerics::inverse_complex_fft(spectrum);
    return Eigen::VectorXcd::Map(signal.data(), lines_.samples).real();
  }

 private:
  const Lines& lines_;
  Eigen::VectorXcd circle_{};
};

}  // namespace

long largest_prime_factor(long number) {
  for (long factor = 2; factor * factor <= number; ++factor)
    while (number % factor == 0 && number > factor) number /= factor;
  return number;
}

Source make_source(const Multisine& multisine, const Context& context) {
  const Lines lines = multisine_lines(multisine, context);
  Eigen::VectorXcd rates(lines.amplitude.rows());  // iω
  for (Eigen::Index k = 0; k < rates.size(); ++k)
    rates[k] = Complex(0.0, two_pi * static_cast<double>(lines.cycles[k]) * context.rate /
                                static_cast<double>(lines.samples));
  Synthesis synthesis(lines);
  // shared: sources are copied, and a period may be large
  const auto samples = std::make_shared<std::vector<Sample>>(lines.samples);
  auto& period = *samples;
  for (int i = 0; i < 6; ++i) {
    if (context.size[i] == 0.0) continue;
    const Eigen::VectorXd value = synthesis(lines.amplitude.col(i));
    const Eigen::VectorXd rate = synthesis(lines.amplitude.col(i).cwiseProduct(rates));
    for (Eigen::Index k = 0; k < value.size(); ++k) {
      period[k].value[i] = value[k];
      period[k].rate[i] = rate[k];
    }
  }
  return [period = std::shared_ptr<const std::vector<Sample>>(samples)](long k) {
    return (*period)[static_cast<std::size_t>(k) % period->size()];
  };
}

}  // namespace hydrapod::signals
