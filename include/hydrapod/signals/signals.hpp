#pragma once
/// Signals in six directions over time: what a machine is commanded to do, and what a test rig
/// excites it with.
///
/// A signal gives each direction (x, y, z, rx, ry, rz) the value size · u(t) and its rate, the
/// derivative with respect to time. The unit is that of the place where the signal goes in:
/// displacements [m, rad], shares of full drive, forces and moments [N, N m]. Signals of one list
/// are added. Samples are taken at k/rate, k = 0, 1, …. The same list, rate and seed give the same
/// numbers bit for bit.
///
/// `size` is the final value of a step, the amplitude of sine, sweep and chirp (their RMS value
/// where `rms` is set), and the RMS value of all others. RMS values hold exactly over the period of
/// a multisine or a binary sequence and over one pass of a sweep or chirp, in expectation for white
/// noise and noise. A negative size reverses the signal. A direction of size 0 rests.
///
/// Signals fade in from rest by w(τ) = τ³ (10 − 15 τ + 6 τ²), τ = t/fade, so that velocity and
/// acceleration begin at zero; a sweep also fades out. Steps and trajectories do not fade. The rate
/// is the exact derivative of the signal that is sampled. White noise and binary sequences have
/// none; theirs is 0.
///
/// Sources: K. Godfrey (ed.), Perturbation Signals for System Identification, 1993 (sequences,
/// multisines); E. Van der Ouderaa, J. Schoukens, J. Renneboog, IEEE Trans. Instrum. Meas. 37
/// (1988) 145 (crest factor); T. Dobrowiecki, J. Schoukens, Automatica 43 (2007) 1488 (orthogonal
/// multisines).
///
/// Signals as people write them, one grammar for commands and excitation:
///
///     rest
///     step       z=5 mm, at=0.1 s, rise=0 s
///     sine       x=10 mm, frequency=1 Hz
///     sweep      ry=1 deg, from=0.5 Hz, to=20 Hz, duration=20 s, spacing=log, turns=0
///     chirp      z=1 mm, from=0.5 Hz, to=20 Hz, period=1 s, turns=0
///     multisine  z=2 mm, from=0.5 Hz, to=20 Hz, period=10 s, slope=0, crest=random, experiment=1
///     white      all=0.1 mm
///     noise      x=1 mm, y=1 mm, from=0 Hz, to=20 Hz, slope=0
///     binary     z=1 mm, to=20 Hz, period=10 s
///     file       motion.csv
///
/// Sizes are x, y, z, rx, ry, rz, or `all` for the same number in each direction; at least one is
/// needed. Numbers are SI or have a unit. Keys that are left out have the defaults of signals.hpp,
/// which stand here. All but step and file take `fade` (0.5 s); multisine, white, noise and binary
/// take `seed`; sine, sweep and chirp take `level`, amplitude or rms.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::signals {

using spatial::Vector6;

/// From 0 to its size at `at`, within `rise` along w.
struct Step {
  double at{0.1};  ///< [s]
  double rise{};   ///< [s]
};

struct Sine {
  double frequency{1.0};  ///< [Hz], below half the sample rate
  bool rms{};
};

/// A sine whose frequency goes from one to the other within `duration`. With `turns` = 0 all
/// directions move together, once. Else each direction makes `turns` passes before the next one has
/// its turn, over and over.
struct Sweep {
  double from{0.5}, to{20.0};  ///< [Hz], above 0 and below half the sample rate
  double duration{20.0};       ///< [s] of one pass
  bool logarithmic{true};      ///< equal time per octave, else per hertz
  int turns{};
  bool rms{};
};

/// A linear sweep that repeats without a break: `to` is moved so that `period` holds whole cycles.
/// Turns as those of Sweep; together (0) it repeats as well.
struct Chirp {
  double from{0.5}, to{20.0};  ///< [Hz], 0 ≤ from ≤ to < half the sample rate
  double period{1.0};          ///< [s]
  int turns{};
  bool rms{};
};

/// Cosines at all multiples of 1/period in the band, phases random and independent per direction.
/// It repeats after `period`, rounded to whole samples, exactly.
///
/// Orthogonal: in experiment e = 1 … 6, direction i = 0 … 5 is turned by exp(2πi·i·(e − 1)/6) at
/// every line. The 6×6 matrix of input spectra over six experiments, each row over its level, then
/// is a multiple of a unitary one: its condition number is 1 at every line.
struct Multisine {
  double from{0.5}, to{20.0};       ///< [Hz], 0 ≤ from ≤ to < half the sample rate
  double period{10.0};              ///< [s], at most two million samples
  double slope{};                   ///< [dB/octave] of the amplitudes, −24 … 24
  bool low_crest{};                 ///< phases of a small crest factor, in all six experiments
  std::optional<int> experiment{};  ///< 1 … 6: orthogonal; none: one experiment
};

/// Independent normally distributed numbers from sample to sample: flat up to half the rate.
struct White {};

/// Gaussian noise in a band, independent for each direction, its amplitude density falling or
/// rising by `slope` over frequency. White noise goes through a linear-phase filter of finite
/// length, so that the density is flat (to 1 %) between edges about a quarter of `from` wide (a
/// twentieth of `to` where from = 0), nothing is outside (−60 dB), and the signal is stationary
/// from the first sample on. Filters end at 65536 samples: edges are at least rate/10923 wide.
struct Noise {
  double from{}, to{20.0};  ///< [Hz], 0 ≤ from < to < half the sample rate
  double slope{};  ///< [dB/octave], −24 … 24; −6: constant velocity where 0 is displacement
};

/// Maximum-length binary sequence, ± size; its spectrum is flat to 3 dB up to `to`. The directions
/// have the same sequence a sixth of its period apart. The sequence is at least `period` long.
struct Binary {
  double to{20.0};      ///< [Hz]
  double period{10.0};  ///< [s]
};

/// Points that are passed at their times, cubic between them (slopes of the parabola through three
/// neighbours), held before and after. It has no size.
struct Trajectory {
  std::vector<double> times{};    ///< [s], ascending, at least one
  std::vector<Vector6> points{};  ///< as many
  std::string source{};           ///< the file
};

using Form = std::variant<Step, Sine, Sweep, Chirp, Multisine, White, Noise, Binary, Trajectory>;

struct Signal {
  Vector6 size{Vector6::Zero()};
  Form form{};
  double fade{0.5};                     ///< [s]
  std::optional<std::uint64_t> seed{};  ///< default: that of the list
};

struct Sample {
  Vector6 value{Vector6::Zero()};
  Vector6 rate{Vector6::Zero()};  ///< [unit of the value per second]
};

/// Throws std::invalid_argument naming signal, parameter, value and limit unless `signal` can be
/// sampled at `rate` [Hz].
void require_sound(const Signal& signal, double rate);

/// The sum of signals, sample by sample; without any it rests.
class Generator {
 public:
  /// Signals without a seed of their own draw from `seed`, each its own stream. Throws as
  /// require_sound does.
  Generator(const std::vector<Signal>& signals, double rate, std::uint64_t seed = 1);
  void restart() { at_ = 0; }
  Sample next();

 private:
  std::vector<std::function<Sample(long)>> sources_{};
  long at_{};
};

/// Samples after which the sum of `signals` repeats once it has faded in; none where one of them
/// does not repeat or the common period is longer than ten million samples.
std::optional<long> period_samples(const std::vector<Signal>& signals, double rate);

/// How long the signals go on, and a little more [s]: the time a run takes that is not told any.
double natural_duration(const std::vector<Signal>& signals);

/// Coherent SI units of the six directions.
using Units = std::array<const char*, 6>;
inline constexpr Units displacement_units{"m", "m", "m", "rad", "rad", "rad"};
inline constexpr Units drive_units{"1", "1", "1", "1", "1", "1"};
inline constexpr Units wrench_units{"N", "N", "N", "N m", "N m", "N m"};

/// Where a text stands.
struct TextPlace {
  std::string argument{"--command"};  ///< for messages
  Units units{displacement_units};
  double rate{1000.0};  ///< [Hz] of the samples
  /// Defaults of an excitation: level=rms, and directions in turn (turns=1 of a sweep, 10 of a
  /// chirp). Else level=amplitude, and directions together (turns=0).
  bool excitation{};
};

/// The signals of `texts`; "rest" adds none. Throws base::InputError, with `ARGUMENT TEXT` or the
/// trajectory's file as place, for what cannot be read or not be sampled at `place.rate`.
std::vector<Signal> read_signals(const std::vector<std::string>& texts, const TextPlace& place);

/// A signal in the same grammar with all its keys, to nine digits: "step z=5 mm, at=0.1 s, rise=0
/// s".
std::string signal_text(const Signal& signal, const Units& units = displacement_units);

/// A trajectory from a table (base/file.hpp), whose titles name the columns with their units:
/// `time [s], x [mm], rz [deg]`, SI without any. Needed are time and at least one of x, y, z, rx,
/// ry, rz; directions that are not there rest. Throws base::InputError with file:line:column for
/// every mistake: an unknown or repeated column, a wrong unit, a row with another number of values,
/// text, NaN, infinity, a time that does not ascend.
Trajectory read_trajectory(const std::string& path, const Units& units = displacement_units);

/// The same from text; `file` is what messages call it.
Trajectory parse_trajectory(const std::string& text, const std::string& file,
                            const Units& units = displacement_units);

}  // namespace hydrapod::signals
