#pragma once
/// Real transforms of four channels side by side. Private to the module.

#include <array>
#include <vector>

namespace hydrapod::numerics {

inline constexpr int lane_count = 4;
/// A vector of GCC and Clang: Eigen's array of four takes twice the time here.
typedef double Lanes __attribute__((vector_size(32), aligned(16)));

/// One complex number per lane.
struct ComplexLanes {
  Lanes re, im;
};

/// Stockham's radix-4 transform of length n/2 of the even and odd samples as real and imaginary
/// part, then split into the n/2 + 1 lines of the real samples.
class LaneFft {
 public:
  /// `length`: n, a power of two, at least 4.
  explicit LaneFft(int length);
  /// Work space for n/2 pairs of samples: pair t is (x_{2t}, x_{2t+1}).
  [[nodiscard]] std::vector<ComplexLanes>& pairs() { return pairs_; }
  /// Transforms pairs(); line() then has the lines.
  void run();
  void line(int k, ComplexLanes& result) const;
  /// `lanes[c][j]` is line k + j of channel c; k + 3 < n/2.
  void four_lines(int k, std::array<ComplexLanes, lane_count>& lanes) const;

 private:
  void pass(int n, int stride, const ComplexLanes* from, ComplexLanes* to) const;

  int half_;
  std::vector<double> cosines_, sines_;  ///< of 2π k/n, k = 0 … n/2
  std::vector<ComplexLanes> pairs_, other_;
};

}  // namespace hydrapod::numerics
