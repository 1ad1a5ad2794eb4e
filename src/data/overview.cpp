#include "hydrapod/data/processing.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace hydrapod::data {

struct OverviewBuilder::Implementation {
  /// Samples in runs of three or more at the most extreme value so far.
  class Extreme {
   public:
    explicit Extreme(double sign) : sign_(sign) {}

    void add(double value) {
      const double here = sign_ * value;
      if (here > extreme_) {
        extreme_ = here;
        run_ = 1;
        at_limit_ = 0;
      } else if (here == extreme_) {
        ++run_;
        if (run_ == least_run) at_limit_ += least_run;
        if (run_ > least_run) ++at_limit_;
      } else {
        run_ = 0;
      }
    }
    [[nodiscard]] double value() const { return sign_ * extreme_; }
    [[nodiscard]] std::int64_t at_limit() const { return at_limit_; }

   private:
    static constexpr std::int64_t least_run = 3;
    double sign_;
    double extreme_{-std::numeric_limits<double>::infinity()};
    std::int64_t run_{}, at_limit_{};
  };

  /// One channel; mean and variance after B. P. Welford, Technometrics 4 (1962) 419.
  struct Account {
    std::int64_t samples{}, missing{}, infinite{};
    double mean{}, squares{};
    Extreme lowest{-1.0}, highest{1.0};
    double last{std::numeric_limits<double>::quiet_NaN()};
    std::int64_t run{}, longest{};

    void add(double value) {
      if (std::isnan(value)) {
        ++missing;
        return;
      }
      if (std::isinf(value)) {
        ++infinite;
        return;
      }
      ++samples;
      const double step = value - mean;
      mean += step / static_cast<double>(samples);
      squares += step * (value - mean);
      lowest.add(value);
      highest.add(value);
      run = value == last ? run + 1 : 1;
      longest = std::max(longest, run);
      last = value;
    }

    [[nodiscard]] ChannelOverview result() const {
      ChannelOverview all{.samples = samples, .missing = missing, .infinite = infinite};
      if (samples == 0) return all;
      all.mean = mean;
      all.rms = std::sqrt(squares / static_cast<double>(samples));
      all.lowest = lowest.value();
      all.highest = highest.value();
      all.peak = std::max(all.highest - mean, mean - all.lowest);
      all.constant = all.lowest == all.highest;
      if (all.constant) return all;
      all.at_limit = lowest.at_limit() + highest.at_limit();
      all.longest_hold = longest;
      return all;
    }
  };

  double sample_rate{};
  std::int64_t samples{};
  std::vector<Account> accounts{};
  WelchSpectrum spectrum;
};

OverviewBuilder::OverviewBuilder(const RecordHeader& header, std::size_t segment)
    : implementation_(new Implementation{
          header.sample_rate, 0, std::vector<Implementation::Account>(header.channels.size()),
          WelchSpectrum(header.channels.size(), header.sample_rate, segment)}) {}

OverviewBuilder::~OverviewBuilder() = default;

void OverviewBuilder::add(const Eigen::Ref<const Samples>& samples) {
  implementation_->samples += samples.rows();
  for (Eigen::Index row = 0; row < samples.rows(); ++row)
    for (Eigen::Index c = 0; c < samples.cols(); ++c)
      implementation_->accounts[static_cast<std::size_t>(c)].add(samples(row, c));
  implementation_->spectrum.add(samples);
}

RecordOverview OverviewBuilder::result() const {
  RecordOverview all;
  all.samples = implementation_->samples;
  all.duration = static_cast<double>(all.samples) / implementation_->sample_rate;
  for (const auto& account : implementation_->accounts) all.channels.push_back(account.result());
  all.spectrum = implementation_->spectrum.result();
  if (all.spectrum.segments == 0) return all;
  for (std::size_t c = 0; c < all.channels.size(); ++c) {
    if (all.channels[c].constant) continue;
    Eigen::Index strongest = 0;
    const auto column = all.spectrum.density.col(static_cast<Eigen::Index>(c));
    column.tail(column.size() - 1).maxCoeff(&strongest);
    all.channels[c].strongest_frequency = all.spectrum.frequency[strongest + 1];
  }
  return all;
}

std::size_t default_segment(const RecordHeader& header, std::optional<std::int64_t> samples) {
  constexpr double line_spacing = 0.5;  // [Hz]
  const double wanted = std::clamp(header.sample_rate / line_spacing, 64.0, 65536.0);
  std::size_t segment = std::bit_ceil(static_cast<std::size_t>(wanted));
  constexpr std::int64_t least_segments = 8;
  while (samples && segment > 64 &&
         static_cast<std::int64_t>(segment) * least_segments / 2 > *samples)
    segment /= 2;
  return segment;
}

}  // namespace hydrapod::data
