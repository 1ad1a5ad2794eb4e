#pragma once
/// Modes by harmonic balance, as a measurement at a given amplitude sees them.

#include <functional>

#include "support/noisy_modes.hpp"

namespace hydrapod::test {

/// Of a machine at a pose.
using Modes = std::function<PoseModes(const model::Machine&, const model::NamedPose&)>;

/// Every mode vibrates with this amplitude [m] of the platform joint that moves most, or with the
/// largest one below it that harmonic balance finds a motion for.
Modes modes_at_amplitude(double amplitude);

}  // namespace hydrapod::test
