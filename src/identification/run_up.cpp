#include "run_up.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "hydrapod/numerics/fft.hpp"
#include "hydrapod/numerics/statistics.hpp"
#include "wandering_tones.hpp"

namespace hydrapod::identification {

namespace {

/// Power of the outputs in bands and parts of the records, one after the other.
class PowerInParts {
 public:
  PowerInParts(std::int64_t total, Index channels, const RunUpOptions& options)
      : total_(total),
        fft_(block_length(total, options)),
        window_(window_samples(Window::hann, fft_.length())),
        buffer_(fft_.length(), channels),
        per_band_(std::max(options.lines_per_band, fft_.lines() / options.most_bands)),
        lines_(static_cast<std::size_t>(fft_.lines())) {
    for (Index c = 0; c < channels; ++c)
      power_.emplace_back(MatrixXd::Zero(fft_.lines() / per_band_, options.parts));
  }

  static int block_length(std::int64_t total, const RunUpOptions& options) {
    const auto part = static_cast<std::uint64_t>(total / options.parts);
    return static_cast<int>(std::bit_floor(
        std::clamp<std::uint64_t>(part, 1, static_cast<std::uint64_t>(options.longest))));
  }

  void begin_record() { filled_ = 0; }
  void add(const data::Samples& samples) {
    const Index length = buffer_.rows();
    for (Index at = 0; at < samples.rows();) {
      const Index count = std::min(length - filled_, samples.rows() - at);
      buffer_.middleRows(filled_, count) = samples.middleRows(at, count);
      at += count;
      seen_ += count;
      filled_ += count;
      if (filled_ < length) return;
      take_block();
      filled_ = length / 2;
      buffer_.topRows(filled_) = buffer_.bottomRows(filled_).eval();
    }
  }

  /// Bands × parts, the sum over the parts 1; bands without power are 0.
  [[nodiscard]] MatrixXd shares() const {
    MatrixXd sum = MatrixXd::Zero(power_[0].rows(), power_[0].cols());
    for (const auto& power : power_)
      for (Index g = 0; g < sum.rows(); ++g)
        if (const double all = power.row(g).sum(); all > 0.0) sum.row(g) += power.row(g) / all;
    return sum / static_cast<double>(power_.size());
  }
  /// Of a band [cycles per sample]: where it begins.
  [[nodiscard]] double begin_of(Index band) const {
    return static_cast<double>(band * per_band_) / fft_.length();
  }

 private:
  void take_block() {
    if (!buffer_.allFinite()) return;
    const Index parts = power_[0].cols();
    const std::int64_t middle = seen_ - buffer_.rows() / 2;
    const auto part = std::min<Index>(parts - 1, static_cast<Index>(middle * parts / total_));
    for (Index c = 0; c < buffer_.cols(); ++c) {
      VectorXd x = (buffer_.col(c).array() - buffer_.col(c).mean()) * window_.array();
      fft_.forward({x.data(), static_cast<std::size_t>(x.size())}, lines_);
      auto& power = power_[static_cast<std::size_t>(c)];
      for (Index k = 0; k < power.rows() * per_band_; ++k)
        power(k / per_band_, part) += std::norm(lines_[static_cast<std::size_t>(k)]);
    }
  }

  std::int64_t total_, seen_{};
  numerics::RealFft fft_;
  VectorXd window_;
  MatrixXd buffer_;
  Index per_band_, filled_{};
  std::vector<Complex> lines_;
  std::vector<MatrixXd> power_{};  // per channel, bands × parts
};

/// Smallest share of the parts that together hold half of the power.
double brevity(VectorXd power) {
  std::ranges::sort(power, std::greater{});
  const double half = 0.5 * power.sum();
  double held = 0.0;
  for (Index k = 0; k < power.size(); ++k) {
    if (held + power[k] >= half)
      return (static_cast<double>(k) + (half - held) / power[k]) /
             static_cast<double>(power.size());
    held += power[k];
  }
  return 1.0;
}

}  // namespace

std::optional<RunUp> find_run_up(data::RecordSet& records, const std::vector<std::size_t>& used,
                                 std::int64_t settling, const CrossSpectra& spectra,
                                 const std::vector<int>& outputs, const RunUpOptions& asked) {
  std::int64_t total = 0;
  for (std::size_t k = 0; k < records.files().size(); ++k)
    total += std::max<std::int64_t>(0, records.count_samples(k) - settling);
  auto options = asked;
  if (total / options.parts < options.short_part) options.parts /= 2;
  const auto reading = outputs_that_see_all(used, settling, spectra, outputs, options.most_outputs);
  if (reading.channels.empty() || PowerInParts::block_length(total, options) < options.shortest)
    return {};
  PowerInParts power(total, static_cast<Index>(reading.channels.size()), options);
  std::optional<std::size_t> begun;
  stream_used(records, reading,
              [&](std::size_t record, std::int64_t, const data::Samples& samples) {
                if (begun != record) power.begin_record();
                begun = record;
                power.add(samples);
              });
  const MatrixXd shares = power.shares();
  std::vector<Index> passed;
  std::vector<double> brevities;
  VectorXd mean = VectorXd::Zero(shares.cols());
  for (Index g = 1; g < shares.rows(); ++g) {  // the first one holds what is left of the mean
    const VectorXd own = shares.row(g).transpose();
    const double brief = brevity(own);
    if (!(own.sum() > 0.0) || !(brief < options.brief)) continue;
    passed.push_back(g);
    brevities.push_back(brief);
    mean += own;
  }
  if (passed.size() < options.fewest_bands ||
      static_cast<double>(passed.size()) <
          options.of_bands * static_cast<double>(passed.back() - passed.front() + 1))
    return {};
  const double usual = numerics::upper_median(brevities);
  if (!(brevity(mean) > options.apart * usual)) return {};
  return RunUp{power.begin_of(passed.front()) * spectra.sample_rate,
               power.begin_of(passed.back() + 1) * spectra.sample_rate, usual};
}

}  // namespace hydrapod::identification
