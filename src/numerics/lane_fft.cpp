#include "lane_fft.hpp"

#include <cmath>

#include "hydrapod/base/units.hpp"

namespace hydrapod::numerics {

namespace {

/// `to` = (re + i im) (c − i s). Vectors go by reference: how they are passed by value depends on
/// the processor.
inline void turn(const Lanes& re, const Lanes& im, double c, double s, ComplexLanes& to) {
  to.re = c * re + s * im;
  to.im = c * im - s * re;
}

}  // namespace

LaneFft::LaneFft(int length) : half_(length / 2), pairs_(half_), other_(half_) {
  for (int k = 0; k <= half_; ++k) {
    const double angle = base::two_pi * k / length;
    cosines_.push_back(std::cos(angle));
    sines_.push_back(std::sin(angle));
  }
}

/// One radix-4 step: `stride` transforms of length n become 4 `stride` of length n/4.
void LaneFft::pass(int n, int stride, const ComplexLanes* from, ComplexLanes* to) const {
  const int quarter = n / 4, step = 2 * (half_ / n);  // of the tables, whose length is 2 half
  const long far = static_cast<long>(stride) * quarter;
  for (int p = 0; p < quarter; ++p) {
    const int w = p * step;
    const double c1 = cosines_[w], s1 = sines_[w], c2 = cosines_[2 * w], s2 = sines_[2 * w];
    // 3w reaches beyond the table of half a turn: e^(−i(a + π)) = −e^(−ia)
    const bool over = 3 * w > half_;
    const double sign = over ? -1.0 : 1.0;
    const double c3 = sign * cosines_[over ? 3 * w - half_ : 3 * w];
    const double s3 = sign * sines_[over ? 3 * w - half_ : 3 * w];
    const ComplexLanes* x = from + static_cast<long>(stride) * p;
    ComplexLanes* y = to + 4L * stride * p;
    for (int q = 0; q < stride; ++q, ++x, ++y) {
      const ComplexLanes &a = x[0], &b = x[far], &c = x[2 * far], &d = x[3 * far];
      const Lanes pr = a.re + c.re, pi = a.im + c.im, mr = a.re - c.re, mi = a.im - c.im;
      const Lanes qr = b.re + d.re, qi = b.im + d.im;
      const Lanes jr = d.im - b.im, ji = b.re - d.re;  // i (b − d)
      y[0].re = pr + qr;
      y[0].im = pi + qi;
      turn(mr - jr, mi - ji, c1, s1, y[stride]);
      turn(pr - qr, pi - qi, c2, s2, y[2L * stride]);
      turn(mr + jr, mi + ji, c3, s3, y[3L * stride]);
    }
  }
}

void LaneFft::run() {
  int n = half_, stride = 1;
  for (; n >= 4; n /= 4, stride *= 4) {
    pass(n, stride, pairs_.data(), other_.data());
    pairs_.swap(other_);
  }
  if (n == 1) return;
  for (int q = 0; q < stride; ++q) {
    const ComplexLanes a = pairs_[q], b = pairs_[q + stride];
    pairs_[q] = {a.re + b.re, a.im + b.im};
    pairs_[q + stride] = {a.re - b.re, a.im - b.im};
  }
}

void LaneFft::line(int k, ComplexLanes& result) const {
  const ComplexLanes &a = pairs_[k == half_ ? 0 : k], &b = pairs_[k == 0 ? 0 : half_ - k];
  // even samples' line (a + b*)/2, odd samples' (a − b*)/2i
  turn(0.5 * (a.im + b.im), 0.5 * (b.re - a.re), cosines_[k], sines_[k], result);
  result.re += 0.5 * (a.re + b.re);
  result.im += 0.5 * (a.im - b.im);
}

namespace {

#define HYDRAPOD_PICK(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)

using Square = std::array<ComplexLanes, lane_count>;

/// Rows and columns of 4 × 4 numbers exchanged.
inline void transpose(const Square& x, Lanes ComplexLanes::*part, Square& to) {
  const Lanes &a = x[0].*part, &b = x[1].*part, &c = x[2].*part, &d = x[3].*part;
  const Lanes ab_even = HYDRAPOD_PICK(a, b, 0, 4, 2, 6), ab_odd = HYDRAPOD_PICK(a, b, 1, 5, 3, 7);
  const Lanes cd_even = HYDRAPOD_PICK(c, d, 0, 4, 2, 6), cd_odd = HYDRAPOD_PICK(c, d, 1, 5, 3, 7);
  to[0].*part = HYDRAPOD_PICK(ab_even, cd_even, 0, 1, 4, 5);
  to[1].*part = HYDRAPOD_PICK(ab_odd, cd_odd, 0, 1, 4, 5);
  to[2].*part = HYDRAPOD_PICK(ab_even, cd_even, 2, 3, 6, 7);
  to[3].*part = HYDRAPOD_PICK(ab_odd, cd_odd, 2, 3, 6, 7);
}

#undef HYDRAPOD_PICK

}  // namespace

void LaneFft::four_lines(int k, std::array<ComplexLanes, lane_count>& lanes) const {
  Square by_line;
  for (int j = 0; j < lane_count; ++j) line(k + j, by_line[j]);
  transpose(by_line, &ComplexLanes::re, lanes);
  transpose(by_line, &ComplexLanes::im, lanes);
}

}  // namespace hydrapod::numerics
