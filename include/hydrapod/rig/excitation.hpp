#pragma once
/// What a test rig is excited with: six signals at once, one per direction.
///
/// Levels are RMS values per direction (x, y, z, rx, ry, rz); a direction of level 0 rests. Signals
/// of one list are added. Everything is deterministic: the same list, rate and seed give the same
/// numbers bit for bit. Samples are taken at k/rate, k = 0, 1, ….
///
/// Sources: K. Godfrey (ed.), Perturbation Signals for System Identification, 1993 (sequences,
/// multisines); E. Van der Ouderaa, J. Schoukens, J. Renneboog, IEEE Trans. Instrum. Meas. 37
/// (1988) 145 (crest factor); T. Dobrowiecki, J. Schoukens, Automatica 43 (2007) 1488 (orthogonal
/// multisines).

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "hydrapod/data/record.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::rig {

using spatial::Vector6;

/// Independent normally distributed numbers from sample to sample: flat up to half the rate.
struct WhiteNoise {
  Vector6 rms{Vector6::Zero()};
};

/// Gaussian noise in a band, its amplitude density falling or rising by `slope` over frequency:
/// white noise through a linear-phase filter with edges about a quarter of `from` wide (a twentieth
/// of `to` where from = 0). Stationary from the first sample on.
struct ShapedNoise {
  Vector6 rms{Vector6::Zero()};
  double from{}, to{20.0};  ///< [Hz], 0 ≤ from < to < rate/2
  double slope{};  ///< [dB/octave], −24 … 24; −6: constant velocity where +0 is displacement
};

/// Cosines at all multiples of 1/period in the band, phases random and independent per direction.
/// It repeats after `period`, rounded to whole samples, exactly.
///
/// Orthogonal: in experiment e = 0 … 5, direction i is turned by exp(2πi·i·e/6) at every line. The
/// 6×6 matrix of input spectra over six experiments, each row over its level, then is a multiple of
/// a unitary one: its condition number is 1 at every line.
struct Multisine {
  Vector6 rms{Vector6::Zero()};
  double from{0.5}, to{20.0};  ///< [Hz], 0 < from ≤ to < rate/2
  double period{10.0};         ///< [s]
  double slope{};              ///< [dB/octave] of the amplitudes
  bool low_crest{};            ///< phases chosen for a small crest factor, in all six experiments
  std::optional<int> experiment{};  ///< 0 … 5: orthogonal; none: one experiment
};

/// Maximum-length binary sequence, ± level; its spectrum is flat to 3 dB up to `to`. The directions
/// have the same sequence a sixth of its period apart. The sequence is at least `period` long.
struct BinarySequence {
  Vector6 rms{Vector6::Zero()};
  double to{20.0};      ///< [Hz]
  double period{10.0};  ///< [s]
};

/// One sine whose frequency goes from one to the other within `duration`, fading in and out; the
/// directions take turns and begin anew. Level: RMS over a direction's turn.
struct SweptSine {
  Vector6 rms{Vector6::Zero()};
  double from{0.5}, to{20.0};  ///< [Hz]
  double duration{20.0};       ///< [s] of one turn
  bool logarithmic{true};      ///< equal time per octave, else per hertz
};

/// A linear sweep that repeats without a break after `period`, `turns` periods in one direction,
/// then in the next one.
struct Chirp {
  Vector6 rms{Vector6::Zero()};
  double from{0.5}, to{20.0};  ///< [Hz]
  double period{1.0};          ///< [s]
  int turns{10};
};

using SignalSpec =
    std::variant<WhiteNoise, ShapedNoise, Multisine, BinarySequence, SweptSine, Chirp>;

/// "white noise, 1 mm in x …" in a few words, for notes.
std::string description(const SignalSpec& spec);

/// Of one signal, sample by sample.
class SignalSource {
 public:
  SignalSource() = default;
  SignalSource(const SignalSource&) = delete;
  SignalSource& operator=(const SignalSource&) = delete;
  virtual ~SignalSource() = default;
  virtual void restart() = 0;
  /// Adds the next sample.
  virtual void add_next(Vector6& sample) = 0;
};

/// The sum of signals.
class Excitation {
 public:
  /// Throws std::invalid_argument naming signal, parameter, value and limit.
  Excitation(const std::vector<SignalSpec>& specs, double rate, std::uint64_t seed);
  void restart();
  Vector6 next();
  [[nodiscard]] double rate() const { return rate_; }

 private:
  double rate_;
  std::vector<std::unique_ptr<SignalSource>> sources_;
};

/// Samples after which a list of periodic signals repeats; none where one of them does not repeat
/// or the common period is longer than ten million samples.
std::optional<long> period_samples(const std::vector<SignalSpec>& specs, double rate);

/// One period of a multisine as cosine amplitudes and phases, for those who want its lines: column
/// per direction, row per line; U = A e^{iφ} with Σ A²/2 = rms².
struct MultisineLines {
  std::vector<long> cycles{};  ///< per period
  long samples{};              ///< of the period
  Eigen::MatrixXcd amplitude{};
};
MultisineLines multisine_lines(const Multisine& spec, double rate, std::uint64_t seed,
                               std::uint64_t stream = 0);

}  // namespace hydrapod::rig
