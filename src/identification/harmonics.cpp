#include "harmonics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "hydrapod/numerics/statistics.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

/// Lines on either side of a harmonic that its window reaches.
constexpr Index main_lobe = 3;

/// Mean over channels of their powers, each in proportion to its median nearby.
VectorXd conspicuousness(const CrossSpectra& spectra, const std::vector<int>& channels, int reach) {
  VectorXd sum = VectorXd::Zero(spectra.lines());
  for (const int c : channels) {
    const VectorXd own = spectra.re.col(Index{c} * (c + 1) / 2 + c);
    for (Index k = 0; k < own.size(); ++k) {
      const Index from = std::max<Index>(0, k - reach),
                  to = std::min<Index>(own.size() - 1, k + reach);
      const auto near = own.segment(from, to - from + 1);
      sum[k] += own[k] / std::max(numerics::upper_median({near.begin(), near.end()}), 1e-300);
    }
  }
  return sum / static_cast<double>(std::max<std::size_t>(channels.size(), 1));
}

/// ℓ_γ at distances of an eighth of a line, up to `reach` lines.
class LineShape {
 public:
  LineShape(const VectorXd& taper, double gamma, int reach) {
    const auto n = static_cast<double>(taper.size());
    constexpr int samples = 512;  // of ρ: it is smooth
    for (int at = 0; at <= reach * per_line; ++at) {
      double sum = 0.5;
      const double d = static_cast<double>(at) / per_line;
      for (int t = 1; t < samples; ++t) {
        const double share = static_cast<double>(t) / samples;
        sum += taper[static_cast<Index>(share * n)] * std::exp(-two_pi * gamma * share) *
               std::cos(two_pi * share * d);
      }
      values_.push_back(sum);
    }
    const double top = values_[0];
    for (double& v : values_) v = std::max(v / top, 0.0);
  }
  static constexpr int per_line = 8;
  /// `eighths`: distance in eighths of a line.
  [[nodiscard]] double at(int eighths) const {
    return values_[static_cast<std::size_t>(std::abs(eighths))];
  }

 private:
  std::vector<double> values_;
};

/// The largest likelihood of powers over b + a · shape, per number averaged, by steps that never
/// make it less (Itakura and Saito's distance, multiplicative).
double likelihood(const VectorXd& power, const VectorXd& shape) {
  double a = std::max(power.maxCoeff() - power.minCoeff(), 1e-300), b = power.minCoeff();
  VectorXd mean;
  constexpr int steps = 40;
  for (int step = 0; step < steps; ++step) {
    mean = (b + a * shape.array()).max(1e-300);
    const Eigen::ArrayXd part = power.array() / mean.array().square(),
                         rest = mean.array().inverse();
    const double by_shape = (part * shape.array()).sum() / (rest * shape.array()).sum();
    const double by_level = part.sum() / rest.sum();
    a *= std::sqrt(by_shape);
    b *= std::sqrt(by_level);
  }
  return -(mean.array().log() + power.array() / mean.array()).sum();
}

/// The best over where between the lines the shape stands, and that place in eighths of a line.
std::pair<double, int> best_place(const VectorXd& power, const LineShape& shape) {
  const auto reach = static_cast<int>(power.size() / 2);
  std::pair<double, int> best{-std::numeric_limits<double>::infinity(), 0};
  for (int place = -LineShape::per_line / 2; place <= LineShape::per_line / 2; ++place) {
    VectorXd values(power.size());
    for (int d = -reach; d <= reach; ++d)
      values[d + reach] = shape.at(d * LineShape::per_line - place);
    best = std::max(best, {likelihood(power, values), place});
  }
  return best;
}

/// √(2 · power above the lines beside) per channel.
VectorXd amplitudes(const CrossSpectra& spectra, const std::vector<int>& channels, Index line) {
  VectorXd amplitude(static_cast<Index>(channels.size()));
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const Index column = Index{channels[c]} * (channels[c] + 1) / 2 + channels[c];
    const auto mean_of = [&](Index from, Index count) {
      return spectra.re.col(column).segment(from, count).mean();
    };
    const double beside =
        0.5 * (mean_of(line - 2 * main_lobe, main_lobe) + mean_of(line + main_lobe + 1, main_lobe));
    const double power = (mean_of(line - main_lobe, 2 * main_lobe + 1) - beside) *
                         static_cast<double>(2 * main_lobe + 1) * spectra.frequency(1);
    amplitude[static_cast<Index>(c)] = std::sqrt(2.0 * std::max(power, 0.0));
  }
  return amplitude;
}

}  // namespace

std::vector<Harmonic> find_harmonics(const CrossSpectra& spectra, const std::vector<int>& channels,
                                     const HarmonicOptions& options) {
  std::vector<Harmonic> found;
  if (spectra.options.periodic || spectra.lines() <= 2 * options.reach || channels.empty())
    return found;
  const VectorXd power = conspicuousness(spectra, channels, options.reach);
  const VectorXd taper = lag_taper(spectra.window);
  const int band = options.half_band;
  const LineShape sharp(taper, 0.0, band + 1);
  std::vector<LineShape> wide;
  for (const double times : std::array{1.0, 2.0, 4.0, 8.0, 16.0})
    wide.emplace_back(taper, times * options.narrowest, band + 1);
  const double K = std::max(1.0, spectra.statistics.effective_averages);
  for (Index k = band + 1; k + band + 1 < power.size(); ++k) {
    const bool highest = power[k] > options.stands_out &&
                         power[k] >= power.segment(k - main_lobe, 2 * main_lobe + 1).maxCoeff();
    if (!highest) continue;
    const VectorXd near = power.segment(k - band, 2 * band + 1);
    const auto [own, place] = best_place(near, sharp);
    double other = -std::numeric_limits<double>::infinity();
    for (const auto& shape : wide) other = std::max(other, best_place(near, shape).first);
    if (!(K * (own - other) > options.evidence)) continue;
    const double line = static_cast<double>(k) + static_cast<double>(place) / LineShape::per_line;
    found.push_back({line * spectra.frequency(1), amplitudes(spectra, channels, k)});
  }
  return found;
}

namespace {

/// Lines on either side at which the window's side lobes, that fall as d⁻⁶, are above a third of
/// what is beside.
Index reach_of(const std::vector<MatrixXcd>& S, Index at) {
  constexpr Index beside = 20;
  std::vector<double> near;
  const auto power = [&](Index k) { return S[static_cast<std::size_t>(k)].trace().real(); };
  const Index last = static_cast<Index>(S.size()) - 1;
  for (Index k = std::max<Index>(0, at - beside); k <= std::min(last, at + beside); ++k)
    near.push_back(power(k));
  const double ratio = power(at) / std::max(numerics::upper_median(near), 1e-300);
  return std::clamp(static_cast<Index>(std::ceil(std::pow(ratio / 3.0, 1.0 / 6.0))), main_lobe,
                    beside);
}

/// Straight lines from `before` to `after`, between the means of `side` lines next to them; false
/// where there are not so many.
bool bridge_lines(Index before, Index after, Index side, std::vector<MatrixXcd>& S) {
  if (before - side < 0 || after + side >= static_cast<Index>(S.size())) return false;
  const auto mean = [&](Index from) {
    MatrixXcd sum = MatrixXcd::Zero(S[0].rows(), S[0].cols());
    for (Index k = from; k < from + side; ++k) sum += S[static_cast<std::size_t>(k)];
    return MatrixXcd(sum / static_cast<double>(side));
  };
  const MatrixXcd left = mean(before - side), right = mean(after + 1);
  for (Index k = before; k <= after; ++k) {
    const double share =
        static_cast<double>(k - before + 2) / static_cast<double>(after - before + 4);
    S[static_cast<std::size_t>(k)] = (1.0 - share) * left + share * right;
  }
  return true;
}

/// Lines of a bump, with those on its flanks that still fall.
std::pair<Index, Index> lines_of_bump(const std::vector<MatrixXcd>& S, Index before, Index after) {
  VectorXd size = VectorXd::Constant(S[0].rows(), 1e-300);
  for (const auto& s : S) size += s.diagonal().real();
  const auto level = [&](Index from) {
    double sum = 0.0;
    for (Index k = from; k < from + main_lobe; ++k)
      sum += S[static_cast<std::size_t>(k)].diagonal().real().cwiseQuotient(size).sum();
    return sum;
  };
  constexpr double falls = 1.5;
  const Index most = std::max(after - before, main_lobe), last = static_cast<Index>(S.size());
  for (Index n = 0; n < most && before > 2 * main_lobe &&
                    level(before - main_lobe) > falls * level(before - 2 * main_lobe);
       ++n)
    --before;
  for (Index n = 0; n < most && after + 2 * main_lobe + 1 < last &&
                    level(after + 1) > falls * level(after + 1 + main_lobe);
       ++n)
    ++after;
  return {before, after};
}

}  // namespace

void leave_out_harmonics(const std::vector<Harmonic>& harmonics, double spacing,
                         std::vector<MatrixXcd>& S) {
  for (const auto& harmonic : harmonics) {
    const auto at = static_cast<Index>(std::llround(harmonic.frequency / spacing));
    if (at >= static_cast<Index>(S.size())) continue;
    const Index reach = reach_of(S, at);
    bridge_lines(at - reach, at + reach, main_lobe, S);
  }
}

void leave_out_wandering(const CrossSpectra& spectra, const std::vector<int>& channels,
                         const std::array<double, 2>& tone, std::vector<MatrixXcd>& S,
                         FrequencyResponses& half) {
  const double spacing = spectra.frequency(1);
  const auto [before, after] = lines_of_bump(
      S, std::max<Index>(0, std::llround(tone[0] / spacing) - main_lobe),
      std::min<Index>(std::ssize(S) - 1, std::llround(tone[1] / spacing) + main_lobe));
  const auto as_measured = S;
  if (!bridge_lines(before, after, std::max(main_lobe, (after - before) / 4), S)) return;
  Harmonic harmonic{.frequency = 0.5 * (tone[0] + tone[1]),
                    .amplitude = VectorXd::Zero(static_cast<Index>(channels.size())),
                    .wander = 0.5 * (tone[1] - tone[0])};
  for (Index k = before; k <= after; ++k) {
    const auto line = static_cast<std::size_t>(k);
    harmonic.amplitude += (as_measured[line] - S[line]).diagonal().real();
  }
  // S: half the density times the sample rate
  harmonic.amplitude =
      (4.0 * spacing / spectra.sample_rate * harmonic.amplitude).cwiseMax(0.0).cwiseSqrt();
  const double lowest = static_cast<double>(before) * spacing,
               highest = static_cast<double>(after) * spacing;
  std::erase_if(half.harmonics, [&](const Harmonic& other) {
    return other.wander == 0.0 && other.frequency >= lowest && other.frequency <= highest;
  });
  half.warnings.push_back({.kind = data::ResponseWarning::Kind::wandering_tone,
                           .value = harmonic.frequency,
                           .share = harmonic.wander / harmonic.frequency,
                           .lowest = lowest,
                           .highest = highest});
  half.harmonics.push_back(std::move(harmonic));
  std::ranges::sort(half.harmonics, {}, &Harmonic::frequency);
}

bool is_endless(const FrequencyResponses& half, std::complex<double> pole,
                const EndlessOptions& options) {
  const double longest = static_cast<double>(half.taper.size()) / half.sample_rate;
  return half.whole && -pole.real() * longest < options.decays;
}

}  // namespace hydrapod::identification
