#include "window_effect.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "fit_covariance.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "leakage.hpp"
#include "line_weights.hpp"
#include "names.hpp"
#include "prune.hpp"
#include "weak_modes.hpp"

namespace hydrapod::identification {

namespace {

/// Distance of lines that are multiples of it [Hz]; 0: they are not.
double line_distance(const std::vector<double>& frequency, const WindowOptions& options) {
  std::vector<double> apart;
  for (std::size_t k = 1; k < frequency.size(); ++k)
    apart.push_back(frequency[k] - frequency[k - 1]);
  const double usual = numerics::upper_median(apart);
  if (!(usual > 0.0)) return 0.0;
  double count =
      0.0;  // of distances between the first and the last line; some lines may be left out
  for (const double one : apart) count += std::round(one / usual);
  const double step = (frequency.back() - frequency.front()) / count;
  const bool multiples = std::ranges::all_of(frequency, [&](double f) {
    return std::abs(f / step - std::round(f / step)) < options.rounded;
  });
  const bool filled = static_cast<double>(apart.size()) >= options.filled * count;
  return multiples && filled ? step : 0.0;
}

/// Of the taper of lines up to the last one; a power of two.
double sample_count(double last, double step) {
  constexpr double finer = 4.0;  // samples per period of the highest line
  return std::exp2(std::ceil(std::log2(finer * last / step)));
}

/// |W|² by its sum, at this many lines from the middle.
double let_in(const VectorXd& taper, double lines) {
  const auto n = static_cast<double>(taper.size());
  double sum = 1.0;
  for (Index t = 1; t < taper.size(); ++t)
    sum += 2.0 * taper[t] * std::cos(two_pi * lines * static_cast<double>(t) / n);
  return std::max(0.0, sum) / n;
}

constexpr Index per_line = 4;  // points of the integral

/// Of the integral to either side, in points. A Hann window lets in 1e-8 from beyond 8 lines, a
/// rectangular one, whose taper is 1 − |τ|/n, decays as the square of the distance: of it as many
/// lines are taken as there are, or as some billion operations allow.
Index reach_of(const FrequencyResponses& r) {
  constexpr double operations = 2e9;
  constexpr Index narrow = 8;
  if (!(r.taper[r.taper.size() / 2] > 0.4)) return narrow * per_line;
  const auto lines = static_cast<Index>(r.lines());
  const double outputs = static_cast<double>(r.H[0].rows()),
               each = outputs * outputs * static_cast<double>(r.H[0].cols() * lines);
  const auto allowed = static_cast<Index>(operations / (2.0 * per_line * each));
  return std::clamp(lines, narrow, std::max(narrow, allowed)) * per_line;
}

/// The model without window at every `per_line`-th part of a line, from `reach` below the first
/// line to `reach` above the last one.
class FineResponses {
 public:
  FineResponses(const ModalModel& model, const FrequencyResponses& r, Index reach)
      : distance_(r.sample_rate / static_cast<double>(r.taper.size()) / per_line),
        first_(number(r.frequency.front()) - reach) {
    for (Index k = first_; k <= number(r.frequency.back()) + reach; ++k) {
      const double f = distance_ * static_cast<double>(std::max<Index>(1, std::abs(k)));
      values_.push_back(synthesised(model, f));
      if (k < 0) values_.back() = values_.back().conjugate().eval();
    }
  }
  [[nodiscard]] const MatrixXcd& beside(double frequency, Index points) const {
    return values_[static_cast<std::size_t>(number(frequency) + points - first_)];
  }

 private:
  [[nodiscard]] Index number(double f) const { return std::llround(f / distance_); }

  double distance_;
  Index first_;
  std::vector<MatrixXcd> values_{};
};

/// K E[e_oi e*_pi]/Q_ii per line, outputs × outputs.
std::vector<MatrixXcd> leakage(const FrequencyResponses& r, const data::PerLine<MatrixXcd>& rest,
                               const ModalModel& model) {
  const Index reach = reach_of(r);
  VectorXd weight(2 * reach + 1);
  for (Index j = -reach; j <= reach; ++j)
    weight[j + reach] = let_in(r.taper, static_cast<double>(j) / per_line);
  weight /= weight.sum();
  const VectorXcd per_input = r.input_factor[0].diagonal().cwiseInverse();
  const FineResponses fine(model, r, reach);
  std::vector<MatrixXcd> leak(r.lines(), MatrixXcd::Zero(r.H[0].rows(), r.H[0].rows()));
  for (std::size_t k = 0; k < r.lines(); ++k) {
    const MatrixXcd mean = r.H[k] - rest[k];
    for (Index j = -reach; j <= reach; ++j) {
      const MatrixXcd beside = fine.beside(r.frequency[k], j) - mean;
      leak[k] += weight[j + reach] * (beside * per_input.asDiagonal() * beside.adjoint());
    }
  }
  return leak;
}

/// E|x|² of complex normal numbers with these |x|².
double mean_by_median(std::vector<double> squares) {
  return numerics::upper_median(std::move(squares)) / std::numbers::ln2;
}

/// 1/K: mean square of the residual over `leak` at the tenth of the lines that have most of it.
double per_block(const FrequencyResponses& r, const data::PerLine<MatrixXcd>& rest,
                 const std::vector<MatrixXcd>& leak) {
  std::vector<double> ratios;
  for (Index o = 0; o < r.H[0].rows(); ++o) {
    VectorXd by_noise(std::ssize(leak));
    for (Index k = 0; k < by_noise.size(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      by_noise[k] = leak[at](o, o).real() / r.noise[at](o, o).real();
    }
    for (const auto k : largest_tenth(by_noise))
      for (Index i = 0; i < r.H[0].cols(); ++i)
        ratios.push_back(std::norm(rest[k](o, i)) /
                         (r.input_factor[k](i, i).real() * leak[k](o, o).real()));
  }
  return mean_by_median(std::move(ratios));
}

}  // namespace

bool may_be_windowed(const FrequencyResponses& r, const WindowOptions& options) {
  if (r.whole != nullptr || !r.excitation.empty() || r.shift != 0.0 || r.taper.size() > 0 ||
      r.lines() < 2)
    return false;
  const double step = line_distance(r.frequency, options);
  return step > 0.0 && sample_count(r.frequency.back(), step) <= options.longest;
}

FrequencyResponses with_window(FrequencyResponses r, Window window, const WindowOptions& options) {
  const double step = line_distance(r.frequency, options);
  for (double& f : r.frequency) f = std::round(f / step) * step;
  const auto n = static_cast<int>(sample_count(r.frequency.back(), step));
  const auto samples = window_samples(window, n);
  constexpr long many = 64;  // blocks: their number hardly changes the covariance
  r.taper = lag_taper(samples);
  r.sample_rate = n * step;
  const auto statistics = average_statistics(samples, n / 2, many);
  r.line_covariance.assign(statistics.line_covariance.begin(), statistics.line_covariance.end());
  r.leakage = {statistics.leakage_rate * std::pow(r.sample_rate, 2), statistics.leakage_covariance,
               statistics.leakage_relation};
  return r;
}

void add_leakage(FrequencyResponses& r, const data::PerLine<MatrixXcd>& rest,
                 const ModalModel& model) {
  const auto leak = leakage(r, rest, model);
  const double factor = per_block(r, rest, leak);
  r.leakage.rate *= factor;
  for (std::size_t k = 0; k < r.lines(); ++k) {
    // what is rough along frequency holds a part of it already
    const VectorXd rough = r.noise[k].diagonal().real();
    r.noise[k] = factor * leak[k];
    r.noise[k].diagonal() = rough.cwiseMax(r.noise[k].diagonal().real()).cast<Complex>();
  }
}

namespace {

/// Mean of ln σ² over responses and lines; errors are scaled so that they explain the residual.
double mean_log_variance(const FrequencyResponses& band, const ModalModel& model, bool taper) {
  const auto rest = residual_of(band, model, taper);
  double sum = 0.0, logs = 0.0, count = 0.0;
  for (std::size_t k = 0; k < band.lines(); ++k)
    for (Index o = 0; o < band.H[k].rows(); ++o)
      for (Index i = 0; i < band.H[k].cols(); ++i) {
        const double variance = band.variance(k, o, i);
        sum += std::norm(rest.H[k](o, i)) / variance;
        logs += std::log(variance);
        ++count;
      }
  return logs / count + std::log(std::max(sum / count, 1e-300));
}

/// Of all poles and residues.
double parameter_count(const ModalModel& model) {
  double count = 0.0;
  for (const auto& mode : model.modes)
    count += 2.0 * static_cast<double>(mode.shape.size() + mode.participation.size());
  return count;
}

}  // namespace

bool widens(const Identification& windowed, const IdentifyOptions& options) {
  auto fit = options.fit;
  fit.taper = false;
  fit.deviations = Deviations::none;
  const auto without = fit_modes(windowed.responses, estimates(windowed.model), fit);
  return windowed.model.error < options.window.clearly * without.error;
}

double evidence(const Identification& a, const Identification& b, const IdentifyOptions& options) {
  const double from = std::max(a.from, b.from), to = std::min(a.to, b.to);
  const auto band_a = within(a.responses, from, to), band_b = within(b.responses, from, to);
  const double together = std::max({1.0, lines_in_step(band_a), lines_in_step(band_b)});
  const double n = 2.0 * static_cast<double>(band_a.lines()) * numbers_per_line(band_a) / together;
  return n * (mean_log_variance(band_b, b.model, options.fit.taper) -
              mean_log_variance(band_a, a.model, options.fit.taper)) +
         (parameter_count(b.model) - parameter_count(a.model)) * std::log(n);
}

}  // namespace hydrapod::identification
