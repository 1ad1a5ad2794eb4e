#pragma once
/// Modes at given amplitudes: what guide rings, elastomers and friction make of them
/// (docs/theory/amplitude.md).
///
/// The platform swings in one mode at a time. Every leg's guide sleeve, piston ring and piston then
/// have amplitudes, for which harmonic balance gives a spring and a damper (dynamics/equivalent.hpp).
/// With these the mode is computed anew, until nothing changes any more.

#include <span>
#include <string>
#include <vector>

#include "hydrapod/dynamics/linear_model.hpp"

namespace hydrapod::modal {

using dynamics::ModelVector;

struct AmplitudeOptions {
  /// |change of ω| ≤ tolerance · ω ends the iteration.
  double tolerance{1e-10};
  int most_iterations{500};
  /// MAC with the mode before < least_mac: the mode is lost, and no number is given.
  double least_mac{0.3};
};

struct ModeAtAmplitude {
  int mode{};           ///< index of the linear mode that it grows from
  double amplitude{};   ///< [m] of the platform joint that moves most
  double omega{};       ///< [rad/s]
  double damping_ratio{};
  double mac{};             ///< with the linear mode, in the metric of M
  double sleeve{};          ///< largest amplitude at a guide sleeve [m]
  double piston{};          ///< largest amplitude of a piston along its leg [m]
  int legs_on_guide{};      ///< whose rods touch the guide ring in the period
  bool converged{};
  ModelVector shape{};  ///< φᵀ M φ = 1; empty where it did not converge
};

/// The curves of one mode over the amplitudes.
struct AmplitudeCurve {
  int mode{};             ///< index into NormalModes of the linear model
  int direction{};        ///< 0…5, in which the platform moves most
  double omega{};         ///< of the linear model
  std::vector<ModeAtAmplitude> points{};  ///< one per amplitude
};

/// Of every mode that moves the platform (local_mode_energy). `amplitudes` [m] > 0, ascending. Throws
/// as linear_model() does, and std::invalid_argument for amplitudes that do not ascend.
std::vector<AmplitudeCurve> modes_at_amplitudes(const model::Machine& machine,
                                                const spatial::Pose& X_BP, dynamics::ModelKind kind,
                                                std::span<const double> amplitudes,
                                                const AmplitudeOptions& options = {});

}  // namespace hydrapod::modal
