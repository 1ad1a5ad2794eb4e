#pragma once
/// Signals and instruments as people write them: "multisine z=1 mm, to=20 Hz, period=10 s".

#include <string>

#include "hydrapod/rig/rig.hpp"

namespace hydrapod::rig {

/// The signals that docs/howto/rig.md lists. Levels are of `entry`: m and rad, shares, or N and N
/// m; `all` gives every direction the same number (of rotations the same in rad, where a length is
/// given 1 mm counts as 1 mrad). Throws base::InputError with `--excite TEXT` as place.
SignalSpec parse_signal(const std::string& text, Entry entry);

/// "resolution=5 um, noise=2 um, low=0.8 m, high=1.2 m" in `unit`. Throws base::InputError with
/// `argument` as place.
model::Sensor parse_sensor(const std::string& argument, const std::string& text, const char* unit);

/// "front, at=0.3 0 0.1, along=z, noise=0.001, bandwidth=5 kHz, range=50, resolution=0.001".
Accelerometer parse_accelerometer(const std::string& text);

}  // namespace hydrapod::rig
