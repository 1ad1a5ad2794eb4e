#pragma once
/// Everything in one linear system: mechanics, pressures, spools, controller, delay.
///
/// The plant at rest at a pose (Plant::linearise, Coulomb friction left out) with the linear
/// controller (control::linear_controller) around it. Two descriptions of the sampled loop:
///
/// - continuous: the controller as if it were never sampled, and between it and each valve the
/// delay
///   τ = (delay + ½) T, the half sample standing for the hold, as a Padé approximation of order N:
///       e^{−sτ} ≈ Σ c_k (−sτ)^k / Σ c_k (sτ)^k,   c_k = (2N − k)! N! / ((2N)! k! (N − k)!)
///   Its poles have a part of the machine each; it is good well below half the sample rate.
/// - sampled: exact. The plant over one sample by the matrix exponential, with the drives changing
///   where within the sample the delay puts it, and past drives as states. Its poles z are those of
///   the true loop, s = ln(z) / T.
///
/// Poles of a linear system, what takes part in them, and whether it is stable.
///
/// Participation of state k in the pole λ with right and left eigenvectors v, w (wᵀ v = 1) is
/// |w_k v_k|, brought to the sum 1: it does not depend on units. In equal poles (a symmetric
/// machine has x with y, rx with ry) any mix of vectors is one; there |P_kk| of the projector P = Σ
/// v wᵀ over the group is used, which does not depend on the mix.
///
/// The controller's parameters for a machine: what its file leaves out follows from the machine.
///
/// With ω_1 and ω_6 the lowest and highest frequency of the rigid model at the pose (oil modes),
/// k_h the oil spring of a leg there and ζ `feedback_damping`:
///
///     gain G            0.3 ω_1 with pressure feedback, else 0.05 ω_1, the same for all six
///     integral time     8 / smallest gain above 0: its own pole is then real and some times slower
///     pressure feedback g = 2 ζ ω_1 / k_h;  acceleration feedback  g = 2 ζ / ω_6
///     feedback corner   0.1 ω_1
///
/// Of electric cylinders ω_1 is that with held motors. They have no pressure feedback and need no
/// compensation: the speed at full drive is p ω_max/2π whatever the load.
///
/// One mass m on one such leg, Ḟ = k_h (v_valve − v), m v̇ = F, answers to v_valve = −g F with
/// s² + k_h g s + k_h/m = 0: damping ratio ζ_j = k_h g / 2ω_j for a mode at ω_j, and a velocity
/// gain is stable up to 2 ζ_j ω_j = k_h g, whatever the mode. Fed-back acceleration gives ζ_j = g
/// ω_j / 2: most to the highest mode, where valve and delay lag most, so that one bounds it, and
/// leaves little to the lowest, hence the smaller gain.

#include <Eigen/Core>
#include <array>
#include <complex>
#include <string>
#include <vector>

#include "hydrapod/control/controller.hpp"
#include "hydrapod/simulation/plant.hpp"

namespace hydrapod::simulation {

inline constexpr int default_pade_order = 2;

/// Which part of the machine a state belongs to.
enum class Part {
  x,
  y,
  z,
  rx,
  ry,
  rz,
  seal,
  oil,
  valve,
  supply,
  friction,
  controller,
  delay,
  base,
  payload,
  line,  ///< with waves
  motor  ///< of electric cylinders
};
inline constexpr int part_count = 17;
/// "platform x", …, "seals", "oil", "valves", "supply", "friction", "controller", "delay", "base",
/// "payload", "lines", "motors".
const char* name(Part part);

struct StatePart {
  Part part{};
  int leg{-1};  ///< 0…5, −1: of no single leg
};

/// Commands at the valves or motors, behind controller and delay, from the states and from the
/// commanded displacement and its velocity. Empty without a controller.
struct AppliedCommands {
  Eigen::MatrixXd state{};                ///< 6 × states
  Eigen::MatrixXd command{}, velocity{};  ///< 6 × 6
};

struct LinearSystem {
  Eigen::MatrixXd A{};
  /// Input per commanded displacement (6) and its velocity (6), see ControllerInputs.
  Eigen::MatrixXd B_command{}, B_velocity{};
  /// Per command of the valves or motors themselves (6), past the controller.
  Eigen::MatrixXd B_valve{};
  Eigen::MatrixXd B_wrench{};  ///< per force and moment on the platform about its mass centre (6)
  /// Displacement of P (x…rz, origin of P) from the states: against the base, as leg lengths show
  /// it. See dynamics::LinearModel::against_base for the same of its modes.
  Eigen::MatrixXd C{};
  Eigen::MatrixXd C_ground{};  ///< the same against the ground, as accelerometers feel it
  std::vector<std::string> states{};
  std::vector<StatePart> parts{};
  Eigen::VectorXd scales{};  ///< magnitudes that matter of each state
  AppliedCommands applied{};
  double delay{};  ///< τ [s] that was approximated
  int pade_order{};
  double sample_time{};
  /// The sampled loop: w_{k+1} = sampled · w_k + sampled_command · r_k + sampled_velocity · ṙ_k
  /// with w = (plant; controller; drives of the last samples, the latest first). Empty where not
  /// asked for.
  Eigen::MatrixXd sampled{}, sampled_command{}, sampled_velocity{};
  AppliedCommands sampled_applied{};  ///< from the sample on, of w_k, r_k and ṙ_k
};

struct LinearSystemOptions {
  dynamics::ModelKind kind{dynamics::ModelKind::guide};
  int pade_order{
      default_pade_order};  ///< 0: no delay at all in the continuous description, up to 8
  bool closed{true};        ///< false: the plant alone, valves held
  bool sampled{true};       ///< the sampled loop too
  /// The controller at work; none: as tune_controller has it for this machine.
  const control::ControllerParameters* controller{};
};

/// At rest at `X_BP`. Throws base::ComputationError where the machine cannot stand there,
/// std::invalid_argument for a Padé order outside 0…8.
LinearSystem linear_system(const model::Machine& machine, const Pose& X_BP,
                           const LinearSystemOptions& options = {});

struct SystemPole {
  std::complex<double> pole{};                  ///< λ [1/s], Im ≥ 0: one of each conjugate pair
  double omega{};                               ///< |λ| [rad/s]
  double damping_ratio{};                       ///< −Re λ / |λ|, 1 for real stable poles
  bool stable{true};                            ///< mark_growing()
  int group{};                                  ///< same number for equal poles
  std::array<double, part_count> parts{};       ///< participation by Part, sum 1
  std::array<double, model::leg_count> legs{};  ///< of seals, oil, lines, valves, motors by leg
  /// C v: how P's origin moves against the base in it, any scale. Equal poles: together they span
  /// the motion.
  Eigen::Matrix<std::complex<double>, 6, 1> motion{
      Eigen::Matrix<std::complex<double>, 6, 1>::Zero()};
  /// C_ground v: the same against the ground.
  Eigen::Matrix<std::complex<double>, 6, 1> ground_motion{
      Eigen::Matrix<std::complex<double>, 6, 1>::Zero()};
  [[nodiscard]] bool oscillates() const { return pole.imag() > 0.0; }
};

/// Re λ of an oscillation that nothing damps, as of a seal without a damper, is rounding alone:
/// within this share of |λ|. It does not grow.
inline constexpr double rounded_growth = 1e-9;
bool grows(std::complex<double> pole);
/// Slower than this a pole without a controller is a drift [1/s]: the leakage of valves that are
/// held lets the platform move away, which is no fault.
inline constexpr double slowest_growth = 1e-2;

struct SystemPoles {
  std::vector<SystemPole> poles{};  ///< least damped in time first: by Re λ, descending
  bool stable{};                    ///< none grows
  double largest_real{};            ///< max Re λ [1/s]
  /// Of the sampled loop: exact. Equal to 1 in growth is the limit.
  std::vector<std::complex<double>> sampled{};  ///< s = ln(z)/T [1/s], Im ≥ 0, by Re, descending
  double largest_modulus{};                     ///< max |z|
  bool sampled_stable{};                        ///< none grows
};

SystemPoles system_poles(const LinearSystem& system);

/// Sets SystemPole::stable of `poles.poles`. In a sampled loop its exact poles decide: each of them
/// that grows is the nearest of the continuous approximation that is left.
void mark_growing(SystemPoles& poles);

/// H(iω) from the commanded displacement (with its velocity, fed forward) to the platform's.
/// 6×6, at `omega` [rad/s].
Eigen::Matrix<std::complex<double>, 6, 6> command_response(const LinearSystem& system,
                                                           double omega);

struct Tuning {
  control::ControllerParameters parameters{};
  double lowest_oil_mode{};  ///< ω_1 [rad/s]
};

/// Electric cylinders whose motors turn freely, for small motions about rest at `X_BP`
/// (docs/theory/actuators.md). States: y and the way of each nut s_n [m], their rates, the arms of
/// elastomers. B_valve is per motor torque [N m]. Modal ratios damp nothing here; named dampers,
/// Rayleigh's damping and the motors' viscous friction do.
LinearSystem screw_system(const model::Machine& machine, const spatial::Pose& X_BP,
                          dynamics::ModelKind kind);

/// Throws base::ComputationError where the machine does not stand at `X_BP`.
Tuning tune_controller(const model::Machine& machine, const spatial::Pose& X_BP);

}  // namespace hydrapod::simulation
