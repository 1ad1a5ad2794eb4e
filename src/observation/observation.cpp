#include "hydrapod/observation/observation.hpp"

#include <algorithm>
#include <stdexcept>

#include "hydrapod/base/error.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/numerics/dense.hpp"
#include "modal_form.hpp"

namespace hydrapod::observation {

namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

std::size_t number(Entry entry) { return static_cast<std::size_t>(entry); }

/// Of a system in states that matter alike.
numerics::EigenSystem solved(const MatrixXd& A) {
  if (!A.allFinite()) throw base::ComputationError("the plant is not finite with these values");
  auto system = numerics::eigen_system(A);
  if (!system.converged)
    throw base::ComputationError("the poles of the plant could not be computed");
  return system;
}

/// Scales the pole's column of V, and what follows from it.
void scale_column(Eigen::Index k, double factor, Observation& seen) {
  seen.to_base.col(k) *= factor;
  seen.to_ground.col(k) *= factor;
  for (auto& input : seen.inputs)
    if (input.size() > 0) input.row(k) /= factor;
  if (seen.command_speed.size() > 0) seen.command_speed.row(k) /= factor;
  if (seen.right.size() == 0) return;
  seen.right.col(k) *= factor;
  seen.left.row(k) /= factor;
}

/// Fills in the modes. `motion`: of mechanics in all its coordinates, the platform's against the
/// ground, a column per pole.
void add_modes(const MatrixXcd& motion, Observation& seen) {
  for (Eigen::Index k = 0; k < seen.poles.size(); ++k) {
    if (!(seen.poles[k].imag() > 0.0)) continue;
    const Eigen::VectorXcd shape = motion.col(k);
    const Eigen::VectorXcd momentum = seen.mechanics.M.cast<Complex>() * shape;
    const double energy = shape.dot(momentum).real();
    if (!(energy > 0.0)) continue;  // oil and valves alone
    const double factor = 1.0 / std::sqrt(energy);
    scale_column(k, factor, seen);
    scale_column(k + 1, factor, seen);  // its conjugate
    ObservedMode mode{.column = k, .shape = factor * shape};
    describe_mode(seen, mode);
    seen.modes.push_back(std::move(mode));
  }
  std::ranges::sort(seen.modes, {}, &ObservedMode::omega);
}

/// In coordinates z of the undamped modes, with the states ω z and ż, whose squares are energies:
/// (ω z)˙ = ω ż, z̈ = ∓ω (ω z) − Γ ż + Φᵀ F; +: modes that have buckled. Chambers that relax have
/// the states √κ η, η̇ = λ (s_y·Φ z − η), with the forces κ η.
void observe_mechanics(const model::Machine& machine, Observation& seen) {
  const auto& model = seen.mechanics;
  const auto modes = modal::normal_modes(model);
  const auto n = modes.omega2.size();
  constexpr double least = 1e-12;  // of the highest
  const Eigen::VectorXd omega = modes.omega2.cwiseAbs().cwiseSqrt();
  const Eigen::VectorXd rate = omega.cwiseMax(least * omega.maxCoeff());
  const auto arms = static_cast<Eigen::Index>(model.arms.size());
  MatrixXd A = MatrixXd::Zero(2 * n + arms, 2 * n + arms);
  A.block(0, n, n, n) = rate.asDiagonal();
  A.block(n, 0, n, n) = (-modes.omega2.cwiseQuotient(rate)).asDiagonal();
  A.block(n, n, n, n) =
      -modal::modal_damping_matrix(model, modes, modal::modal_ratio(machine).value);
  for (Eigen::Index j = 0; j < arms; ++j) {
    const auto& arm = model.arms[static_cast<std::size_t>(j)];
    const Eigen::VectorXd g = std::sqrt(arm.stiffness) * (modes.shapes.transpose() * arm.s_y);
    A.col(2 * n + j).segment(n, n) = g;
    A.row(2 * n + j).head(n) = arm.rate * g.cwiseQuotient(rate).transpose();
    A(2 * n + j, 2 * n + j) = -arm.rate;
  }
  const auto [poles, V, W, converged] = solved(A);
  seen.poles = poles;
  const MatrixXcd motion =
      (modes.shapes * rate.cwiseInverse().asDiagonal()).cast<Complex>() * V.topRows(n);
  seen.to_ground = motion.topRows<6>();
  seen.to_base = model.against_base.cast<Complex>() * motion;
  MatrixXd B = MatrixXd::Zero(2 * n + arms, 6);
  B.middleRows(n, n) = modes.shapes.topRows<6>().transpose();
  seen.inputs[number(Entry::forces)] = W * B.cast<Complex>();
  add_modes(motion, seen);
}

/// The mechanics' coordinates in the states `right` of the plant, the platform's against the base:
/// the first, behind which the plant has the payload's, and of a base with coordinates the first of
/// its own.
MatrixXcd mechanics_of_plant(const dynamics::LinearModel& model,
                             const std::vector<simulation::StatePart>& parts,
                             const MatrixXcd& right) {
  MatrixXcd motion(model.dof(), right.cols());
  motion.topRows(model.first_of_base()) = right.topRows(model.first_of_base());
  const auto base = std::ranges::find(parts, simulation::Part::base, &simulation::StatePart::part);
  motion.middleRows(model.first_of_base(), model.base_count()) =
      right.middleRows(base - parts.begin(), model.base_count());
  motion.bottomRows(model.payload_count()) =
      right.middleRows(model.first_of_base(), model.payload_count());
  return motion;
}

void observe_hydraulics(const ObservedSystem& system, bool closed, Observation& seen) {
  const auto& linear = system.linear;
  const auto& scales = linear.scales;
  const auto [poles, scaled, unscaled, converged] =
      solved(scales.cwiseInverse().asDiagonal() * linear.A * scales.asDiagonal());
  seen.poles = poles;
  seen.right = scales.asDiagonal() * scaled;
  seen.left = unscaled * scales.cwiseInverse().asDiagonal();
  const auto entering = [&](const MatrixXd& B) -> MatrixXcd {
    return seen.left * B.cast<Complex>();
  };
  seen.inputs[number(Entry::forces)] = entering(linear.B_wrench);
  if (closed) {
    seen.inputs[number(Entry::commands)] = entering(linear.B_command);
    seen.command_speed = entering(linear.B_velocity);
  } else {
    seen.inputs[number(Entry::valves)] = entering(linear.B_valve);
  }
  MatrixXcd motion = mechanics_of_plant(seen.mechanics, linear.parts, seen.right);
  seen.to_base = motion.topRows<6>();
  seen.to_ground = seen.to_base + system.carried.cast<Complex>() * seen.right;
  motion.topRows<6>() = seen.to_ground;
  add_modes(motion, seen);
}

}  // namespace

ObservedSystem observed_system(const model::Machine& machine, const spatial::Pose& X_BP,
                               dynamics::ModelKind kind, Observed observed,
                               const control::ControllerParameters* controller) {
  ObservedSystem system{.X_BP = X_BP, .p_BC = kinematics::mass_center(machine, X_BP)};
  system.platform_mass.setZero();
  system.platform_mass.diagonal().head<3>().setConstant(machine.platform.mass);
  system.platform_mass.bottomRightCorner<3, 3>() =
      X_BP.R_BP * machine.platform.inertia * X_BP.R_BP.transpose();
  if (!machine.payload_modes.empty()) {
    spatial::Matrix6 R = spatial::Matrix6::Zero();
    R.topLeftCorner<3, 3>() = R.bottomRightCorner<3, 3>() = X_BP.R_BP;
    system.platform_mass = R * model::mass_without_payload_modes(machine) * R.transpose();
  }
  system.linear = simulation::linear_system(machine, X_BP,
                                            {.kind = kind,
                                             .closed = observed == Observed::system,
                                             .sampled = false,
                                             .controller = controller});
  spatial::Matrix6 to_center = spatial::Matrix6::Identity();
  to_center.topRightCorner<3, 3>() = -spatial::skew(system.p_BC - X_BP.p_BP);
  system.carried = to_center * (system.linear.C_ground - system.linear.C);
  return system;
}

void describe_mode(const Observation& seen, ObservedMode& mode) {
  const bool by_valves = seen.inputs[number(Entry::valves)].cols() > 0;
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(6);
  if (!by_valves) unit = seen.mechanics.platform_mass.diagonal().cwiseAbs().cwiseSqrt();
  mode.pole = seen.poles[mode.column];
  mode.shape.head<6>() = seen.to_ground.col(mode.column);
  mode.against_base = seen.to_base.col(mode.column);
  mode.input = seen.inputs[number(by_valves ? Entry::valves : Entry::forces)].row(mode.column) *
               unit.asDiagonal();
}

bool can_enter(Observed observed, Entry entry) {
  switch (entry) {
    case Entry::valves:
      return observed == Observed::plant;
    case Entry::commands:
      return observed == Observed::system;
    case Entry::forces:
      break;
  }
  return true;
}

Eigen::Matrix<Complex, 6, 6> Observation::response(Complex s, Entry entry, MotionAgainst against,
                                                   const LagWindow* window) const {
  const auto& motion = against == MotionAgainst::ground ? to_ground : to_base;
  const auto& input = inputs[number(entry)];
  if (input.cols() == 0)
    throw std::invalid_argument("Observation::response: this system has no such input");
  Eigen::VectorXcd of_poles(poles.size());
  for (Eigen::Index k = 0; k < poles.size(); ++k)
    of_poles[k] = window != nullptr ? window->of_pole(poles[k], s) : 1.0 / (s - poles[k]);
  // s/(s − λ) = 1 + λ/(s − λ), and nothing moves at once
  if (entry == Entry::commands)
    return motion * of_poles.asDiagonal() * (input + poles.asDiagonal() * command_speed);
  return motion * of_poles.asDiagonal() * input;
}

Observation observe(const model::Machine& machine, const spatial::Pose& X_BP,
                    dynamics::ModelKind kind, Observed observed,
                    const control::ControllerParameters* controller) {
  Observation seen{.mechanics = dynamics::linear_model(machine, X_BP, kind)};
  if (observed == Observed::mechanics)
    observe_mechanics(machine, seen);
  else
    observe_hydraulics(observed_system(machine, X_BP, kind, observed, controller),
                       observed == Observed::system, seen);
  return seen;
}

std::vector<ObservedMode> undamped_modes(const dynamics::LinearModel& model,
                                         const dynamics::NormalModes& modes) {
  const Eigen::MatrixXd against_base = model.against_base * modes.shapes;
  std::vector<ObservedMode> observed;
  for (int k = 0; k < modes.size(); ++k)
    observed.push_back({.pole = {0.0, modes.omega(k)},
                        .shape = modes.shapes.col(k).cast<Complex>(),
                        .against_base = against_base.col(k).cast<Complex>()});
  return observed;
}

int nearest_mode(const dynamics::LinearModel& mechanics, const dynamics::NormalModes& modes,
                 const ObservedMode& mode) {
  const Eigen::VectorXcd momentum = mechanics.M.cast<Complex>() * mode.shape;
  Eigen::Index nearest = 0;
  (modes.shapes.transpose().cast<Complex>() * momentum).cwiseAbs().maxCoeff(&nearest);
  return static_cast<int>(nearest);
}

std::string_view description(Observed observed) {
  constexpr std::array<std::string_view, 3> descriptions{
      "mechanics, legs as springs", "mechanics and actuators, without controller",
      "mechanics, actuators and controller"};
  return descriptions[static_cast<std::size_t>(observed)];
}

}  // namespace hydrapod::observation
