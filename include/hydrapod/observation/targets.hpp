#pragma once
/// What a machine is compared with: modes and frequency responses that were measured or published,
/// with their uncertainties, at one pose or several.

#include <Eigen/Core>
#include <complex>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hydrapod/control/controller.hpp"
#include "hydrapod/data/frequency_response.hpp"
#include "hydrapod/data/modal_results.hpp"
#include "hydrapod/model/machine.hpp"
#include "hydrapod/spatial/pose.hpp"

namespace hydrapod::observation {

using spatial::Vector6;
using Vector6c = Eigen::Matrix<std::complex<double>, 6, 1>;

/// The system whose modes were measured.
enum class Observed {
  mechanics,  ///< legs on oil springs: a machine whose valves are shut
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
  std::string name{};           ///< "189.32 rad/s (2)", as reports call it
  std::string pose{"neutral"};  ///< one of the machine's
  double omega{};               ///< [rad/s]
  bool damped{};                ///< ω is |λ|, as it is measured; else of the undamped mode
  double deviation{};           ///< standard deviation of omega [rad/s]
  /// The part of `deviation` that is an error of all frequencies together, such as that of a model
  /// whose mass or oil is slightly wrong: covariances of two modes are products of these [rad/s].
  double common_deviation{};
  /// [m] of the platform joint that moved most while this was measured (docs/theory/amplitude.md);
  /// 0: small. Of mechanics only.
  double amplitude{};
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

/// What averaging over windowed blocks makes of a response.
///
/// Under white excitation an averaged response is, in the mean, the transform of the impulse
/// response times ρ(t), the autocorrelation of the window, 0 ≤ t ≤ T: resonances get wider. For the
/// windows in use, sums of cosines with at most four periods,
///
///     ρ(t) = Σ_j (a_j + b_j t/T) e^{2πi j t/T},   |j| ≤ 4
///
/// and a pole's 1/(s − λ) becomes, with z_j = (λ − s) T + 2πi j,
///
///     g(λ) = T Σ_j a_j (e^z − 1)/z + b_j (e^z (z − 1) + 1)/z²
///
/// Where speeds (d = 1) or accelerations (d = 2) were averaged, λ^d/(s − λ) does that, and what
/// acts at once, Σ λ over the poles, stays: divided by s^d the displacement shows
/// (λ^d g(λ) + (d = 2: λ))/s^d.
struct LagWindow {
  static constexpr int most_periods = 4;
  using Terms = Eigen::Matrix<std::complex<double>, 2 * most_periods + 1, 1>;
  int derivative{};               ///< d
  double duration{};              ///< T [s]
  Terms constant{Terms::Zero()};  ///< a_j, j = −4 … 4
  Terms slope{Terms::Zero()};     ///< b_j

  /// g = ∫ ρ(t) e^{(λ − s) t} dt over 0 … T [s].
  [[nodiscard]] std::complex<double> transform(std::complex<double> pole,
                                               std::complex<double> s) const;
  /// What stands for 1/(s − λ) in a displacement.
  [[nodiscard]] std::complex<double> of_pole(std::complex<double> pole,
                                             std::complex<double> s) const;
};

/// From samples of ρ at `sample_rate` [Hz], from lag 0 on up to T; none where they are no such sum.
std::optional<LagWindow> lag_window(const Eigen::VectorXd& rho, double sample_rate,
                                    int derivative = 0);

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

/// Correlation R of frequencies with a common error: 1 on the diagonal, ρ_i ρ_j beside it, where
/// ρ = common_deviation/deviation < 1.
class CommonError {
 public:
  explicit CommonError(const std::vector<ModeTarget>& modes);
  /// Is there one? Else R = 1.
  [[nodiscard]] bool any() const { return slopes_.squaredNorm() > 0.0; }
  /// R^(−1/2) of differences in deviations, or of their derivatives: a row for each mode.
  [[nodiscard]] Eigen::MatrixXd whitened(const Eigen::MatrixXd& differences) const;

 private:
  Eigen::VectorXd own_{};     ///< √(1 − ρ²)
  Eigen::VectorXd slopes_{};  ///< ρ/own: R = own (1 + slopes slopesᵀ) own
};

/// Relative standard deviation of a frequency that says nothing about it.
inline constexpr double default_deviation = 1e-3;

/// Where something was measured.
struct MeasuredAt {
  std::string pose{"neutral"};                       ///< one of the machine's
  spatial::Vector3 point{spatial::Vector3::Zero()};  ///< Q, whose motion was measured, in P [m]
  /// What shapes are against; none: what their outputs say.
  std::optional<MotionAgainst> against{};
  /// The system that was measured; none: the plant where all inputs are drives, else mechanics.
  std::optional<Observed> observed{};
  /// Point of the platform that measured forces act at, in P [m]; none: the measured one.
  std::optional<spatial::Vector3> force_point{};
};

/// What motions are against that these outputs show, the directions of the platform among them:
/// accelerometers measure against the ground, all else against the base (data::against_ground);
/// of both, the base.
MotionAgainst motion_against(const std::vector<data::Channel>& outputs);

/// Are all inputs drives of the valves? What is measured is the plant then.
bool from_drives(const std::vector<data::Channel>& inputs);

/// Identified modes as targets.
///
/// A complex shape is turned to its largest real part; what is left imaginary adds to the shape's
/// deviation, and so does 2/√significance: a mode that hardly stands above the noise may have part
/// of a neighbour's shape in its own. The complex shape is kept beside it. Outputs are brought to
/// (x, y, z, rx, ry, rz) of one point by their directions; a mode of an output set that does not
/// have all six keeps its frequency, and the direction that is largest among those there are, in
/// proportion to the machine's inertia.
///
/// Identification knows what noise does to a mode, not what its model lacks. Three things are
/// added to a frequency's deviation. (1 − MPC) ζω: a shape whose parts are out of phase is the sum
/// of modes that were not separated, and the pole lies between theirs. A twentieth of the line
/// spacing: the leakage that remains where blocks are short compared with the decay
/// (docs/theory/diagnosis.md). ζω/2 of a weak mode within the half widths of one that is ten
/// times as significant.
///
/// Throws base::InputError when no mode was found, or the machine has no such pose.
Targets measured_modes(const data::ModalResults& identified, const model::Machine& machine,
                       const MeasuredAt& at);

/// What the inputs are: drives by their role, forces (N, with moments in N m) and commands (m, rad)
/// by their units. None: not all of one kind.
std::optional<Entry> entry_of(const std::vector<data::Channel>& inputs);

/// All lines of the responses, with the noise of each column as its deviation; none where the
/// inputs are not of one kind in directions of the platform (drives: or of the legs), the outputs
/// not all six directions in one kind of unit, or forces act at other measuring points (channels'
/// numbers) than the outputs.
///
/// Drives of the valves, and commands to a controller: responses to six of them are brought to the
/// six legs, so that what is not known of a valve is in one column only.
std::optional<ResponseTarget> measured_responses(const data::FrequencyResponses& responses,
                                                 const model::Machine& machine,
                                                 const MeasuredAt& at);

}  // namespace hydrapod::observation
