#include "hydrapod/numerics/fft.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
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

void RealFft::forward(const Eigen::Ref<const Block>& samples, const Eigen::RowVectorXd& mean,
                      const Eigen::VectorXd& window, EightLines* lines, Eigen::Index apart) {
  if (samples.rows() != length() || mean.size() != samples.cols())
    throw std::invalid_argument("block and window must have the transform's length");
  std::vector<Strip> strips;
  const Eigen::Index whole = samples.cols() / strip_lanes * strip_lanes,
                     rest = samples.cols() - whole;
  for (Eigen::Index c = 0; c < whole; c += strip_lanes)
    strips.push_back(
        {samples.data() + c, samples.outerStride(), mean.data() + c, strip_lanes, lines + c});
  Block padded;  // nothing is read beyond the last sample
  if (rest > 0) {
    padded.setZero(samples.rows(), strip_lanes);
    padded.leftCols(rest) = samples.rightCols(rest);
    strips.push_back(
        {padded.data(), strip_lanes, mean.data() + whole, static_cast<int>(rest), lines + whole});
  }
  forward(strips, window, apart);
}

void RealFft::forward(std::span<const Strip> strips, const Eigen::VectorXd& window,
                      Eigen::Index apart) {
  if (window.size() != length())
    throw std::invalid_argument("block and window must have the transform's length");
  if (length() >= 4 && std::has_single_bit(static_cast<unsigned>(length()))) {
    auto& lanes = implementation_->lanes;
    if (!lanes) lanes.emplace(length());
    for (std::size_t s = 0; s < strips.size(); s += strips_together)
      lanes->forward(strips.subspan(s, std::min<std::size_t>(strips_together, strips.size() - s)),
                     window, apart);
    return;
  }
  std::vector<double> column(static_cast<std::size_t>(length()));
  std::vector<std::complex<double>> spectrum(static_cast<std::size_t>(lines()));
  for (const Strip& strip : strips)
    for (int c = 0; c < strip.channels; ++c) {
      for (std::size_t t = 0; t < column.size(); ++t)
        column[t] =
            (strip.samples[static_cast<Eigen::Index>(t) * strip.apart + c] - strip.mean[c]) *
            window[static_cast<Eigen::Index>(t)];
      forward(column, spectrum);
      strip.lines[(line_groups() - 1) * apart + c] = {};
      for (std::size_t k = 0; k < spectrum.size(); ++k) {
        auto& eight = strip.lines[static_cast<Eigen::Index>(k / 8) * apart + c];
        eight.re[k % 8] = spectrum[k].real();
        eight.im[k % 8] = spectrum[k].imag();
      }
    }
}

struct SeriesFft::Implementation {
  int length;
  LaneFft lanes{2 * length};
};

SeriesFft::SeriesFft(int length) {
  if (length < 2 || !std::has_single_bit(static_cast<unsigned>(length)))
    throw std::invalid_argument(
        fmt::format("series have a power of two as their length, at least 2, not {}", length));
  implementation_ = std::make_unique<Implementation>(Implementation{.length = length});
}

SeriesFft::~SeriesFft() = default;
SeriesFft::SeriesFft(SeriesFft&&) noexcept = default;

RealFft::Block SeriesFft::powers(const Eigen::Ref<const Eigen::MatrixXcd>& series) {
  const int n = implementation_->length;
  if (series.rows() > n)
    throw std::invalid_argument(fmt::format("series of {} are longer than {}", series.rows(), n));
  RealFft::Block result(n, series.cols());
  for (Eigen::Index c = 0; c < series.cols(); c += lane_count)
    implementation_->lanes.powers(series, c, result);
  return result;
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
