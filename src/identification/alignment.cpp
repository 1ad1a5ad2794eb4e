#include "alignment.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "names.hpp"

namespace hydrapod::identification {

namespace {

/// Which responses are above their noise, at each line.
class Clear {
 public:
  Clear(const FrequencyResponses& r, double clear)
      : outputs_(r.H.front().rows()), inputs_(r.H.front().cols()) {
    clear_.reserve(r.lines() * static_cast<std::size_t>(outputs_ * inputs_));
    for (std::size_t k = 0; k < r.lines(); ++k)
      for (Index o = 0; o < outputs_; ++o)
        for (Index i = 0; i < inputs_; ++i) {
          const double power = std::norm(r.H[k](o, i));
          clear_.push_back(power > 0.0 && (!r.has_errors() || power > clear * r.variance(k, o, i)));
        }
  }
  [[nodiscard]] bool operator()(std::size_t line, Index output, Index input) const {
    return clear_[(line * static_cast<std::size_t>(outputs_) + static_cast<std::size_t>(output)) *
                      static_cast<std::size_t>(inputs_) +
                  static_cast<std::size_t>(input)] != 0;
  }
  /// The output that has the most of them.
  [[nodiscard]] Index clearest() const {
    std::vector<std::size_t> counts(static_cast<std::size_t>(outputs_));
    for (std::size_t k = 0; k < clear_.size(); ++k)
      counts[k / static_cast<std::size_t>(inputs_) % counts.size()] += clear_[k] != 0;
    return std::ranges::max_element(counts) - counts.begin();
  }

 private:
  Index outputs_, inputs_;
  std::vector<char> clear_{};
};

/// Of an output and a reference, at lines where both are clear.
struct Comparison {
  std::vector<double> omega{};
  std::vector<Complex> z{};
  double size{};

  Comparison(const FrequencyResponses& r, const Clear& is_clear, Index output, Index reference) {
    for (std::size_t k = 0; k < r.lines(); ++k) {
      Complex sum = 0.0;
      for (Index i = 0; i < r.H[k].cols(); ++i) {
        if (!is_clear(k, output, i) || !is_clear(k, reference, i)) continue;
        const Complex product = r.H[k](output, i) * std::conj(r.H[k](reference, i));
        sum += product * product / std::norm(product);
      }
      if (sum == 0.0) continue;
      omega.push_back(two_pi * r.frequency[k]);
      z.push_back(sum);
      size += std::abs(sum);
    }
  }
  [[nodiscard]] double agreement(double delay) const {
    Complex sum = 0.0;
    for (std::size_t k = 0; k < z.size(); ++k)
      sum += z[k] * std::polar(1.0, 2.0 * omega[k] * delay);
    return std::abs(sum) / size;
  }
};

/// Delay of an output against the reference [s]; none: it cannot be told.
std::optional<double> delay_of(const Comparison& pair, double sample_rate,
                               const AlignmentOptions& options) {
  if (pair.z.size() < options.least_lines) return {};
  if (pair.agreement(0.0) >= options.aligned) return 0.0;
  const double step = options.step / sample_rate;
  const auto steps = static_cast<int>(options.longest / options.step);
  double best = 0.0, most = 0.0;
  for (int k = -steps; k <= steps; ++k)
    if (const double agreement = pair.agreement(k * step); agreement > most) {
      most = agreement;
      best = k * step;
    }
  if (!(most > options.late) || std::abs(best) > (steps - 1) * step) return {};
  const double below = pair.agreement(best - step), above = pair.agreement(best + step),
               bend = below - 2.0 * most + above;
  return bend < 0.0 ? best + 0.5 * step * (below - above) / bend : best;
}

/// The responses without these delays.
void advance(const VectorXd& delays, FrequencyResponses& r) {
  for (std::size_t k = 0; k < r.lines(); ++k) {
    const VectorXcd factor =
        (delays.cast<Complex>() * Complex(r.shift, two_pi * r.frequency[k])).array().exp();
    r.H[k] = (factor.asDiagonal() * r.H[k]).eval();
    if (!r.on_axis.empty()) {
      const VectorXcd turn =
          (delays.cast<Complex>() * Complex(0.0, two_pi * r.frequency[k])).array().exp();
      r.on_axis[k] = (turn.asDiagonal() * r.on_axis[k]).eval();
    }
    if (!r.noise.empty())
      r.noise[k] = (factor.asDiagonal() * r.noise[k] * factor.conjugate().asDiagonal()).eval();
  }
}

}  // namespace

void align_outputs(FrequencyResponses& r, const AlignmentOptions& options) {
  if (r.whole || r.outputs.size() < 2 || r.lines() == 0 || !(r.sample_rate > 0.0)) return;
  const Clear is_clear(r, options.clear);
  const Index reference = is_clear.clearest();
  // none: it cannot be told, and the output stays as it is
  std::vector<std::optional<double>> found(r.outputs.size());
  double first = 0.0;
  auto earliest = static_cast<std::size_t>(reference);
  for (std::size_t o = 0; o < found.size(); ++o) {
    const auto own = static_cast<Index>(o);
    found[o] = own == reference
                   ? std::optional(0.0)
                   : delay_of(Comparison(r, is_clear, own, reference), r.sample_rate, options);
    if (found[o].value_or(0.0) >= first) continue;
    first = *found[o];
    earliest = o;
  }
  VectorXd delays = VectorXd::Zero(std::ssize(r.outputs));
  for (std::size_t o = 0; o < found.size(); ++o)
    if (found[o] && (*found[o] - first) * r.sample_rate >= options.least)
      delays[static_cast<Index>(o)] = *found[o] - first;
  if (delays.isZero(0.0)) return;
  advance(delays, r);
  for (Index o = 0; o < delays.size(); ++o)
    if (delays[o] > 0.0)
      r.warnings.push_back({.kind = data::ResponseWarning::Kind::delayed,
                            .channel = r.outputs[static_cast<std::size_t>(o)].name,
                            .other = r.outputs[earliest].name,
                            .value = delays[o]});
}

}  // namespace hydrapod::identification
