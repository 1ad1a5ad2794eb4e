#pragma once
/// Real transforms of four or eight channels side by side. Private to the module.

#include <array>
#include <new>
#include <vector>

#include "hydrapod/numerics/fft.hpp"

namespace hydrapod::numerics {

#ifdef __AVX512F__
inline constexpr int lane_count = 8;
#else
inline constexpr int lane_count = 4;
#endif
inline constexpr int strip_lanes = 4, strips_together = lane_count / strip_lanes;
/// A vector of GCC and Clang: Eigen's array of four takes twice the time here.
typedef double Lanes __attribute__((vector_size(lane_count * sizeof(double))));

/// One complex number per lane.
struct ComplexLanes {
  Lanes re, im;
};

/// The transform of length n/2 of the even and odd samples as real and imaginary part, then split
/// into the n/2 + 1 lines of the real samples. A long one of N = N₁ N₂ is N₂ transforms of length
/// N₁ and then N₁ of length N₂, each within the innermost cache: the data is read and written
/// twice, not once per radix. Source: D. H. Bailey, Journal of Supercomputing 4 (1990) 23. The
/// short ones are Stockham's, of radix 4.
class LaneFft {
 public:
  /// `length`: n, a power of two, at least 4.
  explicit LaneFft(int length);
  /// At most `strips_together` of them. The lines of channel c of a strip stand as in
  /// RealFft::forward.
  void forward(std::span<const Strip> strips, const Eigen::VectorXd& window, Eigen::Index apart);

  /// |X_k|² of complex series of length n/2, a column each, from column `first` on as many as there
  /// are lanes; zero follows the last row.
  void powers(const Eigen::Ref<const Eigen::MatrixXcd>& series, Eigen::Index first,
              RealFft::Block& to);

 private:
  struct Turn {
    double c, s;  ///< e^(−ia)
  };
  struct Rows;
  [[nodiscard]] static std::vector<Turn> turns_of(int n);
  template <class From, class To>
  void transform(int n, const std::vector<Turn>& turns, const From& from, const To& to);
  template <class Pair>
  void transform_all(const Pair& pair);
  [[nodiscard]] const ComplexLanes& at(int k) const;
  void split(int k, ComplexLanes& line, ComplexLanes& mirror) const;
  void store_few(std::span<const Strip> strips, Eigen::Index apart) const;
  void store(std::span<const Strip> strips, Eigen::Index apart) const;

  int half_, first_, second_;  ///< N = N₁ N₂
  int row_;                    ///< numbers from X_k to X_{k + N₁}
  std::vector<Turn> halves_;   ///< half of e^(−2πi k/n), k ≤ n/4
  std::vector<Turn> between_;  ///< e^(−2πi k t/N), k < N₁, for t = 0 … N₂ − 1
  std::vector<Turn> turns_first_, turns_second_;  ///< of the short transforms, pass by pass
  std::vector<ComplexLanes> numbers_, work_, other_;
};

}  // namespace hydrapod::numerics
