#pragma once
/// Measured modes, from what identification found, as targets of a diagnosis.
///
/// A complex shape is turned to its largest real part; what is left imaginary adds to the shape's
/// deviation, and so does 2/√significance: a mode that hardly stands above the noise may have part
/// of a neighbour's shape in its own. The complex shape is kept beside it. Outputs are brought to
/// (x, y, z, rx, ry, rz) of one point by their directions; a mode of an output set that does not
/// have all six keeps its frequency, and the direction that is largest among those there are, in
/// proportion to the stated machine's inertia.
///
/// Identification knows what noise does to a mode, not what its model lacks. Three things are
/// added to a frequency's deviation. (1 − MPC) ζω: a shape whose parts are out of step is the sum
/// of modes that were not told apart, and the pole lies somewhere among theirs. A twentieth of the
/// line spacing: what is left of leakage where blocks are short against the decay
/// (docs/theory/diagnosis.md). ζω/2 of a weak mode within the half widths of one that is ten
/// times as significant and takes its flanks.
///
/// A shape from accelerometers is against the ground, from anything else against the base
/// (identification::against_ground); from both, against the base.

#include "hydrapod/identification/identify.hpp"
#include "hydrapod/model/machine.hpp"
#include "hydrapod/observation/targets.hpp"

namespace hydrapod::diagnosis {

/// Where the modes were measured.
struct MeasuredAt {
  std::string pose{"neutral"};                       ///< one of the machine's
  spatial::Vector3 point{spatial::Vector3::Zero()};  ///< Q, whose motion was measured, in P [m]
  /// What shapes are against; none: what their outputs say.
  std::optional<observation::MotionAgainst> against{};
  /// The system that was measured; none: the plant where all inputs are drives, else mechanics.
  std::optional<observation::Observed> observed{};
  /// Point of the platform that measured forces act at, in P [m]; none: the measured one.
  std::optional<spatial::Vector3> force_point{};
};

/// One mode by its numbers: what identification and its JSON have in common.
struct MeasuredShape {
  double omega{}, omega_deviation{};      ///< [rad/s]
  double damping{}, damping_deviation{};  ///< ζ
  /// What the mode is above the noise, see FittedMode; 0: not known.
  double significance{};
  double line_spacing{};  ///< of the responses it was found in [rad/s]; 0: not known
  bool in_flank{};        ///< of a mode that is much more significant; add_modes finds it out
  /// Per direction x … rz: motion and its deviation; NaN where it was not measured.
  std::array<std::complex<double>, 6> motion{};
  std::array<double, 6> motion_deviation{};
};

/// What motions are against that these outputs show, the directions of the platform among them.
observation::MotionAgainst motion_against(const std::vector<data::Channel>& outputs);

/// `name`: what reports call it.
observation::ModeTarget mode_target(const MeasuredShape& measured, const std::string& name,
                                    const model::Machine& machine, const MeasuredAt& at);

/// Adds all modes of one measurement to `targets`, called by their frequencies.
void add_modes(std::vector<MeasuredShape> modes, const model::Machine& machine,
               const MeasuredAt& at, observation::Targets& targets);

/// Are all inputs drives of the valves? What is measured is the plant then.
bool from_drives(const identification::FrequencyResponses& responses);

/// Throws base::InputError when no mode was found, or no output is a direction of the platform.
observation::Targets measured_modes(const identification::Identification& identified,
                                    const model::Machine& machine, const MeasuredAt& at);

}  // namespace hydrapod::diagnosis
