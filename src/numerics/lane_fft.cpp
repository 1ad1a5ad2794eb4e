#include "lane_fft.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "hydrapod/base/units.hpp"

namespace hydrapod::numerics {

namespace {

/// `to` = (re + i im) (c − i s). Vectors go by reference: how they are passed by value depends on
/// the processor.
inline void turn(const Lanes& re, const Lanes& im, double c, double s, ComplexLanes& to) {
  to.re = c * re + s * im;
  to.im = c * im - s * re;
}

constexpr int shortest_split = 128;  // shorter transforms are in the innermost cache as they are

/// N₁ of a transform of length N.
int first_factor(int length) {
  if (length < shortest_split) return length;
  return 1 << (std::countr_zero(static_cast<unsigned>(length)) + 1) / 2;
}

}  // namespace

/// The samples of strips that go side by side; where there are fewer, the last one again.
struct LaneFft::Rows {
  typedef double StripLanes __attribute__((vector_size(32)));

  std::array<const double*, strips_together> samples{};
  std::array<Eigen::Index, strips_together> apart{};
  const double* window;
  Lanes mean{};

  Rows(std::span<const Strip> strips, const double* its_window) : window(its_window) {
    std::array<double, lane_count> means{};
    for (std::size_t s = 0; s < strips_together; ++s) {
      const Strip& strip = strips[std::min(s, strips.size() - 1)];
      samples[s] = strip.samples;
      apart[s] = strip.apart;
      std::copy_n(strip.mean, strip.channels, means.data() + s * strip_lanes);
    }
    std::memcpy(&mean, means.data(), sizeof mean);
  }

  void row(Eigen::Index t, Lanes& to) const {
    std::array<StripLanes, strips_together> fours;
    for (std::size_t s = 0; s < strips_together; ++s)
      std::memcpy(&fours[s], samples[s] + t * apart[s], sizeof fours[s]);
#ifdef __AVX512F__
    to = __builtin_shufflevector(fours[0], fours[1], 0, 1, 2, 3, 4, 5, 6, 7);
#else
    to = fours[0];
#endif
  }
  /// Samples 2t and 2t + 1.
  void pair(Eigen::Index t, ComplexLanes& to) const {
    Lanes even, odd;
    row(2 * t, even);
    row(2 * t + 1, odd);
    to.re = (even - mean) * window[2 * t];
    to.im = (odd - mean) * window[2 * t + 1];
  }
};

std::vector<LaneFft::Turn> LaneFft::turns_of(int n) {
  std::vector<Turn> turns;
  for (; n > 4; n /= 4)
    for (int p = 0; p < n / 4; ++p)
      for (int power = 1; power < 4; ++power) {
        const double angle = base::two_pi * p * power / n;
        turns.push_back({std::cos(angle), std::sin(angle)});
      }
  return turns;
}

LaneFft::LaneFft(int length)
    : half_(length / 2),
      first_(first_factor(half_)),
      second_(half_ / first_),
      row_(second_ > 1 ? first_ + 1 : first_),  // no power of two: columns share no cache set
      turns_first_(turns_of(first_)),
      turns_second_(turns_of(second_)),
      numbers_(static_cast<std::size_t>(row_) * second_),
      work_(static_cast<std::size_t>(first_)),
      other_(work_.size()) {
  for (int k = 0; k <= half_ / 2; ++k) {
    const double angle = base::two_pi * k / length;
    halves_.push_back({0.5 * std::cos(angle), 0.5 * std::sin(angle)});
  }
  if (second_ == 1) return;
  for (int t = 0; t < second_; ++t)
    for (int k = 0; k < first_; ++k) {
      const double angle = base::two_pi * k * t / half_;
      between_.push_back({std::cos(angle), std::sin(angle)});
    }
}

namespace {

using Four = std::array<ComplexLanes, 4>;

/// Of the numbers `first`, `first` + `apart`, …
template <class Source>
inline void transform_four(const Source& source, int first, int apart, Four& to) {
  ComplexLanes a, b, c, d;
  source(first, a);
  source(first + apart, b);
  source(first + 2 * apart, c);
  source(first + 3 * apart, d);
  const Lanes pr = a.re + c.re, pi = a.im + c.im, mr = a.re - c.re, mi = a.im - c.im;
  const Lanes qr = b.re + d.re, qi = b.im + d.im;
  const Lanes jr = d.im - b.im, ji = b.re - d.re;  // i (b − d)
  to[0].re = pr + qr;
  to[0].im = pi + qi;
  to[1].re = mr - jr;
  to[1].im = mi - ji;
  to[2].re = pr - qr;
  to[2].im = pi - qi;
  to[3].re = mr + jr;
  to[3].im = mi + ji;
}

}  // namespace

/// `from`(t, x) gives x_t, `to`(k, X) takes X_k.
template <class From, class To>
void LaneFft::transform(int n, const std::vector<Turn>& turns, const From& from, const To& to) {
  const Turn* w = turns.data();
  int stride = 1;
  // one step: `stride` transforms of length n become 4 `stride` of length n/4
  const auto pass = [&](const auto& source, ComplexLanes* target) {
    const int quarter = n / 4;
    for (int p = 0; p < quarter; ++p, w += 3)
      for (int q = 0; q < stride; ++q) {
        Four x;
        transform_four(source, q + stride * p, stride * quarter, x);
        ComplexLanes* y = target + q + 4 * stride * p;
        y[0] = x[0];
        turn(x[1].re, x[1].im, w[0].c, w[0].s, y[stride]);
        turn(x[2].re, x[2].im, w[1].c, w[1].s, y[2 * stride]);
        turn(x[3].re, x[3].im, w[2].c, w[2].s, y[3 * stride]);
      }
    n = quarter;
    stride *= 4;
  };
  const auto last = [&](const auto& source) {
    Four x;
    if (n == 1) {
      source(0, x[0]);
      to(0, x[0]);
    }
    for (int q = 0; n == 2 && q < stride; ++q) {
      source(q, x[0]);
      source(q + stride, x[1]);
      to(q, {x[0].re + x[1].re, x[0].im + x[1].im});
      to(q + stride, {x[0].re - x[1].re, x[0].im - x[1].im});
    }
    for (int q = 0; n == 4 && q < stride; ++q) {
      transform_four(source, q, stride, x);
      for (std::size_t k = 0; k < 4; ++k) to(q + static_cast<int>(k) * stride, x[k]);
    }
  };
  if (n <= 4) return last(from);
  pass(from, work_.data());
  ComplexLanes *at = work_.data(), *next = other_.data();
  const auto source = [&at](int t, ComplexLanes& x) { x = at[t]; };
  for (; n > 4; std::swap(at, next)) pass(source, next);
  last(source);
}

/// `pair`(t, x) gives x_t, for all t < N.
template <class Pair>
void LaneFft::transform_all(const Pair& pair) {
  ComplexLanes* X = numbers_.data();
  if (second_ == 1) {
    transform(first_, turns_first_, pair, [&](int k, const ComplexLanes& x) { X[k] = x; });
    return;
  }
  for (int t = 0; t < second_; ++t) {
    ComplexLanes* row = X + static_cast<std::ptrdiff_t>(t) * row_;
    const Turn* w = between_.data() + static_cast<std::ptrdiff_t>(t) * first_;
    transform(
        first_, turns_first_, [&](int j, ComplexLanes& x) { pair(t + second_ * j, x); },
        [&](int k, const ComplexLanes& x) { turn(x.re, x.im, w[k].c, w[k].s, row[k]); });
  }
  for (int k = 0; k < first_; ++k)
    transform(
        second_, turns_second_,
        [&](int t, ComplexLanes& x) { x = X[k + static_cast<std::ptrdiff_t>(t) * row_]; },
        [&](int j, const ComplexLanes& x) { X[k + static_cast<std::ptrdiff_t>(j) * row_] = x; });
}

const ComplexLanes& LaneFft::at(int k) const {
  return numbers_[static_cast<std::size_t>(k % first_) +
                  static_cast<std::size_t>(k / first_) * static_cast<std::size_t>(row_)];
}

/// Lines k ≤ n/4 and n/2 − k. With E and O the lines of the even and the odd samples and
/// w = e^(−2πi k/n) they are E + w O and (E − w O)*.
inline void LaneFft::split(int k, ComplexLanes& line, ComplexLanes& mirror) const {
  const ComplexLanes &a = at(k), &b = at(k == 0 ? 0 : half_ - k);
  const Lanes re = a.re + b.re, im = a.im - b.im;  // 2 E
  ComplexLanes odd;
  turn(a.im + b.im, b.re - a.re, halves_[static_cast<std::size_t>(k)].c,
       halves_[static_cast<std::size_t>(k)].s, odd);
  line.re = 0.5 * re + odd.re;
  line.im = 0.5 * im + odd.im;
  mirror.re = 0.5 * re - odd.re;
  mirror.im = odd.im - 0.5 * im;
}

namespace {

using Square = std::array<ComplexLanes, 8>;  // lines
using Column = std::array<Lanes, 8>;

/// The lines 8g … 8g + 7 of a strip's channels.
void store_group(std::span<const Strip> strips, Eigen::Index group, Eigen::Index apart,
                 const Square& lines) {
  typedef double Eight __attribute__((vector_size(64)));
  const auto part = [&](Lanes ComplexLanes::*own, std::array<double, 8> EightLines::*to) {
#define HYDRAPOD_PICK(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#ifdef __AVX512F__
    Column x, y;
    for (std::size_t k = 0; k < 8; ++k) x[k] = lines[k].*own;
    for (std::size_t k = 0; k < 8; k += 2) {
      y[k] = HYDRAPOD_PICK(x[k], x[k + 1], 0, 8, 2, 10, 4, 12, 6, 14);
      y[k + 1] = HYDRAPOD_PICK(x[k], x[k + 1], 1, 9, 3, 11, 5, 13, 7, 15);
    }
    for (std::size_t k = 0; k < 8; k += 4)
      for (std::size_t j = 0; j < 2; ++j) {
        x[k + j] = HYDRAPOD_PICK(y[k + j], y[k + j + 2], 0, 1, 8, 9, 4, 5, 12, 13);
        x[k + j + 2] = HYDRAPOD_PICK(y[k + j], y[k + j + 2], 2, 3, 10, 11, 6, 7, 14, 15);
      }
    for (std::size_t j = 0; j < 4; ++j) {
      y[j] = HYDRAPOD_PICK(x[j], x[j + 4], 0, 1, 2, 3, 8, 9, 10, 11);
      y[j + 4] = HYDRAPOD_PICK(x[j], x[j + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    }
    const auto& columns = y;
#else
    std::array<Eight, lane_count> columns;
    for (std::size_t half = 0; half < 8; half += 4) {
      const Lanes &a = lines[half].*own, &b = lines[half + 1].*own, &c = lines[half + 2].*own,
                  &d = lines[half + 3].*own;
      const Lanes ab_even = HYDRAPOD_PICK(a, b, 0, 4, 2, 6),
                  ab_odd = HYDRAPOD_PICK(a, b, 1, 5, 3, 7),
                  cd_even = HYDRAPOD_PICK(c, d, 0, 4, 2, 6),
                  cd_odd = HYDRAPOD_PICK(c, d, 1, 5, 3, 7);
      const std::array<Lanes, 4> done{
          HYDRAPOD_PICK(ab_even, cd_even, 0, 1, 4, 5), HYDRAPOD_PICK(ab_odd, cd_odd, 0, 1, 4, 5),
          HYDRAPOD_PICK(ab_even, cd_even, 2, 3, 6, 7), HYDRAPOD_PICK(ab_odd, cd_odd, 2, 3, 6, 7)};
      for (std::size_t j = 0; j < lane_count; ++j)
        std::memcpy(reinterpret_cast<double*>(&columns[j]) + half, &done[j], sizeof done[j]);
    }
#endif
#undef HYDRAPOD_PICK
    for (std::size_t s = 0; s < strips.size(); ++s)
      for (int c = 0; c < strips[s].channels; ++c)
        std::memcpy((strips[s].lines[group * apart + c].*to).data(),
                    &columns[s * strip_lanes + static_cast<std::size_t>(c)], sizeof(Eight));
  };
  part(&ComplexLanes::re, &EightLines::re);
  part(&ComplexLanes::im, &EightLines::im);
}

/// Where the lines of a group will be written: they are far apart, and in no near cache.
void fetch_group(std::span<const Strip> strips, Eigen::Index group, Eigen::Index apart) {
  for (const Strip& strip : strips)
    for (int c = 0; c < strip.channels; ++c) {
      EightLines& eight = strip.lines[group * apart + c];
      __builtin_prefetch(eight.re.data(), 1);
      __builtin_prefetch(eight.im.data(), 1);
    }
}

}  // namespace

void LaneFft::store_few(std::span<const Strip> strips, Eigen::Index apart) const {
  std::array<ComplexLanes, 16> lines{};
  for (int k = 0; k <= half_ / 2; ++k)
    split(k, lines[static_cast<std::size_t>(k)], lines[static_cast<std::size_t>(half_ - k)]);
  for (int group = 0; group <= half_ / 8; ++group) {
    Square eight;
    std::copy_n(lines.begin() + 8 * group, 8, eight.begin());
    store_group(strips, group, apart, eight);
  }
}

void LaneFft::store(std::span<const Strip> strips, Eigen::Index apart) const {
  if (half_ < 16) return store_few(strips, apart);
  constexpr int ahead = 4;
  const int groups = half_ / 8;
  Square lines, mirrors, behind{};  // `behind`: lines n/2 − 8g … n/2 − 8g + 7
  for (int g = 0; g < groups / 2; ++g) {
    fetch_group(strips, std::min(g + ahead, groups), apart);
    fetch_group(strips, std::max(groups - g - ahead, 0), apart);
    for (int j = 0; j < 8; ++j)
      split(8 * g + j, lines[static_cast<std::size_t>(j)], mirrors[static_cast<std::size_t>(j)]);
    behind[0] = mirrors[0];
    store_group(strips, g, apart, lines);
    store_group(strips, groups - g, apart, behind);
    for (std::size_t j = 1; j < 8; ++j) behind[8 - j] = mirrors[j];
  }
  split(half_ / 2, behind[0], mirrors[0]);
  store_group(strips, groups / 2, apart, behind);
}

void LaneFft::forward(std::span<const Strip> strips, const Eigen::VectorXd& window,
                      Eigen::Index apart) {
  const Rows rows(strips, window.data());
  transform_all([&](int t, ComplexLanes& x) { rows.pair(t, x); });
  store(strips, apart);
}

void LaneFft::powers(const Eigen::Ref<const Eigen::MatrixXcd>& series, Eigen::Index first,
                     RealFft::Block& to) {
  const Eigen::Index count = std::min<Eigen::Index>(lane_count, series.cols() - first);
  transform_all([&](int t, ComplexLanes& x) {
    x.re = x.im = Lanes{};
    for (Eigen::Index c = 0; t < series.rows() && c < count; ++c) {
      x.re[c] = series(t, first + c).real();
      x.im[c] = series(t, first + c).imag();
    }
  });
  for (int k = 0; k < half_; ++k) {
    const ComplexLanes& x = at(k);
    const Lanes power = x.re * x.re + x.im * x.im;
    std::memcpy(to.data() + k * to.cols() + first, &power,
                static_cast<std::size_t>(count) * sizeof(double));
  }
}

}  // namespace hydrapod::numerics
