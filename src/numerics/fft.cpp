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

namespace {

/// Where the channels of a block go, from channel `first` on.
struct Destination {
  EightLines* lines;
  Eigen::Index apart;

  void put(Eigen::Index line, Eigen::Index channel, double re, double im) const {
    auto& eight = lines[line / 8 * apart + channel];
    eight.re[static_cast<std::size_t>(line % 8)] = re;
    eight.im[static_cast<std::size_t>(line % 8)] = im;
  }
};

/// `count` numbers, at most four; the other lanes are zero.
inline void load(const double* from, Eigen::Index count, Lanes& to) {
  if (count >= lane_count) {
    std::memcpy(&to, from, sizeof to);
    return;
  }
  to = Lanes{};
  for (Eigen::Index lane = 0; lane < count; ++lane) to[lane] = from[lane];
}

void load_pairs(const Eigen::Ref<const RealFft::Block>& samples, const Eigen::RowVectorXd& mean,
                const Eigen::VectorXd& window, Eigen::Index first, Eigen::Index count,
                std::vector<ComplexLanes>& pairs) {
  Lanes average, even, odd;
  load(mean.data() + first, count, average);
  const double* row = samples.data() + first;
  for (std::size_t t = 0; t < pairs.size(); ++t, row += 2 * samples.outerStride()) {
    load(row, count, even);
    load(row + samples.outerStride(), count, odd);
    pairs[t].re = (even - average) * window[static_cast<Eigen::Index>(2 * t)];
    pairs[t].im = (odd - average) * window[static_cast<Eigen::Index>(2 * t + 1)];
  }
}

/// The lines of at most four channels.
void store_lines(const LaneFft& fft, int half, Eigen::Index count, const Destination& to) {
  int k = 0;
  for (; k + lane_count <= half; k += lane_count) {
    std::array<ComplexLanes, lane_count> lanes;
    fft.four_lines(k, lanes);
    EightLines* eight = to.lines + k / 8 * to.apart;
    for (Eigen::Index lane = 0; lane < count; ++lane) {
      const auto& values = lanes[static_cast<std::size_t>(lane)];
      std::memcpy(eight[lane].re.data() + k % 8, &values.re, sizeof values.re);
      std::memcpy(eight[lane].im.data() + k % 8, &values.im, sizeof values.im);
    }
  }
  for (; k <= half; ++k) {
    ComplexLanes line;
    fft.line(k, line);
    for (int lane = 0; lane < count; ++lane) to.put(k, lane, line.re[lane], line.im[lane]);
  }
}

}  // namespace

void RealFft::forward(const Eigen::Ref<const Block>& samples, const Eigen::RowVectorXd& mean,
                      const Eigen::VectorXd& window, EightLines* lines, Eigen::Index apart) {
  if (samples.rows() != length() || window.size() != length() || mean.size() != samples.cols())
    throw std::invalid_argument("block and window must have the transform's length");
  for (Eigen::Index c = 0; c < samples.cols(); ++c) lines[(line_groups() - 1) * apart + c] = {};
  auto& lanes = implementation_->lanes;
  if (length() >= 4 && std::has_single_bit(static_cast<unsigned>(length()))) {
    if (!lanes) lanes.emplace(length());
    for (Eigen::Index c = 0; c < samples.cols(); c += lane_count) {
      const Eigen::Index count = std::min<Eigen::Index>(lane_count, samples.cols() - c);
      load_pairs(samples, mean, window, c, count, lanes->pairs());
      lanes->run();
      store_lines(*lanes, length() / 2, count, {lines + c, apart});
    }
    return;
  }
  std::vector<std::complex<double>> spectrum(static_cast<std::size_t>(this->lines()));
  for (Eigen::Index c = 0; c < samples.cols(); ++c) {
    const Eigen::VectorXd column = (samples.col(c).array() - mean[c]) * window.array();
    forward({column.data(), static_cast<std::size_t>(column.size())}, spectrum);
    const Destination to{lines + c, apart};
    for (std::size_t k = 0; k < spectrum.size(); ++k)
      to.put(static_cast<Eigen::Index>(k), 0, spectrum[k].real(), spectrum[k].imag());
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
