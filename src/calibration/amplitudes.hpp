#pragma once
/// Modes at the amplitude that targets were measured at, in the place of the damped ones of a
/// point: ω and ζ of the harmonic balance (modal::balances_at). Private to the module.

#include "hydrapod/calibration/calibrate.hpp"

namespace hydrapod::calibration {

/// Was any mode measured at an amplitude?
bool has_amplitudes(const observation::Targets& targets);

/// Does the number act in modes at amplitudes: friction of seals or joints? Viscous friction does
/// not (docs/theory/amplitude.md).
bool acts_at_amplitudes(const model::ParameterId& id);

/// Does the mode move the platform, so that its amplitude says something of it
/// (modal::AmplitudeOptions::least_platform)? The others count as linear.
bool moves_platform(const ModePoint& point, int mode);

/// Fills ModePoint::damped of all modes that move the platform and have a balance at `amplitude`
/// [m]. `machine`: that of the point, at its pose number `pose`.
void add_at_amplitude(const model::Machine& machine, std::size_t pose, double amplitude,
                      ModePoint& point);

/// Fills the rows of ModePoint::dpole_omega and dpole_ratio of those of `modes` whose damped modes
/// are those at `amplitude`, by central differences. `scales`: size of each parameter. False where
/// a machine beside this one has no balance.
bool add_amplitude_derivatives(const VariedMachine& machine, const std::vector<double>& values,
                               std::size_t pose, double amplitude, std::span<const double> scales,
                               const std::vector<int>& modes, ModePoint& point);

}  // namespace hydrapod::calibration
