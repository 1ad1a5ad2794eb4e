#include "assumed_errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "hydrapod/numerics/statistics.hpp"
#include "line_weights.hpp"

namespace hydrapod::identification {

namespace {

/// E|Σ c_a e_a|² of errors of deviation 1 at lines `stride` apart; `weights`: c times deviations.
double variance_of(const std::array<double, 5>& weights, Index stride,
                   const std::vector<Complex>& line_covariance) {
  double sum = 0.0;
  for (std::size_t a = 0; a < weights.size(); ++a)
    for (std::size_t b = 0; b < weights.size(); ++b) {
      const std::size_t apart = (a > b ? a - b : b - a) * static_cast<std::size_t>(stride);
      if (apart == 0)
        sum += weights[a] * weights[b];
      else if (apart < line_covariance.size())
        sum += weights[a] * weights[b] * line_covariance[apart].real();
    }
  return sum;
}

/// A response or what is left of it, and what is known of its errors.
struct RoughValues {
  VectorXcd values{};
  VectorXd shape{};  ///< deviations in proportion
};

/// |d_k|² by its variance for errors of deviation `shape`, at the lines that have two neighbours on
/// either side, `stride` apart.
std::vector<double> rough_squares(const RoughValues& of, const std::vector<double>& frequency,
                                  Index stride, const std::vector<Complex>& line_covariance) {
  const auto& values = of.values;
  std::vector<double> squares;
  for (Index k = 2 * stride; k + 2 * stride < values.size(); ++k) {
    const std::array<Index, 4> at{k - 2 * stride, k - stride, k + stride, k + 2 * stride};
    const auto f = [&](Index line) { return frequency[static_cast<std::size_t>(line)]; };
    Complex rest = values[k];
    std::array<double, 5> weights{0.0, 0.0, of.shape[k], 0.0, 0.0};  // of k − 2 … k + 2 strides
    for (const Index j : at) {
      double weight = 1.0;
      for (const Index m : at)
        if (m != j) weight *= (f(k) - f(m)) / (f(j) - f(m));
      rest -= weight * values[j];
      weights[static_cast<std::size_t>((j - k) / stride + 2)] = -weight * of.shape[j];
    }
    squares.push_back(std::norm(rest) / variance_of(weights, stride, line_covariance));
  }
  return squares;
}

/// Running median of squares of complex normal numbers, as their variance, for every line.
VectorXd rough_variance(const RoughValues& of, const std::vector<double>& frequency, Index stride,
                        Index reach, const std::vector<Complex>& line_covariance) {
  const auto squares = rough_squares(of, frequency, stride, line_covariance);
  const auto count = static_cast<Index>(squares.size());
  VectorXd variance = VectorXd::Zero(of.values.size());
  if (count == 0) return variance;
  for (Index k = 0; k < of.values.size(); ++k) {
    const Index centre = std::clamp<Index>(k - 2 * stride, 0, count - 1);
    const Index from = std::clamp<Index>(centre - reach, 0, std::max<Index>(0, count - 2 * reach)),
                to = std::min(count, std::max(centre + reach, from + 2 * reach) + 1);
    const double median = numerics::upper_median({squares.begin() + from, squares.begin() + to});
    variance[k] = of.shape[k] * of.shape[k] * median / std::numbers::ln2;
  }
  return variance;
}

/// E[e_k e*_{k+d}]/E|e_k|² of all entries of a residual, lines apart where it is no noise.
void add_line_covariance(FrequencyResponses& r, const data::PerLine<MatrixXcd>& rest,
                         const AssumedErrorOptions& options) {
  r.line_covariance = {1.0};
  for (std::size_t d = 1; d <= static_cast<std::size_t>(options.lags); ++d) {
    double together = 0.0, alone = 0.0, count = 0.0;
    for (std::size_t k = 0; k + d < r.lines(); ++k)
      for (Index o = 0; o < rest[k].rows(); ++o)
        for (Index i = 0; i < rest[k].cols(); ++i) {
          const Complex a = rest[k](o, i) / std::sqrt(r.variance(k, o, i)),
                        b = rest[k + d](o, i) / std::sqrt(r.variance(k + d, o, i));
          if (std::max(std::norm(a), std::norm(b)) > options.outlier) continue;
          together += (std::conj(a) * b).real();
          alone += 0.5 * (std::norm(a) + std::norm(b));
          ++count;
        }
    if (!(alone > options.least_noise * count) ||
        together < options.by_chance / std::sqrt(2.0 * count) * alone)
      return;
    r.line_covariance.emplace_back(together / alone);
  }
}

/// So it is where several hits meet in a block, see hits.hpp.
bool knows_input(const FrequencyResponses& r) {
  return r.shift > 0.0 && r.estimator == Estimator::h1 && r.input_density.size() == r.lines();
}

/// Noise of outputs leaves errors in proportion to 1/|U|, where that is known.
VectorXd shape_of_errors(const FrequencyResponses& r, Index input) {
  VectorXd shape = VectorXd::Ones(static_cast<Index>(r.lines()));
  if (!knows_input(r)) return shape;
  for (std::size_t k = 0; k < r.lines(); ++k) {
    const double density = r.input_density[k][input];
    if (!(density > 0.0)) return VectorXd::Ones(shape.size());
    shape[static_cast<Index>(k)] = 1.0 / std::sqrt(density);
  }
  return shape / shape.mean();
}

}  // namespace

FrequencyResponses with_assumed_errors(FrequencyResponses r, const data::PerLine<MatrixXcd>& rest,
                                       bool fitted, const AssumedErrorOptions& options) {
  const auto lines = static_cast<Index>(r.lines());
  const Index outputs = r.H[0].rows(), inputs = r.H[0].cols();
  // forces of several hits that meet in a block have errors of their own, which turn from line to
  // line in proportion to the response
  constexpr double several = 3.0;
  const double floor = options.floor * (knows_input(r) ? several : 1.0);
  std::vector<MatrixXd> variance(r.lines(), MatrixXd(outputs, inputs));
  for (Index o = 0; o < outputs; ++o)
    for (Index i = 0; i < inputs; ++i) {
      RoughValues of{.values = VectorXcd(lines), .shape = shape_of_errors(r, i)};
      VectorXd size(lines);
      for (Index k = 0; k < lines; ++k) {
        of.values[k] = rest[static_cast<std::size_t>(k)](o, i);
        size[k] = std::norm(r.H[static_cast<std::size_t>(k)](o, i));
      }
      VectorXd rough = rough_variance(of, r.frequency, 1, options.reach, options.line_covariance);
      if (fitted) {
        const VectorXd apart =
            rough_variance(of, r.frequency, options.apart, options.reach, options.line_covariance);
        if (apart.mean() > options.correlated * rough.mean()) rough = apart;
      }
      size = floor * floor * (running_mean(size, 2).array() + options.floor * size.mean());
      for (Index k = 0; k < lines; ++k)
        variance[static_cast<std::size_t>(k)](o, i) = std::max(1e-300, rough[k] + size[k]);
    }
  VectorXd factor = VectorXd::Zero(inputs);
  for (const auto& V : variance)
    factor += (V.array().colwise() / V.rowwise().mean().array()).colwise().mean().matrix() /
              static_cast<double>(lines);
  r.noise.clear();
  r.input_factor.assign(r.lines(), factor.cast<Complex>().asDiagonal());
  for (const auto& V : variance) {
    const VectorXd noise =
        (V.array().rowwise() / factor.transpose().array()).rowwise().mean().matrix();
    r.noise.emplace_back(noise.cast<Complex>().asDiagonal());
  }
  if (!options.line_covariance.empty())
    r.line_covariance = options.line_covariance;
  else if (fitted)
    add_line_covariance(r, rest, options);
  return r;
}

void remove_errors(FrequencyResponses& r) {
  r.noise.clear();
  r.input_factor.clear();
  r.line_covariance = {1.0};
}

}  // namespace hydrapod::identification
