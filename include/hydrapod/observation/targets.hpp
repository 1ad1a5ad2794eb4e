#pragma once
/// What a machine is compared with: modes and frequency responses that were measured or published,
/// with their uncertainties, at one pose or several.

#include <complex>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hydrapod/control/parameters.hpp"
#include "hydrapod/observation/lag_window.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::observation {

using spatial::Vector6;
using Vector6c = Eigen::Matrix<std::complex<double>, 6, 1>;

/// The system whose modes were measured.
enum class Observed {
  mechanics,  ///< legs on oil springs, undamped: a machine whose valves are shut
  plant,      ///< mechanics, oil and valves, damped: what the drives of the valves see
  system      ///< with the controller: what commands see, and forces on a controlled machine
};
/// "mechanics", "plant", "system".
const char* name(Observed observed);

/// What a motion was measured against, which differs where the base gives way.
enum class MotionAgainst {
  ground,  ///< accelerometers, lasers on the floor; shapes of `hydrapod modes`
  base     ///< leg lengths, and poses that follow from them
};
/// "ground", "base".
const char* name(MotionAgainst against);

/// A shape as it was measured, with its phases.
struct ComplexShape {
  Vector6c motion{Vector6c::Zero()};
  double deviation{};  ///< of the shape scaled to unit kinetic energy of the platform
};

/// One mode that was found in the machine.
struct ModeTarget {
  std::string name{};               ///< "189.32 rad/s (2)", as reports call it
  std::string pose{"neutral"};      ///< one of the machine's
  double omega{};                   ///< [rad/s]
  double deviation{};               ///< standard deviation of omega [rad/s]
  std::optional<int> direction{};   ///< 0…5 for x…rz: what the platform mostly does
  std::optional<double> damping{};  ///< ratio ζ
  double damping_deviation{};       ///< of ζ
  std::optional<Vector6> shape{};   ///< platform's motion x…rz [m, rad], any scale
  double shape_deviation{};         ///< of the shape scaled to unit kinetic energy of the platform
  /// Point of the platform whose motion the shape is, in P [m]; none: the model's mass centre.
  std::optional<spatial::Vector3> shape_point{};
  MotionAgainst shape_against{};
  /// What `shape` was before it was turned to real; of use for the plant, whose shapes are complex.
  std::optional<ComplexShape> complex_shape{};
};

/// Where an excitation enters, and what six inputs of it are.
enum class Entry {
  valves,   ///< commands of the six valves, of the plant
  forces,   ///< force [N] and moment [N m] on the platform at the measured point, of any system
  commands  ///< commanded displacement of the pose (x … rz) to the controller, of the system
};
/// "valves", "forces", "commands".
const char* name(Entry entry);

/// Responses at one pose, line by line and input by input. A column of H counts up to one complex
/// factor: what a valve lets through for a command is known worse than how the platform then moves.
/// Forces are known, but not the delays of filters and converters between them and the motion:
/// their columns count up to a phase.
struct ResponseTarget {
  std::string pose{"neutral"};
  spatial::Vector3 point{spatial::Vector3::Zero()};  ///< Q, whose motion was measured, in P [m]
  std::vector<std::complex<double>> s{};             ///< per line [1/s]
  std::vector<Eigen::MatrixXcd> H{};                 ///< displacement of Q, 6 × inputs
  /// Per line of each column, as share of it in the metric of the platform's mass.
  std::vector<Eigen::VectorXd> deviation{};
  MotionAgainst against{MotionAgainst::base};  ///< what H is against
  Entry entry{Entry::valves};
  Eigen::MatrixXd inputs{};           ///< what each input is of the six of its entry, 6 × inputs
  int values{};                       ///< how many values all lines together say something about
  std::optional<LagWindow> window{};  ///< what the estimate made of the responses; none: nothing
};

struct Targets {
  std::string title{};
  std::string source{};
  Observed observed{};
  std::vector<ModeTarget> modes{};
  std::vector<ResponseTarget> responses{};
  /// What controlled the machine at a pose while the system was measured; a pose that is not in it:
  /// as the file of the machine observed has it.
  std::map<std::string, control::ControllerParameters> controllers{};
  bool deviations_given{true};  ///< false: no mode says how exact it is; default_deviation counts
};

/// Relative standard deviation of a frequency that says nothing about it.
inline constexpr double default_deviation = 1e-3;

}  // namespace hydrapod::observation
