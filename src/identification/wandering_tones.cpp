#include "wandering_tones.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "evenness.hpp"
#include "hydrapod/numerics/fft.hpp"
#include "references.hpp"

namespace hydrapod::identification {

namespace {

/// Lines on either side that Hann's window fills.
constexpr Index hann_reach = 2;

/// Moments of |z|² at the lines of blocks of one length: lines × channels.
class LineMoments {
 public:
  LineMoments(int length, Index channels)
      : fft_(length),
        window_(window_samples(Window::hann, length)),
        buffer_(length, channels),
        mean_(MatrixXd::Zero(fft_.lines(), channels)),
        square_(mean_),
        line_(static_cast<std::size_t>(fft_.lines())) {}

  void begin_record() { filled_ = 0; }
  void add(const data::Samples& samples) {
    const Index length = buffer_.rows();
    for (Index at = 0; at < samples.rows();) {
      const Index count = std::min(length - filled_, samples.rows() - at);
      buffer_.middleRows(filled_, count) = samples.middleRows(at, count);
      at += count;
      filled_ += count;
      if (filled_ < length) return;
      take_block();
      filled_ = length / 2;
      buffer_.topRows(filled_) = buffer_.bottomRows(filled_).eval();
    }
  }
  [[nodiscard]] Index blocks() const { return blocks_; }
  [[nodiscard]] int length() const { return fft_.length(); }
  [[nodiscard]] Index lines() const { return mean_.rows(); }
  /// Elsewhere the side lobes of a strong vibration may be what is even.
  [[nodiscard]] bool is_peak(Index line, Index channel) const {
    const Index from = std::max<Index>(0, line - hann_reach),
                to = std::min(mean_.rows() - 1, line + hann_reach);
    return mean_(line, channel) >= mean_.col(channel).segment(from, to - from + 1).maxCoeff();
  }
  /// Of |z|²; infinite where there is no power.
  [[nodiscard]] double relative_variance(Index line, Index channel) const {
    const double power = mean_(line, channel), n = static_cast<double>(blocks_);
    return power > 0.0 ? n * square_(line, channel) / (power * power) - 1.0
                       : std::numeric_limits<double>::infinity();
  }

 private:
  void take_block() {
    if (!buffer_.allFinite()) return;
    ++blocks_;
    for (Index c = 0; c < buffer_.cols(); ++c) {
      VectorXd x = (buffer_.col(c).array() - buffer_.col(c).mean()) * window_.array();
      fft_.forward({x.data(), static_cast<std::size_t>(x.size())}, line_);
      for (Index k = 0; k < mean_.rows(); ++k) {
        const double power = std::norm(line_[static_cast<std::size_t>(k)]);
        mean_(k, c) += power;
        square_(k, c) += power * power;
      }
    }
  }

  numerics::RealFft fft_;
  VectorXd window_;
  MatrixXd buffer_;
  MatrixXd mean_, square_;
  std::vector<Complex> line_;
  Index filled_{}, blocks_{};
};

/// A line whose power is more constant than that of noise.
struct EvenLine {
  int length{};  // of the blocks
  Index line{};
  double even{};  // relative variance
};

std::vector<LineMoments> all_line_moments(data::RecordSet& records, const ToneReading& reading,
                                          const WanderingToneOptions& options) {
  std::int64_t total = 0;
  for (std::size_t k = 0; k < records.files().size(); ++k) total += records.count_samples(k);
  std::vector<LineMoments> list;
  // overlapping by half
  for (std::int64_t n = options.shortest; (options.fewest_blocks + 1) * n <= 2 * total; n *= 2)
    list.emplace_back(static_cast<int>(n), static_cast<Index>(reading.channels.size()));
  if (list.empty()) return list;
  std::optional<std::size_t> begun;
  stream_used(records, reading,
              [&](std::size_t record, std::int64_t, const data::Samples& samples) {
                for (auto& moments : list) {
                  if (begun != record) moments.begin_record();
                  moments.add(samples);
                }
                begun = record;
              });
  std::erase_if(list, [&](const auto& m) { return m.blocks() < options.fewest_blocks; });
  return list;
}

/// The most even one first, one per place: it is that of the blocks that see a vibration best.
std::vector<EvenLine> even_lines(const std::vector<LineMoments>& list, std::size_t channels,
                                 double log_chance, const WanderingToneOptions& options) {
  std::vector<EvenLine> lines;
  for (const auto& moments : list)
    for (Index k = options.lowest_line; k + 1 < moments.lines(); ++k) {
      double even = std::numeric_limits<double>::infinity();
      for (Index c = 0; c < static_cast<Index>(channels); ++c)
        if (moments.is_peak(k, c)) even = std::min(even, moments.relative_variance(k, c));
      if (!(even < options.uneven)) continue;
      const double own =
          log_chance_of_evenness(static_cast<double>(moments.blocks()), std::max(even, 1e-12));
      if (own < log_chance) lines.push_back({moments.length(), k, even});
    }
  std::ranges::sort(lines, {}, &EvenLine::even);
  std::vector<EvenLine> places;
  for (const auto& line : lines) {
    const double f = static_cast<double>(line.line) / line.length;
    const bool is_known = std::ranges::any_of(places, [&](const EvenLine& other) {
      const double wide = 2.0 / std::min(line.length, other.length);
      return std::abs(f - static_cast<double>(other.line) / other.length) <= wide;
    });
    if (!is_known && places.size() < options.most) places.push_back(line);
  }
  return places;
}

/// Combinations of outputs: each by itself, and what has the largest power of all.
std::vector<VectorXcd> combinations(const std::vector<Zoom>& zooms) {
  const Index q = zooms[0].z.cols();
  MatrixXcd S = MatrixXcd::Zero(q, q);
  for (const auto& zoom : zooms)
    for (Index j = 0; j < zoom.z.rows(); ++j)
      if (const VectorXcd z = zoom.z.row(j).transpose(); z.allFinite()) S += z * z.adjoint();
  std::vector<VectorXcd> list;
  for (Index c = 0; c < q; ++c) list.emplace_back(VectorXcd::Unit(q, c));
  const VectorXd unit = S.diagonal().real().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXcd> solver(unit.asDiagonal() * S * unit.asDiagonal());
  if (q > 1 && solver.info() == Eigen::Success)
    list.emplace_back(solver.eigenvectors().col(q - 1).cwiseProduct(unit));
  return list;
}

/// uᴴz of all records, those that are missing 0.
std::vector<VectorXcd> combined_series(const std::vector<Zoom>& zooms, const VectorXcd& u) {
  std::vector<VectorXcd> list;
  for (const auto& zoom : zooms) {
    VectorXcd y = zoom.z * u.conjugate();
    for (Complex& value : y)
      if (!std::isfinite(std::norm(value))) value = 0.0;
    list.push_back(std::move(y));
  }
  return list;
}

/// ln of the bound of the chance that noise is so even; 0 where it is not even.
double log_chance_of(const std::vector<VectorXcd>& series, double uneven) {
  double count = 0.0, power = 0.0, square = 0.0, J = 0.0;
  for (const auto& y : series) {
    double lines = 0.0, lines_squared = 0.0;
    if (y.size() == 0) continue;
    for (const Complex& line : numerics::complex_fft({y.begin(), y.end()})) {
      lines += std::norm(line);
      lines_squared += std::norm(line) * std::norm(line);
    }
    if (lines > 0.0) J += lines * lines / lines_squared;
    for (const Complex& value : y) {
      if (value == 0.0) continue;
      count += 1.0;
      power += std::norm(value);
      square += std::norm(value) * std::norm(value);
    }
  }
  constexpr double fewest = 3.0;
  if (!(power > 0.0) || J < fewest) return 0.0;
  const double even = count * square / (power * power) - 1.0;
  return even < uneven ? log_chance_of_evenness(J, std::max(even, 1e-12)) : 0.0;
}

/// Frequencies [rad/sample] from one value to the next, where neither is small.
std::vector<double> phase_frequencies(const std::vector<Zoom>& zooms,
                                      const std::vector<VectorXcd>& series) {
  double power = 0.0, count = 0.0;
  for (const auto& y : series) {
    power += y.squaredNorm();
    count += static_cast<double>((y.array() != Complex(0.0)).count());
  }
  constexpr double small = 0.25;
  const double least = small * power / std::max(count, 1.0);
  std::vector<double> list;
  for (std::size_t r = 0; r < series.size(); ++r)
    for (Index j = 0; j + 1 < series[r].size(); ++j) {
      const Complex one = series[r][j], next = series[r][j + 1];
      if (std::norm(one) > least && std::norm(next) > least)
        list.push_back(zooms[r].omega +
                       std::arg(next * std::conj(one)) / static_cast<double>(zooms[r].hop));
    }
  std::ranges::sort(list);
  return list;
}

/// The combination that is least like noise.
struct Evenest {
  std::vector<VectorXcd> series{};
  double log_chance{};
};

Evenest evenest(const std::vector<Zoom>& zooms, double uneven) {
  Evenest best;
  for (const auto& u : combinations(zooms)) {
    auto series = combined_series(zooms, u);
    const double own = log_chance_of(series, uneven);
    if (best.series.empty() || own < best.log_chance) best = {std::move(series), own};
  }
  return best;
}

std::vector<WanderingTone> merged(std::vector<WanderingTone> list) {
  std::ranges::sort(list, {}, [](const WanderingTone& tone) { return tone[0]; });
  std::vector<WanderingTone> apart;
  for (const auto& tone : list)
    if (!apart.empty() && tone[0] <= apart.back()[1])
      apart.back()[1] = std::max(apart.back()[1], tone[1]);
    else
      apart.push_back(tone);
  return apart;
}

/// What is even at lines of blocks of one length, looked at twice: around the line, and around the
/// mean frequency.
std::vector<WanderingTone> tones_at(data::RecordSet& records, const ToneReading& reading,
                                    const std::vector<EvenLine>& lines, double log_chance,
                                    const WanderingToneOptions& options) {
  std::vector<std::vector<double>> omegas;
  for (const auto& line : lines)
    omegas.emplace_back(records.files().size(),
                        two_pi * static_cast<double>(line.line) / line.length);
  std::vector<std::vector<double>> better;
  for (const auto& zooms : zoom_in(records, reading, omegas, lines[0].length)) {
    const auto all = phase_frequencies(zooms, evenest(zooms, options.uneven).series);
    if (!all.empty()) better.emplace_back(records.files().size(), all[all.size() / 2]);
  }
  std::vector<WanderingTone> tones;
  if (better.empty()) return tones;
  const double rate = records.header().sample_rate;
  for (const auto& zooms : zoom_in(records, reading, better, lines[0].length)) {
    const auto found = evenest(zooms, options.uneven);
    if (!(found.log_chance < log_chance)) continue;
    const auto all = phase_frequencies(zooms, found.series);
    const auto cut = static_cast<std::size_t>(options.outliers * static_cast<double>(all.size()));
    tones.push_back({all[cut] * rate / two_pi, all[all.size() - 1 - cut] * rate / two_pi});
  }
  return tones;
}

}  // namespace

ToneReading outputs_that_see_all(const std::vector<std::size_t>& used, std::int64_t settling,
                                 const CrossSpectra& spectra, const std::vector<int>& outputs,
                                 std::size_t most) {
  ToneReading looked{.settling = settling};
  std::vector<int> living;
  for (const int o : outputs)
    if (!spectra.health[static_cast<std::size_t>(o)].constant()) living.push_back(o);
  if (living.empty() || spectra.lines() < 2) return looked;
  std::vector<MatrixXcd> S;
  constexpr Index enough = 1024;  // lines
  for (Index k = 1; k < spectra.lines(); k += std::max<Index>(1, spectra.lines() / enough))
    S.emplace_back(spectra.at(k)(living, living));
  for (const int o : choose_references(S, static_cast<Index>(most)))
    looked.channels.push_back(used[static_cast<std::size_t>(living[static_cast<std::size_t>(o)])]);
  return looked;
}

std::vector<WanderingTone> find_wandering_tones(data::RecordSet& records,
                                                const std::vector<std::size_t>& used,
                                                std::int64_t settling, const CrossSpectra& spectra,
                                                const std::vector<int>& outputs,
                                                const WanderingToneOptions& options) {
  const auto reading = outputs_that_see_all(used, settling, spectra, outputs, options.most_outputs);
  if (reading.channels.empty()) return {};
  const auto list = all_line_moments(records, reading, options);
  double asked = 1.0;
  for (const auto& moments : list)
    asked += static_cast<double>(moments.lines()) * static_cast<double>(reading.channels.size());
  const double log_chance = std::log(options.chance / asked);
  auto lines = even_lines(list, reading.channels.size(), log_chance, options);
  // of these few lines, each output and their combination
  const double of_few =
      std::log(options.chance / static_cast<double>(options.most * (reading.channels.size() + 1)));
  std::vector<WanderingTone> tones;
  for (const auto& moments : list) {
    std::vector<EvenLine> own;
    for (const auto& line : lines)
      if (line.length == moments.length()) own.push_back(line);
    if (own.empty()) continue;
    const auto found = tones_at(records, reading, own, of_few, options);
    tones.insert(tones.end(), found.begin(), found.end());
  }
  return merged(std::move(tones));
}

}  // namespace hydrapod::identification
