#include "hydrapod/data/processing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <stdexcept>

namespace hydrapod::data {

namespace {

constexpr double attenuation = 110.0;   // [dB], with a margin for what interpolating h costs
constexpr double pass_band = 0.9;       // of the lower Nyquist frequency
constexpr int points_per_sample = 512;  // of the table of h, per sample of the lower rate

/// Modified Bessel function of order 0, by its series.
double bessel_i0(double x) {
  double sum = 1.0, term = 1.0;
  for (int k = 1; term > 1e-18 * sum; ++k) {
    term *= (x / (2.0 * k)) * (x / (2.0 * k));
    sum += term;
  }
  return sum;
}

}  // namespace

struct Resampler::Implementation {
  /// h over t ≥ 0 in samples of the lower rate; the pass band ends at 0.45, the stop band begins at
  /// 0.5 of that rate. Cubic interpolation of the table is exact to about 1e-9.
  class Kernel {
   public:
    Kernel() {
      const double transition = std::numbers::pi * (1.0 - pass_band);  // [rad/sample]
      half_width_ = std::ceil((attenuation - 7.95) / (2.285 * transition) / 2.0);
      const double beta = 0.1102 * (attenuation - 8.7);
      const double cut = 0.5 * (1.0 + pass_band);  // of the Nyquist frequency, mid transition
      const int last = static_cast<int>(half_width_) * points_per_sample;
      table_.resize(static_cast<std::size_t>(last) + 4, 0.0);
      for (int i = 0; i <= last; ++i) {
        const double t = static_cast<double>(i) / points_per_sample;
        const double x = std::numbers::pi * cut * t;
        const double sinc = i == 0 ? 1.0 : std::sin(x) / x;
        const double edge = t / half_width_;
        table_[static_cast<std::size_t>(i)] =
            cut * sinc * bessel_i0(beta * std::sqrt(std::max(0.0, 1.0 - edge * edge))) /
            bessel_i0(beta);
      }
    }
    [[nodiscard]] double half_width() const { return half_width_; }

    [[nodiscard]] double operator()(double t) const {
      const double place = std::abs(t) * points_per_sample;
      const auto i = static_cast<std::size_t>(place);
      if (i + 3 >= table_.size()) return 0.0;
      const double f = place - static_cast<double>(i);
      const double before = i == 0 ? table_[1] : table_[i - 1];
      const double a = table_[i], b = table_[i + 1], after = table_[i + 2];
      // cubic through four neighbours
      return a + f * (b - before / 3.0 - a / 2.0 - after / 6.0 +
                      f * (0.5 * (before + b) - a + f * ((after - before) / 6.0 + 0.5 * (a - b))));
    }

   private:
    double half_width_{};
    std::vector<double> table_{};
  };

  Eigen::Index channels{};
  double step{};   ///< input samples per output sample
  double scale{};  ///< samples of the lower rate per input sample
  Sink sink{};
  Kernel kernel{};
  Samples history{};  ///< rows first … first + filled − 1 of the input
  std::int64_t first{}, filled{};
  std::int64_t taken{};                                         ///< input samples so far
  std::int64_t made{};                                          ///< output samples so far
  std::deque<std::pair<std::int64_t, Eigen::Index>> missing{};  ///< sample and channel
  Eigen::RowVectorXd last_good{};
  Samples out{};
  Eigen::Index out_rows{};

  [[nodiscard]] std::int64_t reach() const {
    return static_cast<std::int64_t>(std::ceil(kernel.half_width() / scale)) + 1;
  }

  void push(const Eigen::RowVectorXd& row) {
    if (filled == history.rows()) drop();
    history.row(filled++) = row;
  }

  /// Forgets what no output needs any more.
  void drop() {
    const auto centre = static_cast<std::int64_t>(static_cast<double>(made) * step);
    const std::int64_t gone = std::clamp<std::int64_t>(centre - reach() - first, 0, filled);
    if (gone > 0) {
      history.topRows(filled - gone) = history.middleRows(gone, filled - gone).eval();
      first += gone;
      filled -= gone;
    }
    if (filled == history.rows()) history.conservativeResize(2 * history.rows(), channels);
  }

  /// Output samples for which all input up to `known` (exclusive) is enough.
  void make(std::int64_t known, double end) {
    for (;; ++made) {
      const double centre = static_cast<double>(made) * step;
      if (centre > end ||
          std::floor(centre) + static_cast<double>(reach()) >= static_cast<double>(known))
        return;
      make_one(centre);
    }
  }

  void make_one(double centre) {
    if (out_rows == out.rows()) flush();
    const auto middle = static_cast<std::int64_t>(std::floor(centre));
    auto row = out.row(out_rows++);
    row.setZero();
    double sum = 0.0;
    for (std::int64_t k = middle - reach(); k <= middle + reach(); ++k) {
      const double weight = scale * kernel(scale * (centre - static_cast<double>(k)));
      if (weight == 0.0) continue;
      sum += weight;
      row += weight * history.row(std::clamp<std::int64_t>(k - first, 0, filled - 1));
    }
    row /= sum;  // a constant stays one
    mark_missing(centre, row);
  }

  template <typename Row>
  void mark_missing(double centre, Row&& row) {
    const double near = std::max(0.5, 0.5 * step);
    while (!missing.empty() && static_cast<double>(missing.front().first) < centre - near)
      missing.pop_front();
    for (const auto& [sample, channel] : missing) {
      if (static_cast<double>(sample) > centre + near) break;
      row[channel] = std::numeric_limits<double>::quiet_NaN();
    }
  }

  void flush() {
    if (out_rows > 0) sink(out.topRows(out_rows));
    out_rows = 0;
  }
};

Resampler::Resampler(std::size_t channels, double from_rate, double to_rate, Sink sink)
    : implementation_(std::make_unique<Implementation>()) {
  const bool positive = from_rate > 0.0 && to_rate > 0.0 && std::isfinite(from_rate + to_rate);
  constexpr double most = 10'000.0;
  if (!positive || from_rate / to_rate > most || to_rate / from_rate > most)
    throw std::invalid_argument(fmt::format(
        "Resampler: from {} Hz to {} Hz; rates must be positive and at most 1:10000 apart",
        from_rate, to_rate));
  Implementation& all = *implementation_;
  all.channels = static_cast<Eigen::Index>(channels);
  all.step = from_rate / to_rate;
  all.scale = std::min(1.0, to_rate / from_rate);
  all.sink = std::move(sink);
  all.history.resize(4 * all.reach() + 1024, all.channels);
  all.last_good.setZero(all.channels);
  all.out.resize(std::clamp<Eigen::Index>(131072 / all.channels, 1, 8192), all.channels);
}

Resampler::~Resampler() = default;

void Resampler::add(const Eigen::Ref<const Samples>& samples) {
  Implementation& all = *implementation_;
  for (Eigen::Index i = 0; i < samples.rows(); ++i) {
    for (Eigen::Index c = 0; c < all.channels; ++c) {
      const double value = samples(i, c);
      if (std::isfinite(value))
        all.last_good[c] = value;
      else
        all.missing.emplace_back(all.taken, c);
    }
    all.push(all.last_good);
    ++all.taken;
    if (all.filled == all.history.rows()) all.make(all.taken, static_cast<double>(all.taken));
  }
}

void Resampler::finish() {
  Implementation& all = *implementation_;
  if (all.taken > 0) all.make(all.taken + 2 * all.reach() + 2, static_cast<double>(all.taken - 1));
  all.flush();
}

}  // namespace hydrapod::data
