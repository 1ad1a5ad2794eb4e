#pragma once
/// Spectra, overviews, resampling and recovery of records, from samples that stream past: memory
/// does not grow with the length.

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hydrapod/data/record.hpp"
#include "hydrapod/data/record_io.hpp"
#include "hydrapod/numerics/fft.hpp"

namespace hydrapod::data {

struct Spectrum {
  Eigen::VectorXd frequency{};  ///< [Hz]
  Eigen::MatrixXd density{};    ///< line × channel [unit²/Hz]
  std::int64_t segments{};      ///< averaged
};

/// Power spectral densities by Welch's method.
///
/// Segments of n samples overlap by half; of each its mean is taken off and a periodic Hann window
/// laid over it. One-sided density S(f_k), f_k = k f_s/n, k = 0 … n/2:
///
///     S(f_k) = c_k / (f_s Σ w²) · mean over segments of |Σ_j w_j x_j e^(−2πi jk/n)|²,
///
/// c = 1 at f = 0 and at f_s/2, else 2, so that Σ S Δf is the variance. With m segments the
/// standard error of S is about S·√(1.1/m) for noise (overlap counted in). Missing samples (NaN)
/// are replaced by the last good one. Source: P. D. Welch, IEEE Trans. Audio Electroacoust. 15
/// (1967) 70.
class WelchSpectrum {
 public:
  /// `segment`: samples per segment, even, at least 8. Throws std::invalid_argument.
  WelchSpectrum(std::size_t channels, double sample_rate, std::size_t segment);

  void add(const Eigen::Ref<const Samples>& samples);
  /// Of what has come so far; zero segments where that is less than one.
  [[nodiscard]] Spectrum result() const;

 private:
  void take_segment();

  double sample_rate_;
  Eigen::VectorXd window_{};
  Samples segment_{};
  Eigen::Index filled_{};
  Eigen::RowVectorXd last_{};  ///< good sample of each channel
  Eigen::MatrixXd sum_{};
  std::int64_t segments_{};
  numerics::RealFft fft_;
};

/// What a look at a channel tells: levels, clipping, drop-outs.
struct ChannelOverview {
  std::int64_t samples{};      ///< that are there
  std::int64_t missing{};      ///< NaN: drop-outs
  std::int64_t infinite{};     ///< ±∞; in no other number here
  double mean{};               ///< [unit], of the samples that are there
  double rms{};                ///< about the mean [unit]
  double lowest{}, highest{};  ///< [unit]
  double peak{};               ///< largest distance from the mean [unit]
  /// Samples in runs of three or more at the lowest or highest value: a sensor or converter at the
  /// end of its range. A signal of few steps has such runs as well.
  std::int64_t at_limit{};
  /// Longest run of one value [samples]: a transmission that stands still. 0 for a constant
  /// channel.
  std::int64_t longest_hold{};
  bool constant{};
  double strongest_frequency{};  ///< of the spectrum above f = 0 [Hz]; 0 without one
};

struct RecordOverview {
  std::int64_t samples{};
  double duration{};  ///< [s]
  std::vector<ChannelOverview> channels{};
  Spectrum spectrum{};
};

class OverviewBuilder {
 public:
  /// `segment`: samples per segment of the spectra, see WelchSpectrum.
  OverviewBuilder(const RecordHeader& header, std::size_t segment);
  ~OverviewBuilder();

  void add(const Eigen::Ref<const Samples>& samples);
  [[nodiscard]] RecordOverview result() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Samples per segment for spectra of `header`: lines about half a hertz apart, fewer where the
/// record is short.
std::size_t default_segment(const RecordHeader& header, std::optional<std::int64_t> samples);

/// Another sample rate, without aliases.
///
/// Bandlimited interpolation: y(t) = Σ x_k h(t − k T), h a sinc that is cut off at the lower of the
/// two Nyquist frequencies under a Kaiser window. Up to 0.9 of that frequency the response is 1
/// within 1e-5; from there to the frequency itself it falls, and beyond it is below −100 dB. The
/// phase is zero: nothing is delayed. At both ends the record is taken to go on with its first and
/// last sample. A missing sample (NaN) stands for the last good one in the sum, and the output
/// samples nearest to it are missing.
///
/// Source: R. E. Crochiere, L. R. Rabiner, Multirate Digital Signal Processing, 1983, sect. 4.3.
class Resampler {
 public:
  using Sink = std::function<void(const Eigen::Ref<const Samples>&)>;

  /// Throws std::invalid_argument for rates that are not positive or more than 1:10000 apart.
  Resampler(std::size_t channels, double from_rate, double to_rate, Sink sink);
  ~Resampler();
  Resampler(const Resampler&) = delete;
  Resampler& operator=(const Resampler&) = delete;

  void add(const Eigen::Ref<const Samples>& samples);
  /// The samples near the end; the last one is not later than the last that came in.
  void finish();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// How what is left of a damaged record becomes a record.
///
/// | format          | what is read of a file that was cut off                                |
/// | --------------- | ---------------------------------------------------------------------- |
/// | HDF5, MAT 7.3   | of hydrapod: the samples that the file names and holds, see            |
/// |                 | src/data/hdf5_remains.cpp; of other programs: nothing                  |
/// | CSV             | all rows that end with a line end                                      |
/// | MAT 5, RPC      | all samples that are there for all channels; of MAT files with one     |
/// |                 | channel behind the other the channels that are there                   |
/// | Universal File  | the channels that are there, the last one up to the damage             |
struct RecoverOptions {
  RecordFormat format{};                   ///< of the new record
  ReadOptions read{};                      ///< of the damaged one
  std::function<bool(double)> progress{};  ///< 0 … 1 where the length is known; false ends it early
};

struct RecoverResult {
  std::string file{};                      ///< where the new record is
  std::int64_t samples{};                  ///< in it
  std::optional<std::int64_t> declared{};  ///< that the damaged record says it had
  bool unfinished{};    ///< the damaged record was never completed: its writer was killed
  bool has_checksum{};  ///< the damaged record states one
  /// Of the whole record. None with has_checksum: there is only a part of what it is the sum of.
  ChecksumFinding checksum{};
  bool uneven{};        ///< channels are absent or end before others
  bool complete{true};  ///< not ended early
  std::vector<base::Diagnostic> notes{};
};

/// Writes what can be read of `damaged`, which stays as it is, to `to`. A line in the notes of the
/// new record says where it is from. Throws base::InputError where not one sample can be read, and
/// what open_record_writer and RecordWriter::close throw.
RecoverResult recover_record(const std::string& damaged, const std::string& to,
                             const RecoverOptions& options);

}  // namespace hydrapod::data
