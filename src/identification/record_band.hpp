#pragma once
/// The band in which a record tells of its outputs' response to its inputs. Private to the module.
///
/// In a window of lines that is little wider than it takes, Y = H U + T with constant H and T by
/// least squares; what H explains of an output beside T, by what is left, is distributed as F where
/// there is no response. A resonance that is sharper than the window is not heard, but its flanks
/// are.

#include <optional>

#include "signals.hpp"

namespace hydrapod::identification {

/// The end of the last window in which, as in the one before that overlaps it by half, an output is
/// heard [Hz]. `chance`: see
/// RecordOptions::audible_chance. None: nothing is heard anywhere.
std::optional<double> audible_end(const Signals& signals, double chance);

}  // namespace hydrapod::identification
