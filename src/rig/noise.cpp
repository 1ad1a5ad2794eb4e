/// White and shaped noise.

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "hydrapod/simulation/gaussian.hpp"
#include "sources.hpp"

namespace hydrapod::rig {

namespace {

using simulation::Gaussian;

std::vector<Gaussian> random_streams(const SourceContext& context) {
  std::vector<Gaussian> streams;
  for (std::uint64_t i = 0; i < 6; ++i) streams.emplace_back(context.seed, context.stream + i);
  return streams;
}

class WhiteSource final : public SignalSource {
 public:
  WhiteSource(const WhiteNoise& spec, const SourceContext& context)
      : spec_(spec), context_(context), random_(random_streams(context)) {}
  void restart() override { random_ = random_streams(context_); }
  void add_next(Vector6& sample) override {
    for (int i = 0; i < 6; ++i)
      if (spec_.rms[i] != 0.0) sample[i] += spec_.rms[i] * random_[static_cast<std::size_t>(i)]();
  }

 private:
  WhiteNoise spec_;
  SourceContext context_;
  std::vector<Gaussian> random_;
};

/// Linear-phase filter of unit noise gain, Σ h² = 1, by frequency sampling under a Blackman window
/// (main lobe 6 rate/taps wide).
Eigen::VectorXd shaping_filter(const ShapedNoise& spec, double rate) {
  const double edge = spec.from > 0.0 ? std::min(spec.from / 4.0, spec.to / 20.0) : spec.to / 20.0;
  const auto taps =
      static_cast<Eigen::Index>(std::clamp(std::ceil(6.0 * rate / edge), 64.0, 65536.0));
  const auto grid = static_cast<Eigen::Index>(std::bit_ceil(static_cast<std::size_t>(4 * taps)));
  Eigen::VectorXcd shape = Eigen::VectorXcd::Zero(grid);
  for (Eigen::Index k = 0; k <= grid / 2; ++k) {
    const double f = rate * static_cast<double>(k) / static_cast<double>(grid);
    if (f < spec.from || f > spec.to) continue;
    const double octaves = std::log2(std::max(f, 1e-3 * spec.to) / spec.to);
    shape[k] = std::pow(10.0, spec.slope * octaves / 20.0);
    if (k > 0 && k < grid / 2) shape[grid - k] = shape[k];
  }
  Eigen::FFT<double> fft;
  Eigen::VectorXcd response;
  fft.inv(response, shape);
  Eigen::VectorXd h(taps);
  for (Eigen::Index j = 0; j < taps; ++j) {
    const double u =
        2.0 * std::numbers::pi * (static_cast<double>(j) + 0.5) / static_cast<double>(taps);
    h[j] = response[(j - taps / 2 + grid) % grid].real() *
           (0.42 - 0.5 * std::cos(u) + 0.08 * std::cos(2.0 * u));
  }
  return h / h.norm();
}

/// White noise through the filter, by overlap and save: blocks of the transform's length less the
/// filter's.
class ShapedSource final : public SignalSource {
 public:
  ShapedSource(const ShapedNoise& spec, const SourceContext& context)
      : spec_(spec), context_(context) {
    const Eigen::VectorXd h = shaping_filter(spec, context.rate);
    taps_ = h.size();
    length_ = static_cast<Eigen::Index>(std::bit_ceil(static_cast<std::size_t>(4 * taps_)));
    block_ = length_ - taps_ + 1;
    Eigen::VectorXd padded = Eigen::VectorXd::Zero(length_);
    padded.head(taps_) = h;
    fft_.fwd(response_, padded);
    restart();
  }

  void restart() override {
    random_ = random_streams(context_);
    at_ = block_;
    for (std::size_t i = 0; i < 6; ++i) {
      input_[i].setZero(length_);
      for (Eigen::Index j = block_; j < length_; ++j) input_[i][j] = random_[i]();
    }
  }

  void add_next(Vector6& sample) override {
    if (at_ == block_) make_block();
    for (int i = 0; i < 6; ++i)
      if (spec_.rms[i] != 0.0)
        sample[i] += spec_.rms[i] * output_[static_cast<std::size_t>(i)][at_];
    ++at_;
  }

 private:
  void make_block() {
    Eigen::VectorXcd line;
    Eigen::VectorXd filtered;
    for (std::size_t i = 0; i < 6; ++i) {
      if (spec_.rms[static_cast<int>(i)] == 0.0) continue;
      Eigen::VectorXd& input = input_[i];
      input.head(taps_ - 1) = input.tail(taps_ - 1).eval();
      for (Eigen::Index j = taps_ - 1; j < length_; ++j) input[j] = random_[i]();
      fft_.fwd(line, input);
      line = line.cwiseProduct(response_);
      fft_.inv(filtered, line);
      output_[i] = filtered.tail(block_);
    }
    at_ = 0;
  }

  ShapedNoise spec_;
  SourceContext context_;
  Eigen::FFT<double> fft_;
  Eigen::VectorXcd response_;
  Eigen::Index taps_{}, length_{}, block_{}, at_{};
  std::vector<Gaussian> random_;
  std::array<Eigen::VectorXd, 6> input_{}, output_{};
};

}  // namespace

std::unique_ptr<SignalSource> make_source(const WhiteNoise& spec, const SourceContext& context) {
  require_levels("white noise", spec.rms);
  return std::make_unique<WhiteSource>(spec, context);
}

std::unique_ptr<SignalSource> make_source(const ShapedNoise& spec, const SourceContext& context) {
  require_levels("noise", spec.rms);
  require_band("noise", spec.from, spec.to, context.rate, true);
  require(spec.to > spec.from, "noise: to", spec.to, "more than `from`");
  require(std::abs(spec.slope) <= 24.0, "noise: slope", spec.slope, "−24 … 24 dB/octave");
  return std::make_unique<ShapedSource>(spec, context);
}

}  // namespace hydrapod::rig
