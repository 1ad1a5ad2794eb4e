#pragma once
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
#include <string>

#include "hydrapod/signals/signals.hpp"

namespace hydrapod::signals {

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
