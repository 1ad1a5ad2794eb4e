#include "hydrapod/numerics/fft.hpp"

#include <fmt/format.h>

#include <bit>
#include <optional>
#include <stdexcept>
#include <unsupported/Eigen/FFT>

#include "lane_fft.hpp"

namespace hydrapod::numerics {

struct RealFft::Implementation {
  int length;
  Eigen::FFT<double> fft{Eigen::default_fft_impl<double>(), Eigen::FFT<double>::HalfSpectrum};
  std::optional<LaneFft> lanes{};
};

RealFft::RealFft(int length) {
  if (length < 2 || length % 2 != 0)
    throw std::invalid_argument(
        fmt::format("a real transform has an even length of at least 2, not {}", length));
  implementation_ = std::make_unique<Implementation>(Implementation{.length = length});
}

RealFft::~RealFft() = default;
RealFft::RealFft(RealFft&&) noexcept = default;
RealFft& RealFft::operator=(RealFft&&) noexcept = default;

int RealFft::length() const { return implementation_->length; }

void RealFft::forward(std::span<const double> samples, std::span<std::complex<double>> spectrum) {
  if (static_cast<int>(samples.size()) != length() || static_cast<int>(spectrum.size()) != lines())
    throw std::invalid_argument("samples and lines must have the transform's length");
  implementation_->fft.fwd(spectrum.data(), samples.data(), length());
}

void RealFft::inverse(std::span<const std::complex<double>> spectrum, std::span<double> samples) {
  if (static_cast<int>(samples.size()) != length() || static_cast<int>(spectrum.size()) != lines())
    throw std::invalid_argument("samples and lines must have the transform's length");
  implementation_->fft.inv(samples.data(), spectrum.data(), length());
}

namespace {

/// Four channels from `first` on; those beyond the last are zero.
void transform_lanes(LaneFft& fft, const Eigen::Ref<const RealFft::Block>& samples,
                     Eigen::Index first, Lines& lines) {
  const Eigen::Index count = std::min<Eigen::Index>(lane_count, samples.cols() - first);
  auto& pairs = fft.pairs();
  for (std::size_t t = 0; t < pairs.size(); ++t) {
    const double* even = samples.data() + static_cast<Eigen::Index>(2 * t) * samples.outerStride();
    const double* odd = even + samples.outerStride();
    for (int lane = 0; lane < lane_count; ++lane) {
      pairs[t].re[lane] = lane < count ? even[first + lane] : 0.0;
      pairs[t].im[lane] = lane < count ? odd[first + lane] : 0.0;
    }
  }
  fft.run();
  for (Eigen::Index k = 0; k < lines.re.rows(); ++k) {
    ComplexLanes line;
    fft.line(static_cast<int>(k), line);
    for (int lane = 0; lane < count; ++lane) {
      lines.re(k, first + lane) = line.re[lane];
      lines.im(k, first + lane) = line.im[lane];
    }
  }
}

}  // namespace

void RealFft::forward(const Eigen::Ref<const Block>& samples, Lines& lines) {
  if (samples.rows() != length())
    throw std::invalid_argument("a block must have the transform's length");
  lines.re.resize(this->lines(), samples.cols());
  lines.im.resize(this->lines(), samples.cols());
  auto& lanes = implementation_->lanes;
  if (length() >= 4 && std::has_single_bit(static_cast<unsigned>(length()))) {
    if (!lanes) lanes.emplace(length());
    for (Eigen::Index c = 0; c < samples.cols(); c += lane_count)
      transform_lanes(*lanes, samples, c, lines);
    return;
  }
  std::vector<std::complex<double>> spectrum(static_cast<std::size_t>(this->lines()));
  for (Eigen::Index c = 0; c < samples.cols(); ++c) {
    const Eigen::VectorXd column = samples.col(c);
    forward({column.data(), static_cast<std::size_t>(column.size())}, spectrum);
    const auto all = Eigen::VectorXcd::Map(spectrum.data(), this->lines());
    lines.re.col(c) = all.real();
    lines.im.col(c) = all.imag();
  }
}

namespace {

std::vector<std::complex<double>> transformed(const std::vector<std::complex<double>>& from,
                                              bool inverse) {
  if (from.empty()) throw std::invalid_argument("nothing to transform");
  static thread_local Eigen::FFT<double> fft{Eigen::default_fft_impl<double>(),
                                             Eigen::FFT<double>::Unscaled};
  std::vector<std::complex<double>> to(from.size());
  const auto length = static_cast<Eigen::Index>(from.size());
  inverse ? fft.inv(to.data(), from.data(), length) : fft.fwd(to.data(), from.data(), length);
  return to;
}

}  // namespace

std::vector<std::complex<double>> complex_fft(const std::vector<std::complex<double>>& samples) {
  return transformed(samples, false);
}

std::vector<std::complex<double>> inverse_complex_fft(
    const std::vector<std::complex<double>>& lines) {
  return transformed(lines, true);
}

}  // namespace hydrapod::numerics
