#include "hydrapod/data/spectrum.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <stdexcept>
#include <unsupported/Eigen/FFT>

#include "hydrapod/base/constants.hpp"

namespace hydrapod::data {

struct WelchSpectrum::Implementation {
  double sample_rate{};
  Eigen::VectorXd window{};
  Eigen::MatrixXd segment{};  ///< sample × channel
  Eigen::Index filled{};
  Eigen::VectorXd last{};  ///< good sample of each channel
  Eigen::MatrixXd sum{};
  std::int64_t segments{};
  Eigen::FFT<double> fft{};
  Eigen::VectorXd windowed{};
  Eigen::VectorXcd line{};

  void take_segment() {
    const Eigen::Index n = segment.rows();
    for (Eigen::Index c = 0; c < segment.cols(); ++c) {
      windowed = window.cwiseProduct((segment.col(c).array() - segment.col(c).mean()).matrix());
      fft.fwd(line, windowed);
      sum.col(c) += line.head(n / 2 + 1).cwiseAbs2();
    }
    ++segments;
    segment.topRows(n - n / 2) = segment.bottomRows(n - n / 2).eval();
    filled = n - n / 2;
  }
};

WelchSpectrum::WelchSpectrum(std::size_t channels, double sample_rate, std::size_t segment)
    : implementation_(std::make_unique<Implementation>()) {
  if (segment < 8 || segment % 2 != 0)
    throw std::invalid_argument(
        fmt::format("WelchSpectrum: segment is {}; must be even and 8 or more", segment));
  const auto n = static_cast<Eigen::Index>(segment);
  const auto wide = static_cast<Eigen::Index>(channels);
  Implementation& all = *implementation_;
  all.sample_rate = sample_rate;
  all.window.resize(n);
  for (Eigen::Index j = 0; j < n; ++j)
    all.window[j] =
        0.5 - 0.5 * std::cos(base::two_pi * static_cast<double>(j) / static_cast<double>(n));
  all.segment.setZero(n, wide);
  all.last.setZero(wide);
  all.sum.setZero(n / 2 + 1, wide);
}

WelchSpectrum::~WelchSpectrum() = default;
WelchSpectrum::WelchSpectrum(WelchSpectrum&&) noexcept = default;
WelchSpectrum& WelchSpectrum::operator=(WelchSpectrum&&) noexcept = default;

void WelchSpectrum::add(const Eigen::Ref<const Samples>& samples) {
  Implementation& all = *implementation_;
  for (Eigen::Index row = 0; row < samples.rows(); ++row) {
    for (Eigen::Index c = 0; c < samples.cols(); ++c) {
      const double value = samples(row, c);
      if (std::isfinite(value)) all.last[c] = value;
      all.segment(all.filled, c) = all.last[c];
    }
    if (++all.filled == all.segment.rows()) all.take_segment();
  }
}

Spectrum WelchSpectrum::result() const {
  const Implementation& all = *implementation_;
  const Eigen::Index n = all.segment.rows();
  Spectrum spectrum;
  spectrum.segments = all.segments;
  spectrum.frequency = Eigen::VectorXd::LinSpaced(n / 2 + 1, 0.0, all.sample_rate / 2.0);
  const double scale = 1.0 / (all.sample_rate * all.window.squaredNorm() *
                              static_cast<double>(std::max<std::int64_t>(all.segments, 1)));
  spectrum.density = 2.0 * scale * all.sum;
  spectrum.density.row(0) /= 2.0;
  spectrum.density.row(n / 2) /= 2.0;
  return spectrum;
}

}  // namespace hydrapod::data
