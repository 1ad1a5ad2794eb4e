#include "hydrapod/identification/responses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "hydrapod/numerics/fft.hpp"
#include "names.hpp"

namespace hydrapod::identification {

namespace {

constexpr Index tile = 32;           // lines whose sums stay in the first-level cache
constexpr std::size_t gathered = 8;  // blocks that are added up together

void check(const SpectrumOptions& options) {
  if (options.block_length < 8 || options.block_length % 2 != 0)
    throw std::invalid_argument(fmt::format(
        "a block has an even number of samples, at least 8, not {}", options.block_length));
  if (!(options.overlap >= 0.0 && options.overlap < 1.0))
    throw std::invalid_argument(
        fmt::format("blocks overlap by a share from 0 to below 1, not {}", options.overlap));
}

/// Σ over `blocks` of z_i z_j* for lines from `first`.
void add_pair(const std::vector<numerics::Lines>& blocks, std::size_t count, Index i, Index j,
              Index first, Index lines, double* re, double* im) {
  for (std::size_t b = 0; b < count; ++b) {
    const double* ar = blocks[b].re.col(i).data() + first;
    const double* ai = blocks[b].im.col(i).data() + first;
    const double* br = blocks[b].re.col(j).data() + first;
    const double* bi = blocks[b].im.col(j).data() + first;
    for (Index k = 0; k < lines; ++k) {
      re[k] += ar[k] * br[k] + ai[k] * bi[k];
      im[k] += ai[k] * br[k] - ar[k] * bi[k];
    }
  }
}

void add_products(const std::vector<numerics::Lines>& blocks, std::size_t count, MatrixXd& re,
                  MatrixXd& im) {
  if (count == 0) return;
  const Index channels = blocks[0].re.cols(), lines = re.rows();
  for (Index first = 0; first < lines; first += tile)
    for (Index i = 0, pair = 0; i < channels; ++i)
      for (Index j = 0; j <= i; ++j, ++pair)
        add_pair(blocks, count, i, j, first, std::min(tile, lines - first),
                 re.col(pair).data() + first, im.col(pair).data() + first);
}

MatrixXcd unpacked(const MatrixXd& re, const MatrixXd& im, Index line, Index channels) {
  MatrixXcd S(channels, channels);
  for (Index i = 0, pair = 0; i < channels; ++i)
    for (Index j = 0; j <= i; ++j, ++pair) {
      S(i, j) = {re(line, pair), im(line, pair)};
      S(j, i) = std::conj(S(i, j));
    }
  return S;
}

}  // namespace

/// Watches a channel for samples that are missing or stand at a limit.
class ChannelWatch {
 public:
  using Column = Eigen::Ref<const Eigen::VectorXd, 0, Eigen::InnerStride<>>;
  void add(const Column& samples);
  [[nodiscard]] ChannelHealth health() const;

 private:
  /// Samples at one end of the range, and at the value next to it: a clipped channel has more of
  /// the former, a coarsely resolved one fewer.
  struct Limit {
    double value{}, next{};
    std::int64_t counted{}, counted_next{};
    /// `extreme`: of these and all samples before; `side`: 1 for the upper end, −1 for the lower.
    void add(const Column& samples, double extreme, double side);
    [[nodiscard]] std::int64_t clipped() const { return counted > counted_next ? counted : 0; }
  };

  bool begun_{};
  std::int64_t samples_{}, missing_{};
  Limit low_{}, high_{};
};

void ChannelWatch::Limit::add(const Column& samples, double extreme, double side) {
  const auto count = [&](double at) { return (samples.array() == at).count(); };
  if (extreme != value) {  // beyond all before
    next = value;
    counted_next = counted;
    value = extreme;
    counted = 0;
  }
  counted += count(value);
  // the value next to it may be among these samples
  double inner = next;
  for (const double x : samples)
    if (std::isfinite(x) && x != value && side * (x - inner) > 0.0) inner = x;
  if (inner != next) counted_next = 0;
  next = inner;
  counted_next += count(next);
}

void ChannelWatch::add(const Column& samples) {
  samples_ += samples.size();
  double low = 0.0, high = 0.0;
  bool any = false;
  if (samples.allFinite()) {
    low = samples.minCoeff();
    high = samples.maxCoeff();
    any = samples.size() > 0;
  } else {
    for (const double x : samples) {
      if (!std::isfinite(x)) {
        ++missing_;
        continue;
      }
      low = any ? std::min(low, x) : x;
      high = any ? std::max(high, x) : x;
      any = true;
    }
  }
  if (!any) return;
  if (!begun_) {
    low_ = {.value = low, .next = high};
    high_ = {.value = high, .next = low};
  }
  begun_ = true;
  // else no sample of this piece is at the limit or next to it
  if (low <= low_.next) low_.add(samples, std::min(low, low_.value), -1.0);
  if (high >= high_.next) high_.add(samples, std::max(high, high_.value), 1.0);
}

ChannelHealth ChannelWatch::health() const {
  ChannelHealth health;
  health.samples = samples_;
  health.missing = missing_;
  health.lowest = low_.value;
  health.highest = high_.value;
  if (high_.value > low_.value) health.at_limit = low_.clipped() + high_.clipped();
  return health;
}

MatrixXcd CrossSpectra::at(Index line) const {
  return unpacked(re, im, line, static_cast<Index>(channels.size()));
}

MatrixXcd CrossSpectra::noise_at(Index line) const {
  return unpacked(noise_re, noise_im, line, static_cast<Index>(channels.size()));
}

struct SpectrumEstimator::Implementation {
  SpectrumOptions options;
  std::vector<std::size_t> chosen;
  CrossSpectra sums;  // not yet divided
  std::vector<ChannelWatch> watches;
  numerics::RealFft fft;
  int hop{};
  data::Samples buffer{};  // block_length rows, the first `filled` are in use
  Index filled{};
  std::int64_t to_skip{};
  numerics::RealFft::Block windowed{};
  std::vector<numerics::Lines> waiting{std::vector<numerics::Lines>(gathered)};
  std::size_t waiting_count{};
  numerics::Lines period_sum{};  // of the record that is running
  std::int64_t periods{};
  std::int64_t degrees{};  // Σ (periods − 1) over records

  void take_block();
  void flush();
  void end_record();
};

SpectrumEstimator::SpectrumEstimator(const data::RecordHeader& header,
                                     const SpectrumOptions& options,
                                     const std::vector<std::size_t>& channels) {
  check(options);
  auto chosen = channels;
  if (chosen.empty()) {
    chosen.resize(header.channels.size());
    std::iota(chosen.begin(), chosen.end(), std::size_t{0});
  }
  implementation_ = std::make_unique<Implementation>(
      Implementation{.options = options,
                     .chosen = chosen,
                     .sums = {},
                     .watches = std::vector<ChannelWatch>(chosen.size()),
                     .fft = numerics::RealFft(options.block_length)});
  auto& me = *implementation_;
  const auto count = static_cast<Index>(chosen.size());
  auto& sums = me.sums;
  for (const std::size_t c : chosen) sums.channels.push_back(header.channels.at(c));
  sums.sample_rate = header.sample_rate;
  sums.options = options;
  sums.window =
      window_samples(options.periodic ? Window::rectangular : options.window, options.block_length);
  me.hop = options.periodic ? options.block_length
                            : std::max(1, static_cast<int>(std::lround(options.block_length *
                                                                       (1.0 - options.overlap))));
  me.buffer.resize(options.block_length, count);
  me.windowed.resize(options.block_length, count);
  const Index pairs = count * (count + 1) / 2;
  for (auto* sum : {&sums.re, &sums.im}) *sum = MatrixXd::Zero(me.fft.lines(), pairs);
  if (options.periodic)
    for (auto* sum : {&sums.noise_re, &sums.noise_im}) *sum = MatrixXd::Zero(me.fft.lines(), pairs);
}

SpectrumEstimator::~SpectrumEstimator() = default;
SpectrumEstimator::SpectrumEstimator(SpectrumEstimator&&) noexcept = default;
SpectrumEstimator& SpectrumEstimator::operator=(SpectrumEstimator&&) noexcept = default;

void SpectrumEstimator::Implementation::flush() {
  const bool periodic = options.periodic;
  add_products(waiting, waiting_count, periodic ? sums.noise_re : sums.re,
               periodic ? sums.noise_im : sums.im);
  waiting_count = 0;
}

/// The buffer is full: one more block.
void SpectrumEstimator::Implementation::take_block() {
  const Eigen::RowVectorXd mean = buffer.colwise().mean();
  if (mean.allFinite()) {
    windowed.noalias() = sums.window.asDiagonal() * (buffer.rowwise() - mean);
    auto& lines = waiting[waiting_count++];
    fft.forward(windowed, lines);
    if (options.periodic) {
      if (periods == 0) {
        period_sum.re.setZero(lines.re.rows(), lines.re.cols());
        period_sum.im = period_sum.re;
      }
      period_sum.re += lines.re;
      period_sum.im += lines.im;
    }
    ++periods;
    ++sums.blocks;
    if (waiting_count == gathered) flush();
  } else {
    ++sums.blocks_left_out;
  }
  const Index kept = options.block_length - hop;
  if (kept > 0) buffer.topRows(kept) = buffer.bottomRows(kept).eval();
  filled = kept;
}

/// Closes the averages of a record.
void SpectrumEstimator::Implementation::end_record() {
  flush();
  if (periods > 0) {
    ++sums.records;
    degrees += periods - 1;
    if (options.periodic) {
      // Σ z zᴴ − m z̄ z̄ᴴ goes to the noise, z̄ z̄ᴴ to the spectra
      std::vector<numerics::Lines> mean(1);
      const double scale = 1.0 / std::sqrt(static_cast<double>(periods));
      mean[0] = {scale * period_sum.re, scale * period_sum.im};
      MatrixXd re = MatrixXd::Zero(sums.re.rows(), sums.re.cols()), im = re;
      add_products(mean, 1, re, im);
      sums.noise_re -= re;
      sums.noise_im -= im;
      sums.re += re / static_cast<double>(periods);
      sums.im += im / static_cast<double>(periods);
    }
  }
  periods = 0;
  filled = 0;
}

void SpectrumEstimator::begin_record(std::int64_t settling) {
  implementation_->end_record();
  implementation_->to_skip = settling;
}

void SpectrumEstimator::add(const Eigen::Ref<const data::Samples>& samples) {
  auto& me = *implementation_;
  Index row = std::min<Index>(samples.rows(), me.to_skip);
  me.to_skip -= row;
  while (row < samples.rows()) {
    const Index count = std::min<Index>(samples.rows() - row, me.options.block_length - me.filled);
    for (std::size_t c = 0; c < me.chosen.size(); ++c) {
      const auto column = samples.col(static_cast<Index>(me.chosen[c])).segment(row, count);
      me.buffer.col(static_cast<Index>(c)).segment(me.filled, count) = column;
    }
    for (std::size_t c = 0; c < me.chosen.size(); ++c)
      me.watches[c].add(me.buffer.col(static_cast<Index>(c)).segment(me.filled, count));
    me.filled += count;
    row += count;
    if (me.filled == me.options.block_length) me.take_block();
  }
}

CrossSpectra SpectrumEstimator::result() {
  auto& me = *implementation_;
  me.end_record();
  CrossSpectra result = me.sums;
  for (const auto& watch : me.watches) result.health.push_back(watch.health());
  if (result.blocks == 0) return result;
  const auto count = static_cast<double>(me.options.periodic ? result.records : result.blocks);
  VectorXd scale =
      VectorXd::Constant(result.lines(), 2.0 / (result.sample_rate * result.window.squaredNorm()));
  scale[0] /= 2.0;
  scale[result.lines() - 1] /= 2.0;
  for (auto* sum : {&result.re, &result.im}) *sum = (scale / count).asDiagonal() * *sum;
  if (me.options.periodic && me.degrees > 0)
    for (auto* sum : {&result.noise_re, &result.noise_im})
      *sum = (scale / static_cast<double>(me.degrees)).asDiagonal() * *sum;
  result.statistics = average_statistics(result.window, me.hop, result.blocks);
  return result;
}

std::int64_t period_of(const VectorXd& samples, double tolerance) {
  const Index n = samples.size() / 2 * 2;
  if (n < 16) return 0;
  const VectorXd x = samples.head(n).array() - samples.head(n).mean();
  numerics::RealFft fft(static_cast<int>(2 * n));
  std::vector<double> padded(static_cast<std::size_t>(2 * n), 0.0);
  VectorXd::Map(padded.data(), n) = x;
  std::vector<std::complex<double>> lines(static_cast<std::size_t>(fft.lines()));
  fft.forward(padded, lines);
  for (auto& line : lines) line = std::norm(line);
  fft.inverse(lines, padded);
  const double power = padded[0] / static_cast<double>(n);
  if (!(power > 0.0)) return 0;
  bool fell = false;  // away from the peak at lag 0
  for (Index lag = 2; lag <= n / 3; ++lag) {
    const auto at = [&](Index l) {
      return padded[static_cast<std::size_t>(l)] / (power * static_cast<double>(n - l));
    };
    fell = fell || at(lag) < 0.5;
    if (!fell || at(lag) < 0.9 || at(lag) < at(lag - 1) || at(lag) < at(lag + 1)) continue;
    const double error = (x.tail(n - lag) - x.head(n - lag)).squaredNorm();
    if (error <= tolerance * tolerance * power * static_cast<double>(n - lag)) return lag;
  }
  return 0;
}

}  // namespace hydrapod::identification
