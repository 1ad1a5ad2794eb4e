#include "hits.hpp"

#include <algorithm>
#include <cmath>

#include "hydrapod/numerics/fft.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

constexpr Index every = 2;  // lines in between hold little that these do not

Index reach_of(Index samples, const HitOptions& options) {
  return std::max<Index>(4, std::lround(options.reach * static_cast<double>(samples)));
}

double median_of(const VectorXd& x) { return numerics::upper_median({x.begin(), x.end()}); }

/// The force alone: nothing beside the hit. Noise of the input in there is a factor of all
/// responses that changes within 1/length of frequency: the shorter, the less it looks like a mode.
VectorXd force(const VectorXd& input, Index hit, const HitOptions& options) {
  const Index reach = reach_of(input.size(), options);
  Index from = std::max<Index>(0, hit - reach), to = std::min(input.size() - 1, hit + reach);
  const Eigen::ArrayXd size = (input.array() - median_of(input)).abs();
  const double least =
      std::max(options.of_noise * median_of(size.matrix()), options.of_peak * size[hit]);
  constexpr Index margin = 2;
  while (from + margin < hit && size[from + margin] < least) ++from;
  while (to - margin > hit && size[to - margin] < least) --to;
  VectorXd x = VectorXd::Zero(input.size());
  x.segment(from, to - from + 1) = input.segment(from, to - from + 1).array() - median_of(input);
  return x;
}

/// Less what it was before the hit, or its mean where nothing was recorded before.
VectorXd ringing(const VectorXd& output, Index hit, const HitOptions& options) {
  const Index before = hit - reach_of(output.size(), options);
  constexpr Index enough = 16;
  const double rest = before >= enough ? output.head(before).mean() : output.mean();
  return output.array() - rest;
}

/// Transforms of hits of one length.
class Transform {
 public:
  Transform(Index samples, double decay_per_sample)
      : window_(samples), fft_(static_cast<int>(samples)) {
    for (Index k = 0; k < samples; ++k)
      window_[k] = std::exp(-decay_per_sample * static_cast<double>(k));
  }
  VectorXcd of(const VectorXd& signal) {
    const VectorXd x = signal.cwiseProduct(window_);
    VectorXcd lines(fft_.lines());
    fft_.forward({x.data(), static_cast<std::size_t>(x.size())},
                 {lines.data(), static_cast<std::size_t>(lines.size())});
    return lines;
  }

 private:
  VectorXd window_;
  numerics::RealFft fft_;
};

/// Σ |U|² and Σ Y U* over hits, with a decay of their samples.
struct Sums {
  Transform transform;
  VectorXd power;
  MatrixXcd cross;
  Sums(Index samples, Index outputs, double decay_per_sample)
      : transform(samples, decay_per_sample),
        power(VectorXd::Zero(samples / 2 + 1)),
        cross(MatrixXcd::Zero(samples / 2 + 1, outputs)) {}
  void add(const VectorXd& input, const MatrixXd& outputs) {
    const VectorXcd U = transform.of(input);
    power += U.cwiseAbs2();
    for (Index o = 0; o < outputs.cols(); ++o)
      cross.col(o) += transform.of(outputs.col(o)).cwiseProduct(U.conjugate());
  }
  [[nodiscard]] MatrixXcd response(Index line) const {
    return cross.row(line).transpose() / power[line];
  }
};

/// Lines from 1 on that the hits excite.
Index excited_lines(const VectorXd& power, double weakest) {
  Index largest = 0;
  power.tail(power.size() - 1).maxCoeff(&largest);
  Index to = largest + 1;
  while (to + 1 < power.size() && power[to + 1] >= weakest * power[largest + 1]) ++to;
  return to;
}

}  // namespace

std::optional<Index> hit_in(const VectorXd& input, const HitOptions& options) {
  if (input.size() < options.fewest || !input.allFinite()) return {};
  const VectorXd x = input.array() - median_of(input);
  Index hit = 0;
  if (!(x.cwiseAbs().maxCoeff(&hit) > 0.0)) return {};
  const VectorXd near = force(input, hit, options);
  return near.squaredNorm() >= options.energy * x.squaredNorm() ? std::optional(hit) : std::nullopt;
}

std::optional<FrequencyResponses> responses_of_hits(const std::vector<data::Samples>& records,
                                                    const ChannelChoice& choice, double sample_rate,
                                                    const HitOptions& options) {
  if (records.empty() || choice.inputs.size() != 1) return {};
  Index samples = records[0].rows();
  std::vector<Index> hits;
  for (const auto& record : records) {
    const auto hit =
        record.allFinite() ? hit_in(record.col(choice.inputs[0]), options) : std::optional<Index>{};
    if (!hit) return {};
    hits.push_back(*hit);
    samples = std::min(samples, record.rows());
  }
  samples -= samples % 2;
  const Index latest = *std::ranges::max_element(hits);
  if (samples - latest < options.fewest / 2) return {};
  const double after = static_cast<double>(samples - latest) / sample_rate;
  const double a = options.decay / after;
  const auto outputs = static_cast<Index>(choice.outputs.size());
  Sums damped(samples, outputs, a / sample_rate), plain(samples, outputs, 0.0);
  for (std::size_t k = 0; k < records.size(); ++k) {
    const data::Samples part = records[k].topRows(samples);
    const VectorXd u = force(part.col(choice.inputs[0]), hits[k], options);
    MatrixXd y(samples, outputs);
    for (Index o = 0; o < outputs; ++o)
      y.col(o) = ringing(part.col(choice.outputs[static_cast<std::size_t>(o)]), hits[k], options);
    damped.add(u, y);
    plain.add(u, y);
  }
  FrequencyResponses r{.shift = a,
                       .sample_rate = sample_rate,
                       .estimator = Estimator::h1,
                       .averages = static_cast<double>(records.size())};
  const Index to = std::min(excited_lines(damped.power, options.weakest),
                            excited_lines(plain.power, options.weakest));
  // white noise under the window: E[e_k e*_{k+d}] is the transform of e^(−2at)
  const Complex turn(0.0, two_pi * sample_rate / static_cast<double>(samples));
  r.line_covariance.clear();
  for (Index d = 0; d < options.most_covariances; ++d)
    r.line_covariance.push_back(2.0 * a / (2.0 * a + static_cast<double>(every * d) * turn));
  for (Index k = every; k <= to; k += every) {
    r.frequency.push_back(static_cast<double>(k) * sample_rate / static_cast<double>(samples));
    r.H.push_back(damped.response(k));
    r.on_axis.push_back(plain.response(k));
  }
  return r;
}

}  // namespace hydrapod::identification
