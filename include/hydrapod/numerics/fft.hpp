#pragma once
/// Discrete Fourier transforms of real samples,
///
///     X_k = Σ_t x_t e^(−2πi kt/n),   k = 0 … n/2,
///
/// without any factor, and back: x_t = (1/n) Σ_k X_k e^(2πi kt/n) with X_{n−k} = X_k*.
///
/// KISS FFT (in Eigen) does the work, of any length. Only several channels at once with a length
/// that is a power of two go another way: radix 4 after Stockham, four or eight channels side by
/// side in the processor's vector registers, which is what most of the time of spectral estimates
/// goes into (`identification_bench --benchmark_filter=transforms`). Source: P. N. Swarztrauber,
/// Parallel Computing 1 (1984) 45.

#include <Eigen/Core>
#include <array>
#include <complex>
#include <memory>
#include <span>
#include <vector>

namespace hydrapod::numerics {

/// Whether transforms of several channels at once go their own way: not in a page, which is small.
#ifdef __wasm__
inline constexpr bool side_by_side = false;
#else
inline constexpr bool side_by_side = true;
#endif

/// Eight neighbouring lines of a channel: what follows a transform takes them side by side.
struct alignas(64) EightLines {
  std::array<double, 8> re{}, im{};
};

/// At most four channels of a block. Four numbers are read of each sample, zero or what else there
/// is beyond the last channel.
struct Strip {
  const double* samples{};  ///< of all channels one after the other
  Eigen::Index apart{};     ///< numbers from a sample to the next of the same channel
  const double* mean{};     ///< per channel
  int channels{};
  EightLines* lines{};  ///< of the first channel, the others behind it
};

/// A transform of one length, with its tables and work space: one per thread.
class RealFft {
 public:
  using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  /// `length`: n, even, at least 2. Throws std::invalid_argument.
  explicit RealFft(int length);
  ~RealFft();
  RealFft(RealFft&&) noexcept;
  RealFft& operator=(RealFft&&) noexcept;

  [[nodiscard]] int length() const;
  [[nodiscard]] int lines() const { return length() / 2 + 1; }
  /// `spectrum` gets the n/2 + 1 lines of the n `samples`.
  void forward(std::span<const double> samples, std::span<std::complex<double>> spectrum);
  /// `samples` gets the n samples whose lines are `spectrum`.
  void inverse(std::span<const std::complex<double>> spectrum, std::span<double> samples);
  /// ⌈(n/2 + 1)/8⌉.
  [[nodiscard]] int line_groups() const { return (lines() + 7) / 8; }
  /// All channels of a block, n samples × channels, each less its `mean` and then times `window`.
  /// The lines 8g … 8g + 7 of channel c go to lines[g · apart + c]; those beyond n/2 are zero.
  void forward(const Eigen::Ref<const Block>& samples, const Eigen::RowVectorXd& mean,
               const Eigen::VectorXd& window, EightLines* lines, Eigen::Index apart);
  /// The same of strips, of as many blocks as are at hand: they fill the registers. Each strip's
  /// result is its own, whatever else is transformed.
  void forward(std::span<const Strip> strips, const Eigen::VectorXd& window, Eigen::Index apart);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Transforms of several complex series of length n, with their tables: one per thread.
class SeriesFft {
 public:
  /// `length`: n, a power of two, at least 2. Throws std::invalid_argument.
  explicit SeriesFft(int length);
  ~SeriesFft();
  SeriesFft(SeriesFft&&) noexcept;
  /// |Σ_t x_t e^(−2πi kt/n)|², a row per k. `series`: a column each, of n or fewer rows, which zero
  /// follows.
  [[nodiscard]] RealFft::Block powers(const Eigen::Ref<const Eigen::MatrixXcd>& series);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Transform of complex samples, any length ≥ 1, forward and without a factor.
std::vector<std::complex<double>> complex_fft(const std::vector<std::complex<double>>& samples);
/// Σ_k X_k e^(2πi kt/n), without a factor too.
std::vector<std::complex<double>> inverse_complex_fft(
    const std::vector<std::complex<double>>& lines);

}  // namespace hydrapod::numerics
