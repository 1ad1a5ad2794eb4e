#include "hydrapod/identification/responses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "bridge.hpp"
#include "channel_watch.hpp"
#include "cross_products.hpp"
#include "hydrapod/numerics/fft.hpp"
#include "hydrapod/numerics/parallel.hpp"
#include "names.hpp"
#include "record_mean.hpp"

namespace hydrapod::identification {

namespace {

// Blocks are taken many at a time: the sums of all pairs, which are larger than the processor's
// caches, are then read and written that much less often.
constexpr Index most_blocks = 16;
constexpr Index most_numbers = Index{1} << 21;  // samples of all blocks taken at a time: 32 MB
constexpr Index few_rows = 1024;  // that are copied and then looked at while they are in the cache
// Threads begin in some 50 µs; less work than this is done sooner by one.
constexpr Index worth_threads = Index{1} << 17;  // samples of all blocks

void check(const SpectrumOptions& options) {
  if (options.block_length < 8 || options.block_length % 2 != 0)
    throw std::invalid_argument(fmt::format(
        "a block has an even number of samples, at least 8, not {}", options.block_length));
  if (!(options.overlap >= 0.0 && options.overlap < 1.0))
    throw std::invalid_argument(
        fmt::format("blocks overlap by a share from 0 to below 1, not {}", options.overlap));
}

constexpr int four = 4;  // channels stand side by side
using FourChannels = Eigen::Matrix<double, Eigen::Dynamic, four, Eigen::RowMajor>;
using MeansOfBlocks = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Mean per channel. Four sums take turns: additions need not wait for each other.
Eigen::RowVectorXd row_mean(const FourChannels& samples, Index first, Index rows) {
  std::array<std::array<double, four>, 4> sums{};
  const double* x = samples.data() + four * first;
  Index t = 0;
  for (; t + 4 <= rows; t += 4)
    for (auto& sum : sums) {
      for (std::size_t c = 0; c < four; ++c) sum[c] += x[c];
      x += four;
    }
  for (; t < rows; ++t, x += four)
    for (std::size_t c = 0; c < four; ++c) sums[0][c] += x[c];
  Eigen::RowVectorXd mean(four);
  for (std::size_t c = 0; c < four; ++c)
    mean[static_cast<Index>(c)] =
        ((sums[0][c] + sums[1][c]) + (sums[2][c] + sums[3][c])) / static_cast<double>(rows);
  return mean;
}

/// Least and largest per channel; not finite where a sample is not. Rows take turns as in the mean.
struct Extremes {
  std::array<double, four> low, high;
  Extremes(const FourChannels& samples, Index first, Index rows) {
    using Four = Eigen::Array<double, four, 1>;
    constexpr std::size_t turns = 4;
    const double* x = samples.data() + four * first;
    const Four begin = Four::Map(x);
    std::array<Four, turns> least, most, nothing;
    least.fill(begin);
    most.fill(begin);
    nothing.fill(0.0 * begin);
    const auto take = [&](std::size_t k) {
      const Four row = Four::Map(x);
      least[k] = (row < least[k]).select(row, least[k]);
      most[k] = (row > most[k]).select(row, most[k]);
      nothing[k] += 0.0 * row;
      x += four;
    };
    Index t = 0;
    for (; t + static_cast<Index>(turns) <= rows; t += turns)
      for (std::size_t k = 0; k < turns; ++k) take(k);
    for (; t < rows; ++t) take(0);
    for (std::size_t k = 1; k < turns; ++k) {
      least[0] = (least[k] < least[0]).select(least[k], least[0]);
      most[0] = (most[k] > most[0]).select(most[k], most[0]);
      nothing[0] += nothing[k];
    }
    Four::Map(low.data()) = least[0];
    Four::Map(high.data()) = most[0] + nothing[0];
  }
};

/// sum += Σ z over blocks, which stand `stride` apart.
void add_up(const numerics::EightLines* z, Index blocks, Index stride, Index width,
            numerics::EightLines* sum) {
  for (Index b = 0; b < blocks; ++b, z += stride)
    for (Index c = 0; c < width; ++c)
      for (std::size_t k = 0; k < z->re.size(); ++k) {
        sum[c].re[k] += z[c].re[k];
        sum[c].im[k] += z[c].im[k];
      }
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

void add_pairs(const MatrixXcd& S, Index line, MatrixXd& re, MatrixXd& im) {
  for (Index i = 0, pair = 0; i < S.rows(); ++i)
    for (Index j = 0; j <= i; ++j, ++pair) {
      re(line, pair) += S(i, j).real();
      im(line, pair) += S(i, j).imag();
    }
}

}  // namespace

MatrixXcd CrossSpectra::at(Index line) const {
  return unpacked(re, im, line, static_cast<Index>(channels.size()));
}

MatrixXcd CrossSpectra::noise_at(Index line) const {
  return unpacked(noise_re, noise_im, line, static_cast<Index>(channels.size()));
}

VectorXd lag_taper(const CrossSpectra& spectra) {
  VectorXd even = lag_taper(spectra.window);
  if (spectra.input_power.size() == 0) return even;
  VectorXd rho = lag_taper(spectra.window, spectra.input_power);
  return (rho - even).cwiseAbs().maxCoeff() > spectra.options.uneven ? rho : even;
}

struct SpectrumEstimator::Implementation {
  SpectrumOptions options;
  std::vector<std::size_t> chosen;
  CrossSpectra header;  // of the result, without spectra
  std::vector<ChannelWatch> watches;
  std::vector<numerics::RealFft> ffts;  // one per thread
  Index kept_lines{};
  CrossProducts products{};        // of blocks; of their means where they are periods
  CrossProducts noise_products{};  // of periods, less those of their means
  RecordMean record_mean{};        // not of periods
  int hop{};
  Index blocks_at_once{};
  std::vector<FourChannels> buffer{};  // samples of so many blocks; channels beyond the last are 0
  Index rows{}, filled{};              // of it
  std::int64_t to_skip{};
  std::vector<numerics::EightLines> lines{};  // blocks × groups × channels
  MeansOfBlocks means{};                      // blocks × channels
  std::vector<FourChannels> squares{};        // sums over blocks; none for strips without an input
  std::vector<numerics::EightLines> period_sum{};  // of the record that is running
  std::int64_t periods{};
  std::int64_t degrees{};  // Σ (periods − 1) over records

  [[nodiscard]] Index kept_groups() const { return (kept_lines + 7) / 8; }
  void take(std::size_t strip, const Eigen::Ref<const data::Samples>& samples);
  void copy(std::size_t strip, const Eigen::Ref<const data::Samples>& samples, Index to_row);
  void watch(std::size_t strip, Index first_row, Index count);
  void transform(Index first, Index count, numerics::RealFft& fft, std::vector<char>& whole);
  std::vector<char> transform_all(Index blocks, int threads);
  void add_products(Index first_block, Index blocks, int threads);
  void add_squares(Index block);
  void take_blocks();
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
                     .header = {},
                     .watches = std::vector<ChannelWatch>(chosen.size()),
                     .ffts = {}});
  auto& me = *implementation_;
  const int n = options.block_length;
  me.ffts.emplace_back(n);
  auto& result = me.header;
  for (const std::size_t c : chosen) result.channels.push_back(header.channels.at(c));
  result.sample_rate = header.sample_rate;
  result.options = options;
  result.window = window_samples(options.periodic ? Window::rectangular : options.window, n);
  me.hop = options.periodic
               ? n
               : std::max(1, static_cast<int>(std::lround(n * (1.0 - options.overlap))));
  me.kept_lines = me.ffts[0].lines();
  if (options.lines > 0) me.kept_lines = std::min<Index>(options.lines, me.kept_lines);
  me.products = CrossProducts(static_cast<Index>(chosen.size()), me.kept_groups());
  if (options.periodic)
    me.noise_products = me.products;
  else
    me.record_mean = RecordMean(result.window, static_cast<Index>(chosen.size()), me.ffts[0]);
  const Index width = me.products.width();
  me.blocks_at_once = std::clamp<Index>(most_numbers / (n * width), 1, most_blocks);
  me.rows = n + (me.blocks_at_once - 1) * me.hop;
  me.buffer.assign(static_cast<std::size_t>((width + four - 1) / four),
                   FourChannels::Zero(me.rows, four));
  if (options.periodic) return;
  me.squares.resize(me.buffer.size());
  for (const int c : options.inputs)
    me.squares[static_cast<std::size_t>(c / four)].setZero(n, four);
}

SpectrumEstimator::~SpectrumEstimator() = default;
SpectrumEstimator::SpectrumEstimator(SpectrumEstimator&&) noexcept = default;
SpectrumEstimator& SpectrumEstimator::operator=(SpectrumEstimator&&) noexcept = default;

/// The lines of some blocks and their means, all strips of neighbours together; `whole` becomes
/// false where a sample is missing.
void SpectrumEstimator::Implementation::transform(Index first, Index count, numerics::RealFft& fft,
                                                  std::vector<char>& whole) {
  const int n = options.block_length;
  const Index stride = fft.line_groups() * products.width();
  std::vector<numerics::Strip> strips;
  for (std::size_t g = 0; g < buffer.size(); ++g) {
    strips.clear();
    const Index channel = four * static_cast<Index>(g),
                channels = std::min<Index>(four, products.width() - channel);
    for (Index b = first; b < first + count; ++b) {
      auto mean = means.row(b).segment(channel, four);
      if (whole[static_cast<std::size_t>(b)]) mean = row_mean(buffer[g], b * hop, n);
      if (!mean.allFinite()) whole[static_cast<std::size_t>(b)] = 0;
      if (whole[static_cast<std::size_t>(b)])
        strips.push_back({buffer[g].data() + four * b * hop, four, mean.data(),
                          static_cast<int>(channels), lines.data() + b * stride + channel});
    }
    fft.forward(strips, header.window, products.width());
  }
}

/// Which of the blocks in the buffer are whole. Every block is transformed by one thread.
std::vector<char> SpectrumEstimator::Implementation::transform_all(Index blocks, int threads) {
  constexpr Index neighbours = 2;
  std::vector<char> whole(static_cast<std::size_t>(blocks), 1);
  lines.resize(static_cast<std::size_t>(blocks * ffts[0].line_groups() * products.width()));
  means.setZero(blocks, four * std::ssize(buffer));
  const auto tasks = static_cast<std::size_t>((blocks + neighbours - 1) / neighbours);
  const std::size_t workers = std::min(
      tasks, static_cast<std::size_t>(threads > 0 ? threads : numerics::processor_count()));
  while (ffts.size() < workers) ffts.emplace_back(options.block_length);
  numerics::parallel_for(workers, threads, [&](std::size_t worker) {
    for (std::size_t task = worker; task < tasks; task += workers) {
      const Index first = neighbours * static_cast<Index>(task);
      transform(first, std::min(neighbours, blocks - first), ffts[worker], whole);
    }
  });
  return whole;
}

void SpectrumEstimator::Implementation::add_products(Index first_block, Index blocks, int threads) {
  constexpr Index most_pieces = 64;
  const Index groups = kept_groups(), width = products.width(),
              stride = ffts[0].line_groups() * width;
  if (options.periodic) period_sum.resize(static_cast<std::size_t>(stride));
  const Index pieces = std::min(groups, most_pieces);
  numerics::parallel_for(static_cast<std::size_t>(pieces), threads, [&](std::size_t i) {
    const auto piece = static_cast<Index>(i);
    for (Index g = piece * groups / pieces; g < (piece + 1) * groups / pieces; ++g) {
      const auto* z = lines.data() + first_block * stride + g * width;
      (options.periodic ? noise_products : products).add(g, z, blocks, stride);
      if (options.periodic) add_up(z, blocks, stride, width, period_sum.data() + g * width);
    }
  });
  if (!options.periodic)
    for (Index b = first_block; b < first_block + blocks; ++b) {
      record_mean.add(means.row(b), lines.data() + b * stride);
      add_squares(b);
    }
  periods += blocks;
  header.blocks += blocks;
}

void SpectrumEstimator::Implementation::add_squares(Index block) {
  for (std::size_t strip = 0; strip < squares.size(); ++strip) {
    auto& sums = squares[strip];
    if (sums.size() == 0) continue;
    const Eigen::Array4d mean = means.row(block).segment<four>(four * static_cast<Index>(strip));
    const double* x = buffer[strip].data() + four * block * hop;
    for (Index t = 0; t < sums.rows(); ++t, x += four)
      Eigen::Array4d::Map(sums.data() + four * t) += (Eigen::Array4d::Map(x) - mean).square();
  }
}

/// The blocks that are complete.
void SpectrumEstimator::Implementation::take_blocks() {
  const Index n = options.block_length;
  if (filled < n) return;
  const Index blocks = (filled - n) / hop + 1;
  const int threads = blocks * n * products.width() < worth_threads ? 1 : options.threads;
  const auto whole = transform_all(blocks, threads);
  for (auto from = whole.begin(); from != whole.end();) {
    const auto to = std::find_if(from, whole.end(), [&](char w) { return w != *from; });
    if (*from)
      add_products(from - whole.begin(), to - from, threads);
    else
      header.blocks_left_out += to - from;
    from = to;
  }
  const Index next = blocks * hop;
  filled -= next;
  for (auto& channels : buffer) channels.topRows(filled) = channels.middleRows(next, filled).eval();
}

/// Closes the averages of a record.
void SpectrumEstimator::Implementation::end_record() {
  take_blocks();
  if (periods > 0) {
    ++header.records;
    degrees += periods - 1;
    record_mean.end_record();
    if (options.periodic) {
      // Σ z zᴴ − m z̄ z̄ᴴ goes to the noise, z̄ z̄ᴴ to the spectra
      const auto m = static_cast<double>(periods);
      for (Index g = 0; g < kept_groups(); ++g) {
        const auto* sum = period_sum.data() + g * products.width();
        noise_products.add(g, sum, 1, 0, -1.0 / m);
        products.add(g, sum, 1, 0, 1.0 / (m * m));
      }
      period_sum.clear();
    }
  }
  periods = 0;
  filled = 0;
}

void SpectrumEstimator::begin_record(std::int64_t settling) {
  implementation_->end_record();
  implementation_->to_skip = settling;
}

void SpectrumEstimator::Implementation::copy(std::size_t strip,
                                             const Eigen::Ref<const data::Samples>& samples,
                                             Index to_row) {
  const std::size_t first = four * strip,
                    count = std::min<std::size_t>(four, chosen.size() - first);
  std::array<std::size_t, four> columns{};
  std::copy_n(chosen.begin() + static_cast<std::ptrdiff_t>(first), count, columns.begin());
  bool neighbours = count == four;
  for (std::size_t c = 1; c < four; ++c)
    neighbours = neighbours && columns[c] == columns[c - 1] + 1;
  const double* from = samples.data();
  double* to = buffer[strip].data() + four * to_row;
  for (Index t = 0; t < samples.rows(); ++t, to += four, from += samples.outerStride())
    if (neighbours)
      std::copy_n(from + columns[0], four, to);
    else
      for (std::size_t c = 0; c < count; ++c) to[c] = from[columns[c]];
}

void SpectrumEstimator::Implementation::watch(std::size_t strip, Index first_row, Index count) {
  const Extremes extremes(buffer[strip], first_row, count);
  for (std::size_t c = 0; c < four && four * strip + c < watches.size(); ++c)
    watches[four * strip + c].add(
        buffer[strip].col(static_cast<Index>(c)).segment(first_row, count), extremes.low[c],
        extremes.high[c]);
}

/// To the end of the buffer.
void SpectrumEstimator::Implementation::take(std::size_t strip,
                                             const Eigen::Ref<const data::Samples>& samples) {
  for (Index row = 0; row < samples.rows(); row += few_rows) {
    const Index count = std::min(few_rows, samples.rows() - row);
    copy(strip, samples.middleRows(row, count), filled + row);
    watch(strip, filled + row, count);
  }
}

void SpectrumEstimator::add(const Eigen::Ref<const data::Samples>& samples) {
  auto& me = *implementation_;
  Index row = std::min<Index>(samples.rows(), me.to_skip);
  me.to_skip -= row;
  while (row < samples.rows()) {
    const Index count = std::min(samples.rows() - row, me.rows - me.filled);
    const int threads = count * me.products.width() < worth_threads ? 1 : me.options.threads;
    // the strips of a few rows come from the cache where one thread takes them all
    const Index together = threads == 1 ? few_rows : count;
    for (Index first = 0; first < count; first += together) {
      const auto some = samples.middleRows(row + first, std::min(together, count - first));
      numerics::parallel_for(me.buffer.size(), threads,
                             [&](std::size_t strip) { me.take(strip, some); });
      me.filled += some.rows();
    }
    row += count;
    if (me.filled == me.rows) me.take_blocks();
  }
}

namespace {

/// Mean of the inputs' columns, each divided by its own mean.
VectorXd mean_power(const std::vector<FourChannels>& squares, const std::vector<int>& inputs) {
  VectorXd sum;
  if (squares.empty()) return sum;
  for (const int c : inputs) {
    const auto column = squares[static_cast<std::size_t>(c / four)].col(c % four);
    if (sum.size() == 0) sum.setZero(column.size());
    if (const double mean = column.mean(); mean > 0.0) sum += column / mean;
  }
  return sum.size() > 0 && sum.maxCoeff() > 0.0 ? VectorXd(sum / sum.mean()) : VectorXd();
}

}  // namespace

CrossSpectra SpectrumEstimator::result() {
  auto& me = *implementation_;
  me.end_record();
  CrossSpectra result = me.header;
  for (const auto& watch : me.watches) result.health.push_back(watch.health());
  std::vector<numerics::EightLines>().swap(me.lines);  // no longer needed, and large
  std::vector<FourChannels>().swap(me.buffer);
  VectorXd scale =
      VectorXd::Constant(me.kept_lines, 2.0 / (result.sample_rate * result.window.squaredNorm()));
  scale[0] /= 2.0;
  if (me.kept_lines == me.ffts[0].lines()) scale.tail(1) /= 2.0;
  const auto averaged = me.options.periodic ? result.records : result.blocks;
  const VectorXd share = scale / std::max(1.0, static_cast<double>(averaged));
  me.products.unpack(share, result.re, result.im);
  for (Index k = 0; k < std::min(me.record_mean.lines(), me.kept_lines); ++k)
    add_pairs(share[k] * me.record_mean.products(k), k, result.re, result.im);
  if (me.options.periodic)
    me.noise_products.unpack(scale / std::max(1.0, static_cast<double>(me.degrees)),
                             result.noise_re, result.noise_im);
  result.input_power = mean_power(me.squares, me.options.inputs);
  if (result.blocks > 0)
    result.statistics = average_statistics(result.window, me.hop, result.blocks);
  return result;
}

namespace {

/// An even length that is quick to transform: with a large prime factor it takes long.
Index quick_length(Index least) {
  const auto quarter =
      static_cast<Index>(std::bit_floor(static_cast<std::uint64_t>(std::max<Index>(8, least))) / 4);
  for (const Index factor : {4, 5, 6})
    if (factor * quarter >= least) return factor * quarter;
  return 8 * quarter;
}

}  // namespace

std::int64_t period_of(const VectorXd& samples, double tolerance) {
  const Index n = samples.size() / 2 * 2;
  if (n < 16) return 0;
  VectorXd x = bridged(samples.head(n));
  x.array() -= x.mean();
  // no sample meets another round the end: lags up to n/3 + 1 are looked at
  const Index length = quick_length(n + n / 3 + 1);
  numerics::RealFft fft(static_cast<int>(length));
  std::vector<double> padded(static_cast<std::size_t>(length), 0.0);
  VectorXd::Map(padded.data(), n) = x;
  std::vector<std::complex<double>> lines(static_cast<std::size_t>(fft.lines()));
  fft.forward(padded, lines);
  for (auto& line : lines) line = std::norm(line);
  fft.inverse(lines, padded);
  const double power = padded[0] / static_cast<double>(n);
  if (!(power > 0.0)) return 0;
  // where both samples were measured, which most must be
  const auto repeats_after = [&](Index lag) {
    double error = 0.0;
    std::int64_t pairs = 0;
    for (Index t = lag; t < n; ++t) {
      const double difference = samples[t] - samples[t - lag];
      if (!std::isfinite(difference)) continue;
      error += difference * difference;
      ++pairs;
    }
    return 2 * pairs > n - lag &&
           error <= tolerance * tolerance * power * static_cast<double>(pairs);
  };
  bool fell = false;  // away from the peak at lag 0
  for (Index lag = 2; lag <= n / 3; ++lag) {
    const auto at = [&](Index l) {
      return padded[static_cast<std::size_t>(l)] / (power * static_cast<double>(n - l));
    };
    fell = fell || at(lag) < 0.5;
    if (!fell || at(lag) < 0.9 || at(lag) < at(lag - 1) || at(lag) < at(lag + 1)) continue;
    if (repeats_after(lag)) return lag;
  }
  return 0;
}

}  // namespace hydrapod::identification
