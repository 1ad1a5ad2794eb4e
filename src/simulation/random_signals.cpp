/// Multisines and band-limited noise.

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>

#include "hydrapod/simulation/gaussian.hpp"
#include "signals.hpp"

namespace hydrapod::simulation {

namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr long longest_period = 10'000'000;  // [samples]

/// Sines at whole numbers of cycles per period: their values come from one table of the circle, so
/// that every period is the same to the bit.
class MultisineSignal final : public Signal {
 public:
  MultisineSignal(const Multisine& spec, double sample_time)
      : sample_time_(sample_time), fade_(spec.fade) {
    size_ = std::lround(spec.period / sample_time);
    const double base = 1.0 / (static_cast<double>(size_) * sample_time);
    // Bands that end on a line include it, whatever rounding says.
    first_ = std::max(1L, static_cast<long>(std::ceil(spec.from / base - 1e-6)));
    const long last = static_cast<long>(std::floor(spec.to / base + 1e-6));
    require(last >= first_, "multisine: period", spec.period,
            "one so long that a multiple of 1/period lies in the band");
    lines_ = last - first_ + 1;
    omega_ = two_pi * base;
    circle_.resize(static_cast<size_t>(size_));
    for (long m = 0; m < size_; ++m)
      circle_[static_cast<size_t>(m)] =
          std::polar(1.0, two_pi * static_cast<double>(m) / static_cast<double>(size_));
    for (int direction = 0; direction < 6; ++direction) {
      Gaussian random(spec.seed, static_cast<std::uint64_t>(direction));
      const double amplitude = spec.rms[direction] * std::sqrt(2.0 / static_cast<double>(lines_));
      for (long line = 0; line < lines_; ++line)
        coefficients_[direction].push_back(amplitude * std::polar(1.0, two_pi * random.uniform()));
      active_[direction] = amplitude != 0.0;
    }
  }

  void restart() override { sample_ = 0; }

  Displacement next() override {
    const double time = sample_time_ * static_cast<double>(sample_);
    const long at = sample_++ % size_;
    Displacement sum;
    for (long line = 0; line < lines_; ++line) {
      const long cycles = first_ + line;
      const auto turn = circle_[static_cast<size_t>(cycles * at % size_)];
      const double omega = omega_ * static_cast<double>(cycles);
      for (int direction = 0; direction < 6; ++direction) {
        if (!active_[direction]) continue;
        const auto term = coefficients_[direction][static_cast<size_t>(line)] * turn;
        sum.value[direction] += term.imag();
        sum.rate[direction] += omega * term.real();
      }
    }
    return faded(sum, fade_at(time, fade_));
  }

 private:
  double sample_time_, fade_, omega_{};
  long size_{}, first_{}, lines_{}, sample_{};
  std::vector<std::complex<double>> circle_{};
  std::array<std::vector<std::complex<double>>, 6> coefficients_{};
  std::array<bool, 6> active_{};
};

using Filter = Eigen::Matrix<double, 6, 6>;
using FilterState = Eigen::Matrix<double, 6, 1>;

/// High pass of order 2, then two low passes of order 2 that make a Butterworth of order 4. States:
/// position and rate of each; the output is the fifth, its rate the sixth.
void filter_matrices(double from, double to, Filter& A, FilterState& B) {
  const double high = two_pi * from, low = two_pi * to;
  constexpr double high_damping = std::numbers::sqrt2;  // 2ζ
  const double low_damping[2]{2.0 * std::cos(3.0 * std::numbers::pi / 8.0),
                              2.0 * std::cos(std::numbers::pi / 8.0)};
  A.setZero();
  B.setZero();
  // High pass y = u − (low-passed part): states q, q̇ of q̈ = h²(u − q) − 2ζh q̇; y = u − q − 2ζ q̇ /
  // h. Without it q stays zero.
  A(0, 1) = 1.0;
  A(1, 0) = -high * high;
  A(1, 1) = from > 0.0 ? -high_damping * high : -low;
  B[1] = high * high;
  // First low pass, driven by y.
  A(2, 3) = 1.0;
  A(3, 2) = -low * low;
  A(3, 3) = -low_damping[0] * low;
  A(3, 0) = -low * low;
  A(3, 1) = from > 0.0 ? -low * low * high_damping / high : 0.0;
  B[3] = low * low;
  if (from <= 0.0) A(3, 0) = 0.0;
  // Second low pass, driven by the first.
  A(4, 5) = 1.0;
  A(5, 4) = -low * low;
  A(5, 5) = -low_damping[1] * low;
  A(5, 2) = low * low;
}

/// Exact discretisation with held input.
void discretise(Filter& A, FilterState& B, double sample_time) {
  Eigen::Matrix<double, 7, 7> both = Eigen::Matrix<double, 7, 7>::Zero();
  both.topLeftCorner<6, 6>() = sample_time * A;
  both.topRightCorner<6, 1>() = sample_time * B;
  const Eigen::Matrix<double, 7, 7> power = both.exp();
  A = power.topLeftCorner<6, 6>();
  B = power.topRightCorner<6, 1>();
}

/// P = A P Aᵀ + B Bᵀ by doubling.
Filter stationary_covariance(Filter A, const FilterState& B) {
  Filter P = B * B.transpose();
  for (int k = 0; k < 60; ++k) {
    const Filter more = A * P * A.transpose();
    P += more;
    if (more.cwiseAbs().maxCoeff() <= 1e-17 * P.cwiseAbs().maxCoeff()) break;
    A = (A * A).eval();
  }
  return P;
}

class NoiseSignal final : public Signal {
 public:
  NoiseSignal(const Noise& spec, double sample_time) : spec_(spec), sample_time_(sample_time) {
    filter_matrices(spec.from, spec.to, A_, B_);
    discretise(A_, B_, sample_time);
    B_ /= std::sqrt(stationary_covariance(A_, B_)(4, 4));
    restart();
  }

  void restart() override {
    sample_ = 0;
    sources_.clear();
    for (std::uint64_t direction = 0; direction < 6; ++direction)
      sources_.emplace_back(spec_.seed, direction);
    states_.fill(FilterState::Zero());
  }

  Displacement next() override {
    const double time = sample_time_ * static_cast<double>(sample_++);
    Displacement all;
    for (size_t i = 0; i < 6; ++i) {
      if (spec_.rms[static_cast<int>(i)] == 0.0) continue;
      states_[i] = (A_ * states_[i] + B_ * sources_[i]()).eval();
      all.value[static_cast<int>(i)] = spec_.rms[static_cast<int>(i)] * states_[i][4];
      all.rate[static_cast<int>(i)] = spec_.rms[static_cast<int>(i)] * states_[i][5];
    }
    return faded(all, fade_at(time, spec_.fade));
  }

 private:
  Noise spec_;
  double sample_time_;
  Filter A_;
  FilterState B_;
  std::vector<Gaussian> sources_{};
  std::array<FilterState, 6> states_{};
  long sample_{};
};

}  // namespace

std::unique_ptr<Signal> make_signal(const Multisine& spec, double sample_time) {
  require_band("multisine", spec.from, spec.to, sample_time, true);
  require(spec.from <= spec.to, "multisine: from", spec.from, "no more than `to`");
  require(std::isfinite(spec.period) && spec.period >= 2.0 * sample_time &&
              spec.period <= static_cast<double>(longest_period) * sample_time,
          "multisine: period", spec.period, "two samples to ten million samples");
  return std::make_unique<MultisineSignal>(spec, sample_time);
}

std::unique_ptr<Signal> make_signal(const Noise& spec, double sample_time) {
  require_band("noise", spec.from, spec.to, sample_time, true);
  require(spec.from < spec.to, "noise: from", spec.from, "less than `to`");
  return std::make_unique<NoiseSignal>(spec, sample_time);
}

}  // namespace hydrapod::simulation
