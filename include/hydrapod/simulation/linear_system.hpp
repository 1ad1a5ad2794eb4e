#pragma once
/// Everything in one linear system: mechanics, pressures, spools, controller, delay.
///
/// The plant at rest at a pose (Plant::linearise, Coulomb friction left out) with the linear
/// controller (control/linear_controller.hpp) around it. Two descriptions of the sampled loop:
///
/// - continuous: the controller as if it were never sampled, and between it and each valve the
/// delay
///   τ = (delay + ½) T, the half sample standing for the hold, as a Padé approximation of order N:
///       e^{−sτ} ≈ Σ c_k (−sτ)^k / Σ c_k (sτ)^k,   c_k = (2N − k)! N! / ((2N)! k! (N − k)!)
///   Its poles have a part of the machine each; it is good well below half the sample rate.
/// - sampled: exact. The plant over one sample by the matrix exponential, with the drives changing
///   where within the sample the delay puts it, and past drives as states. Its poles z are those of
///   the true loop, s = ln(z) / T.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "hydrapod/control/linear_controller.hpp"
#include "hydrapod/control/parameters.hpp"
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
  base
};
inline constexpr int part_count = 14;
/// "platform x", …, "seals", "oil", "valves", "supply", "friction", "controller", "delay", "base".
const char* name(Part part);

struct StatePart {
  Part part{};
  int leg{-1};  ///< 0…5, −1: of no single leg
};

struct LinearSystem {
  Eigen::MatrixXd A{};
  /// Input per commanded displacement (6) and its velocity (6), see ControllerInputs.
  Eigen::MatrixXd B_command{}, B_velocity{};
  Eigen::MatrixXd B_valve{};   ///< per command of the valves themselves (6), past the controller
  Eigen::MatrixXd B_wrench{};  ///< per force and moment on the platform about its mass centre (6)
  /// Displacement of P (x…rz, origin of P) from the states: against the base, as leg lengths show
  /// it. See dynamics::LinearModel::against_base for the same of its modes.
  Eigen::MatrixXd C{};
  Eigen::MatrixXd C_ground{};  ///< the same against the ground, as accelerometers feel it
  std::vector<std::string> states{};
  std::vector<StatePart> parts{};
  Eigen::VectorXd scales{};  ///< magnitudes that matter of each state
  double delay{};            ///< τ [s] that was approximated
  int pade_order{};
  double sample_time{};
  /// The sampled loop: w_{k+1} = sampled · w_k + sampled_command · r_k + sampled_velocity · ṙ_k
  /// with w = (plant; controller; drives of the last samples, the latest first). Empty where not
  /// asked for.
  Eigen::MatrixXd sampled{}, sampled_command{}, sampled_velocity{};
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

}  // namespace hydrapod::simulation
