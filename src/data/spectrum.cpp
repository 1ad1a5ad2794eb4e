#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "hydrapod/base/units.hpp"
#include "hydrapod/data/processing.hpp"

namespace hydrapod::data {

WelchSpectrum::WelchSpectrum(std::size_t channels, double sample_rate, std::size_t segment)
    : sample_rate_(sample_rate), fft_(std::max(2, static_cast<int>(segment / 2 * 2))) {
  if (segment < 8 || segment % 2 != 0)
    throw std::invalid_argument(
        fmt::format("WelchSpectrum: segment is {}; must be even and 8 or more", segment));
  const auto n = static_cast<Eigen::Index>(segment);
  const auto wide = static_cast<Eigen::Index>(channels);
  window_.resize(n);
  for (Eigen::Index j = 0; j < n; ++j)
    window_[j] =
        0.5 - 0.5 * std::cos(base::two_pi * static_cast<double>(j) / static_cast<double>(n));
  segment_.setZero(n, wide);
  last_.setZero(wide);
  sum_.setZero(n / 2 + 1, wide);
}

void WelchSpectrum::take_segment() {
  const Eigen::Index n = segment_.rows();
  const Eigen::RowVectorXd mean = segment_.colwise().mean();
  const Eigen::Index channels = segment_.cols();
  std::vector<numerics::EightLines> lines(static_cast<std::size_t>(fft_.line_groups() * channels));
  fft_.forward(segment_, mean, window_, lines.data(), channels);
  for (Eigen::Index k = 0; k < sum_.rows(); ++k)
    for (Eigen::Index c = 0; c < channels; ++c) {
      const auto& group = lines[static_cast<std::size_t>((k / 8) * channels + c)];
      const double re = group.re[static_cast<std::size_t>(k % 8)],
                   im = group.im[static_cast<std::size_t>(k % 8)];
      sum_(k, c) += re * re + im * im;
    }
  ++segments_;
  segment_.topRows(n - n / 2) = segment_.bottomRows(n - n / 2).eval();
  filled_ = n - n / 2;
}

void WelchSpectrum::add(const Eigen::Ref<const Samples>& samples) {
  for (Eigen::Index row = 0; row < samples.rows(); ++row) {
    for (Eigen::Index c = 0; c < samples.cols(); ++c)
      if (std::isfinite(samples(row, c))) last_[c] = samples(row, c);
    segment_.row(filled_) = last_;
    if (++filled_ == segment_.rows()) take_segment();
  }
}

Spectrum WelchSpectrum::result() const {
  const Eigen::Index n = segment_.rows();
  const double scale = 1.0 / (sample_rate_ * window_.squaredNorm() *
                              static_cast<double>(std::max<std::int64_t>(segments_, 1)));
  Spectrum spectrum{.frequency = Eigen::VectorXd::LinSpaced(n / 2 + 1, 0.0, sample_rate_ / 2.0),
                    .density = 2.0 * scale * sum_,
                    .segments = segments_};
  spectrum.density.row(0) /= 2.0;
  spectrum.density.row(n / 2) /= 2.0;
  return spectrum;
}

}  // namespace hydrapod::data
