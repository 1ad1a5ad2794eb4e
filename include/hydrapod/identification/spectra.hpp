#pragma once
/// Cross spectra of all channels of a record, from samples that stream past.
///
/// Blocks of n samples, D apart (Welch), lose their mean, get a window and are transformed once per
/// channel, z_k = (Z_1 … Z_c)ᵀ at line f_k = k f_s/n. Averaged over the blocks,
///
///     S(f_k) = c_k/(f_s Σ w²) · mean of z_k z_kᴴ,   c = 1 at k = 0 and n/2, else 2,
///
/// is the one-sided density [unit²/Hz]: S_ij = E[Z_i Z_j*]. Memory: n · c for the samples and
/// c (c + 1)/2 complex numbers per line, whatever the length of the record.
///
/// Periodic excitation: blocks are whole periods, without window and overlap. They are averaged as
/// transforms over the periods of a record, z̄, and S = mean over the records of z̄ z̄ᴴ; what
/// differs from period to period is the noise, N = mean of (z − z̄)(z − z̄)ᴴ · m/(m − 1).

#include <cstdint>
#include <memory>
#include <vector>

#include "hydrapod/data/record.hpp"
#include "hydrapod/identification/window.hpp"

namespace hydrapod::identification {

struct SpectrumOptions {
  int block_length{};           ///< n [samples], even, at least 8
  double overlap{0.5};          ///< 0 … < 1, share of a block that the next one has too
  Window window{Window::hann};  ///< for periodic excitation there is none
  bool periodic{};              ///< blocks are periods
};

/// What a look at a channel's samples tells.
struct ChannelHealth {
  std::int64_t samples{};
  std::int64_t missing{};  ///< NaN or infinite
  std::int64_t
      at_limit{};  ///< at the highest or lowest value: more than a few say that it was clipped
  double lowest{}, highest{};
  [[nodiscard]] bool constant() const { return samples > missing && !(highest > lowest); }
};

struct CrossSpectra {
  std::vector<data::Channel> channels{};
  double sample_rate{};  ///< [Hz]
  SpectrumOptions options{};
  Eigen::VectorXd window{};        ///< w_t
  std::int64_t blocks{};           ///< that were averaged
  std::int64_t blocks_left_out{};  ///< for a missing sample
  int records{};                   ///< that held at least one block
  AverageStatistics statistics{};
  std::vector<ChannelHealth> health{};
  /// Pair (i, j), i ≥ j, is column i (i + 1)/2 + j; a row per line.
  Eigen::MatrixXd re{}, im{};
  Eigen::MatrixXd noise_re{}, noise_im{};  ///< N, for periodic excitation; else empty

  [[nodiscard]] Eigen::Index lines() const { return re.rows(); }
  [[nodiscard]] double frequency(Eigen::Index line) const {
    return static_cast<double>(line) * sample_rate / options.block_length;
  }
  /// S or N at a line, Hermitian.
  [[nodiscard]] Eigen::MatrixXcd at(Eigen::Index line) const;
  [[nodiscard]] Eigen::MatrixXcd noise_at(Eigen::Index line) const;
};

class SpectrumEstimator {
 public:
  /// Of these channels of `header` (all of them when none is named). Throws std::invalid_argument
  /// for options that make no sense.
  SpectrumEstimator(const data::RecordHeader& header, const SpectrumOptions& options,
                    const std::vector<std::size_t>& channels = {});
  ~SpectrumEstimator();
  SpectrumEstimator(SpectrumEstimator&&) noexcept;
  SpectrumEstimator& operator=(SpectrumEstimator&&) noexcept;

  /// The next samples of the record, all its channels.
  void add(const Eigen::Ref<const data::Samples>& samples);
  /// What comes next is another record: no block reaches over the border. Its first `settling`
  /// samples are passed over.
  void begin_record(std::int64_t settling = 0);
  /// Of what has come so far.
  [[nodiscard]] CrossSpectra result();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Samples after which excitation repeats, to within `tolerance` of its RMS; 0: it does not.
/// `samples`: one signal, at least three periods of it.
std::int64_t period_of(const Eigen::VectorXd& samples, double tolerance = 1e-3);

}  // namespace hydrapod::identification
