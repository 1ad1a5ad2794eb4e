/// White noise and noise in a band.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "hydrapod/base/units.hpp"
#include "hydrapod/numerics/fft.hpp"
#include "sources.hpp"

namespace hydrapod::signals {

namespace {

using base::two_pi;
using numerics::Gaussian;
using numerics::RealFft;

Eigen::VectorXcd lines_of(RealFft& fft, const Eigen::VectorXd& samples) {
  Eigen::VectorXcd lines(fft.lines());
  fft.forward({samples.data(), static_cast<std::size_t>(samples.size())},
              {lines.data(), static_cast<std::size_t>(lines.size())});
  return lines;
}

Eigen::VectorXd samples_of(RealFft& fft, const Eigen::VectorXcd& lines) {
  Eigen::VectorXd samples(fft.length());
  fft.inverse({lines.data(), static_cast<std::size_t>(lines.size())},
              {samples.data(), static_cast<std::size_t>(samples.size())});
  return samples;
}

std::vector<Gaussian> random_streams(const Context& context) {
  std::vector<Gaussian> streams;
  for (std::size_t i = 0; i < 6; ++i) streams.push_back(context.random(i));
  return streams;
}

/// The impulse response of a filter and its derivative, at the samples.
struct Filter {
  Eigen::VectorXd value{}, rate{};
};

/// Linear-phase filter of unit noise gain, Σ h² = 1, by frequency sampling under a Blackman window
/// (main lobe 6 rate/taps wide). The derivative is that of the sum of cosines under the window, so
/// that the rate is the one of the signal between its samples, too.
Filter shaping_filter(const Noise& noise, double rate) {
  const double edge =
      noise.from > 0.0 ? std::min(noise.from / 4.0, noise.to / 20.0) : noise.to / 20.0;
  const auto taps =
      static_cast<Eigen::Index>(std::clamp(std::ceil(6.0 * rate / edge), 64.0, 65536.0));
  const auto grid = static_cast<Eigen::Index>(std::bit_ceil(static_cast<std::size_t>(4 * taps)));
  Eigen::VectorXcd shape = Eigen::VectorXcd::Zero(grid / 2 + 1), shape_rate = shape;
  for (Eigen::Index k = 0; k < grid / 2; ++k) {
    const double f = rate * static_cast<double>(k) / static_cast<double>(grid);
    if (f < noise.from || f > noise.to) continue;
    const double octaves = std::log2(std::max(f, 1e-3 * noise.to) / noise.to);
    shape[k] = std::pow(10.0, noise.slope * octaves / 20.0);
    shape_rate[k] = std::complex<double>(0.0, two_pi * f) * shape[k];
  }
  RealFft fft(static_cast<int>(grid));
  const auto response = samples_of(fft, shape), response_rate = samples_of(fft, shape_rate);
  Filter filter{Eigen::VectorXd(taps), Eigen::VectorXd(taps)};
  for (Eigen::Index j = 0; j < taps; ++j) {
    const double u = two_pi * (static_cast<double>(j) + 0.5) / static_cast<double>(taps);
    const double window = 0.42 - 0.5 * std::cos(u) + 0.08 * std::cos(2.0 * u);
    const double window_rate =
        two_pi * rate / static_cast<double>(taps) * (0.5 * std::sin(u) - 0.16 * std::sin(2.0 * u));
    const Eigen::Index at = (j - taps / 2 + grid) % grid;
    filter.value[j] = response[at] * window;
    filter.rate[j] = response_rate[at] * window + response[at] * window_rate;
  }
  const double norm = filter.value.norm();
  filter.rate /= norm;
  filter.value /= norm;
  return filter;
}

/// White noise through the filter, by overlap and save: blocks of the transform's length less the
/// filter's.
class NoiseSource {
 public:
  NoiseSource(const Noise& noise, const Context& context) : context_(context) {
    const Filter filter = shaping_filter(noise, context.rate);
    taps_ = filter.value.size();
    length_ = static_cast<Eigen::Index>(std::bit_ceil(static_cast<std::size_t>(4 * taps_)));
    block_ = length_ - taps_ + 1;
    Eigen::VectorXd padded = Eigen::VectorXd::Zero(length_);
    RealFft fft(static_cast<int>(length_));
    padded.head(taps_) = filter.value;
    response_ = lines_of(fft, padded);
    padded.head(taps_) = filter.rate;
    response_rate_ = lines_of(fft, padded);
  }

  Sample operator()(long k) {
    if (k == 0) {
      at_ = 0;
      if (blocks_ > 1) blocks_ = 0;  // else the first one is still there
    }
    if (at_ == block_ || blocks_ == 0) make_block();
    Sample sample;
    for (int i = 0; i < 6; ++i) {
      if (context_.size[i] == 0.0) continue;
      const auto& output = outputs_[static_cast<std::size_t>(i)];
      sample.value[i] = context_.size[i] * output.value[at_];
      sample.rate[i] = context_.size[i] * output.rate[at_];
    }
    ++at_;
    return sample;
  }

 private:
  void make_block() {
    if (blocks_ == 0) random_ = random_streams(context_);
    RealFft fft(static_cast<int>(length_));
    for (std::size_t i = 0; i < 6; ++i) {
      if (context_.size[static_cast<int>(i)] == 0.0) continue;
      Eigen::VectorXd& input = inputs_[i];
      input.conservativeResize(length_);
      if (blocks_ == 0)
        for (Eigen::Index j = 0; j < taps_ - 1; ++j) input[j] = random_[i]();
      else
        input.head(taps_ - 1) = input.tail(taps_ - 1).eval();
      for (Eigen::Index j = taps_ - 1; j < length_; ++j) input[j] = random_[i]();
      const auto line = lines_of(fft, input);
      outputs_[i].value = samples_of(fft, line.cwiseProduct(response_)).tail(block_);
      outputs_[i].rate = samples_of(fft, line.cwiseProduct(response_rate_)).tail(block_);
    }
    at_ = 0;
    ++blocks_;
  }

  Context context_;
  Eigen::VectorXcd response_, response_rate_;
  Eigen::Index taps_{}, length_{}, block_{}, at_{};
  long blocks_{};
  std::vector<Gaussian> random_{};
  std::array<Eigen::VectorXd, 6> inputs_{};
  std::array<Filter, 6> outputs_{};
};

}  // namespace

Source make_source(const White& /*flat*/, const Context& context) {
  return [context, random = random_streams(context)](long k) mutable {
    if (k == 0) random = random_streams(context);
    Sample sample;
    for (int i = 0; i < 6; ++i)
      if (context.size[i] != 0.0)
        sample.value[i] = context.size[i] * random[static_cast<std::size_t>(i)]();
    return sample;
  };
}

Source make_source(const Noise& noise, const Context& context) {
  return NoiseSource(noise, context);
}

}  // namespace hydrapod::signals
