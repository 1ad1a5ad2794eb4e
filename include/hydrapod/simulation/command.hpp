#pragma once
/// What the platform is commanded to do: displacements from the operating pose over time.
///
/// A displacement d = (x, y, z, rx, ry, rz) moves the operating pose X_0 to p = p_0 + (x, y, z),
/// R = Rz(rz) Ry(ry) Rx(rx) R_0, as `--pose "z=50 mm, ry=5 deg"` does. Its rate goes along, for the
/// controller's feed-forward.
///
/// Signals that have a beginning fade in over `fade` seconds by w(τ) = τ³ (10 − 15 τ + 6 τ²), τ =
/// t/fade, so that velocity and acceleration begin at zero.

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "hydrapod/control/controller.hpp"

namespace hydrapod::simulation {

using spatial::Pose;
using spatial::Vector6;

struct Displacement {
  Vector6 value{Vector6::Zero()};  ///< [m, rad]
  Vector6 rate{Vector6::Zero()};   ///< [m/s, rad/s]
};

/// The command that a displacement from `operating` is.
control::Command command_at(const Pose& operating, const Displacement& displacement);

/// From 0 to `size` at `at`, within `rise` along w.
struct Step {
  Vector6 size{Vector6::Zero()};
  double at{0.1};  ///< [s]
  double rise{};   ///< [s]
};

struct Sine {
  Vector6 amplitude{Vector6::Zero()};
  double frequency{1.0};  ///< [Hz]
  double fade{0.5};       ///< [s]
};

/// A sine whose frequency goes from one to the other, then nothing; fades in and out.
struct Sweep {
  Vector6 amplitude{Vector6::Zero()};
  double from{0.5}, to{20.0};  ///< [Hz]
  double duration{20.0};       ///< [s]
  bool logarithmic{true};      ///< equal time per octave, else per hertz
  double fade{0.5};            ///< [s]
};

/// Equal sines at all multiples of 1/period in the band, with random phases, independent for each
/// direction. It repeats after `period`, which is rounded to whole samples.
struct Multisine {
  Vector6 rms{Vector6::Zero()};
  double from{0.5}, to{20.0};  ///< [Hz]
  double period{10.0};         ///< [s]
  std::uint64_t seed{1};
  double fade{0.5};  ///< [s]
};

/// Gaussian noise, independent for each direction: white noise of the controller's samples through
/// a Butterworth low pass of order 4 at `to` and a high pass of order 2 at `from` (0: none).
struct Noise {
  Vector6 rms{Vector6::Zero()};
  double from{0.0}, to{20.0};  ///< [Hz]
  std::uint64_t seed{1};
  double fade{0.5};  ///< [s]
};

/// Points that are passed at their times, cubic between them (slopes of the parabola through three
/// neighbours), held before and after.
struct Trajectory {
  std::vector<double> times{};    ///< [s], ascending, at least one
  std::vector<Vector6> points{};  ///< [m, rad], as many
  std::string source{};           ///< the file, for messages
};

using CommandSpec = std::variant<Step, Sine, Sweep, Multisine, Noise, Trajectory>;

/// A commanded motion, sample by sample. The same calls give the same numbers, bit for bit.
class Signal {
 public:
  Signal() = default;
  Signal(const Signal&) = delete;
  Signal& operator=(const Signal&) = delete;
  virtual ~Signal() = default;
  /// Back to time 0.
  virtual void restart() = 0;
  /// The displacement at the next sample: at 0, T, 2T, ….
  virtual Displacement next() = 0;
};

/// The sum of `specs`, sampled at `sample_time` [s]; without any it rests. Throws
/// std::invalid_argument for what makes no sense: a negative time or frequency, a band that is
/// empty or reaches beyond half the sample rate, a trajectory with times that do not ascend.
std::unique_ptr<Signal> make_signal(const std::vector<CommandSpec>& specs, double sample_time);

/// "step z = 5 mm at 0.1 s", for headings.
std::string description(const CommandSpec& spec);

}  // namespace hydrapod::simulation
