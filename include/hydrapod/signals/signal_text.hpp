#pragma once
/// Commands as people write them:
///
///     rest
///     step z=5 mm, at=0.1 s, rise=0 s
///     sine x=10 mm, frequency=2 Hz, fade=0.5 s
///     sweep ry=1 deg, from=0.5 Hz, to=20 Hz, duration=20 s, spacing=log, fade=0.5 s
///     multisine z=2 mm, from=0.5 Hz, to=20 Hz, period=10 s, seed=1, fade=0.5 s
///     noise x=1 mm, y=1 mm, from=0 Hz, to=20 Hz, seed=1, fade=0.5 s
///     file motion.csv
///
/// x, y, z in m and rx, ry, rz in rad, or with units: sizes of a step, amplitudes of sine and
/// sweep, RMS of multisine and noise. At least one is needed; the rest has the defaults that stand
/// here.

#include <optional>
#include <string>

#include "hydrapod/simulation/command.hpp"

namespace hydrapod::simulation {

/// None for "rest". `seed` is what multisine and noise take without one of their own. Throws
/// base::InputError, with `--command TEXT` or the trajectory's file as place.
std::optional<CommandSpec> parse_command(const std::string& text, std::uint64_t seed = 1);

/// A trajectory from a CSV file (comma, semicolon or tabulator). The first line that is not empty
/// and does not begin with # names the columns with their units: `time [s], x [mm], rz [deg]`,
/// round brackets as well, SI without any. Needed are time and at least one of x, y, z, rx, ry, rz;
/// directions that are not there rest. Throws base::InputError with file:line:column for every
/// mistake: an unknown or repeated column, a wrong unit, a row with another number of values, text,
/// NaN, infinity, a time that does not ascend.
Trajectory read_trajectory(const std::string& path);

/// The same from text; `file` is what messages call it.
Trajectory parse_trajectory(const std::string& text, const std::string& file);

}  // namespace hydrapod::simulation
