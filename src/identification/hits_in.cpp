#include <Eigen/Cholesky>
#include <algorithm>
#include <bit>
#include <boost/math/tools/minima.hpp>
#include <cmath>

#include "hits.hpp"
#include "hydrapod/numerics/fft.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

double median_of(const VectorXd& x) { return numerics::upper_median({x.begin(), x.end()}); }

std::vector<Hit> only_hits(const std::vector<Hit>& forces, const HitOptions& options) {
  double largest = 0.0;
  for (const auto& hit : forces) largest = std::max(largest, hit.peak);
  std::vector<Hit> hits;
  for (const auto& hit : forces)
    if (hit.peak >= options.least * largest) hits.push_back(hit);
  return hits;
}

double rms(const Eigen::Ref<const VectorXd>& x, double rest) {
  return std::sqrt((x.array() - rest).square().mean());
}

}  // namespace

double rest_of(const VectorXd& input) { return median_of(input); }

std::vector<Hit> forces_in(const VectorXd& input, const HitOptions& options) {
  const Index n = input.size();
  const Eigen::ArrayXd size = (input.array() - median_of(input)).abs();
  const double level =
      std::max(options.of_noise * median_of(size.matrix()), options.of_peak * size.maxCoeff());
  const Index apart = std::lround(options.apart * static_cast<double>(n));
  const auto reach = [&](const Hit& hit) {
    return std::max<Index>(2 * hit_margin, std::min(apart, hit.to - hit.from + 1));
  };
  std::vector<Hit> all;
  for (Index k = 0; k < n; ++k) {
    if (!(size[k] > level)) continue;
    if (all.empty() || k - all.back().to > reach(all.back())) all.push_back({k, k, 0.0});
    all.back().to = k;
    all.back().peak = std::max(all.back().peak, size[k]);
  }
  for (auto& hit : all) {
    hit.from = std::max<Index>(0, hit.from - hit_margin);
    hit.to = std::min(n - 1, hit.to + hit_margin);
  }
  return all;
}

namespace {

/// c cos ωt + s sin ωt + m by least squares over samples that count.
struct ToneOfRest {
  Eigen::Vector3d coefficients{};
  double explained{};  // sum of squares
};

/// `use(t, cos ωt, sin ωt)` for all samples.
template <class Use>
void each_turn(double omega, Index samples, const Use& use) {
  constexpr Index renewed = 256;  // samples over which rounding of the phase adds up
  const Complex turn = std::polar(1.0, omega);
  Complex phase = 1.0;
  for (Index t = 0; t < samples; ++t, phase *= turn) {
    if (t % renewed == 0) phase = std::polar(1.0, omega * static_cast<double>(t));
    use(t, phase.real(), phase.imag());
  }
}

ToneOfRest tone_at(double omega, const VectorXd& x, const Eigen::ArrayXd& counts) {
  Eigen::Matrix3d N = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  each_turn(omega, x.size(), [&](Index t, double c, double s) {
    if (counts[t] == 0.0) return;
    const Eigen::Vector3d row(c, s, 1.0);
    N += row * row.transpose();
    b += x[t] * row;
  });
  const Eigen::Vector3d solution = N.ldlt().solve(b);
  return {solution, solution.dot(b)};
}

/// Of the rest: the frequency [rad/sample] of its strongest line, and what is best beside it.
double strongest_tone(const VectorXd& x, const Eigen::ArrayXd& counts) {
  // a transform of any other length may take long
  const auto n = static_cast<Index>(std::bit_floor(static_cast<std::size_t>(x.size())));
  numerics::RealFft fft(static_cast<int>(n));
  VectorXd rest = (x.array() * counts).head(n);
  std::vector<Complex> lines(static_cast<std::size_t>(fft.lines()));
  fft.forward({rest.data(), static_cast<std::size_t>(n)}, lines);
  constexpr std::size_t lowest = 2;  // below is drift
  const auto at = std::ranges::max_element(lines.begin() + lowest, lines.end(), {},
                                           [](const Complex& line) { return std::norm(line); });
  const double line = two_pi / static_cast<double>(n);
  const auto loss = [&](double place) { return -tone_at(place * line, x, counts).explained; };
  // all samples are up to twice as many: a quarter of a line is within the lobe of the best
  constexpr double step = 0.25;
  double best = static_cast<double>(at - lines.begin()), least = loss(best);
  const double middle = best;
  for (int k = -4; k <= 4; ++k)
    if (const double own = loss(middle + step * k); own < least) {
      least = own;
      best = middle + step * k;
    }
  constexpr int bits = 20;  // of the distance of lines
  return line * boost::math::tools::brent_find_minima(loss, best - step, best + step, bits).first;
}

}  // namespace

VectorXd without_hum(const VectorXd& input, std::vector<Hum>& found, const HitOptions& options) {
  if (input.size() < options.fewest || !input.allFinite()) return input;
  VectorXd x = input.array() - median_of(input);
  const Eigen::ArrayXd size = x.array().abs();
  const Eigen::ArrayXd counts =
      (size <= options.of_noise * median_of(size.matrix())).cast<double>();
  if (counts.minCoeff() > 0.0) return input;  // nothing stands out
  for (int k = 0; k < options.most_hum; ++k) {
    const double power = (x.array().square() * counts).sum();
    const double omega = strongest_tone(x, counts);
    const auto tone = tone_at(omega, x, counts);
    if (!(tone.explained > options.hum * power)) break;
    const auto& a = tone.coefficients;
    each_turn(omega, x.size(), [&](Index t, double c, double s) { x[t] -= a[0] * c + a[1] * s; });
    found.push_back({omega, std::hypot(a[0], a[1])});
  }
  return found.empty() ? input : x;
}

std::vector<Hit> hits_in(const VectorXd& input, const HitOptions& options) {
  if (input.size() < options.fewest || !input.allFinite()) return {};
  const double rest = median_of(input), all = (input.array() - rest).square().sum();
  if (!(all > 0.0)) return {};
  constexpr double deviation = 1.4826;  // of normal noise, by the median of its size
  const Eigen::ArrayXd size = (input.array() - rest).abs();
  if (deviation * median_of(size.matrix()) > options.quiet * size.maxCoeff()) return {};
  const auto forces = forces_in(input, options);
  double energy = 0.0;
  Index length = 0;
  for (const auto& hit : forces) {
    const Index own = hit.to - hit.from + 1;
    energy += (input.segment(hit.from, own).array() - rest).square().sum();
    length += own;
  }
  constexpr Index always = 9;  // samples of a hit in the shortest of records
  const auto longest =
      std::max<Index>(always, std::lround(options.longest * static_cast<double>(input.size())));
  if (energy < options.energy * all || length > longest) return {};
  auto hits = only_hits(forces, options);
  if (hits.size() > options.most_hits) hits.clear();
  return hits;
}

bool outputs_rise(const data::Samples& samples, const std::vector<int>& outputs,
                  const std::vector<Hit>& hits, const HitOptions& options) {
  constexpr Index enough = 16, part = 16;  // of a record: what is heavily damped is over soon
  const Index n = samples.rows(), longest = std::max(enough, n / part);
  for (std::size_t k = 0; k < hits.size(); ++k) {
    const Index from = hits[k].from, next = k + 1 < hits.size() ? hits[k + 1].from : n,
                before = std::min(from, longest), after = std::min(next - from, longest);
    if (before < enough || after < enough) continue;
    const auto rises = [&](int o) {
      const VectorXd y = samples.col(o).segment(from - before, before + after);
      const double rest = y.head(before).mean();
      return rms(y.tail(after), rest) > options.rise * rms(y.head(before), rest);
    };
    if (std::ranges::any_of(outputs, rises)) return true;
    if (k == 0) return false;
  }
  return true;
}

}  // namespace hydrapod::identification
