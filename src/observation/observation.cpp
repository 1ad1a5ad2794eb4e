#include "hydrapod/observation/observation.hpp"

#include <algorithm>
#include <stdexcept>

#include "hydrapod/base/error.hpp"
#include "hydrapod/modal/damped_modes.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "numerics/dense.hpp"

namespace hydrapod::observation {

namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

std::size_t number(Entry entry) { return static_cast<std::size_t>(entry); }

/// Of a system in states that matter alike.
numerics::EigenPairs solved(const MatrixXd& A) {
  if (!A.allFinite()) throw base::ComputationError("the plant is not finite with these values");
  auto pairs = numerics::eigen_pairs(A);
  if (!pairs.converged)
    throw base::ComputationError("the poles of the plant could not be computed");
  return pairs;
}

/// Fills in the modes. `motion`: of mechanics in all its coordinates, the platform's against the
/// ground, a column per pole.
void add_modes(const MatrixXcd& motion, Entry entry, Observation& seen) {
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(6);
  if (entry == Entry::forces) unit = seen.mechanics.platform_mass.diagonal().cwiseAbs().cwiseSqrt();
  for (Eigen::Index k = 0; k < seen.poles.size(); ++k) {
    if (!(seen.poles[k].imag() > 0.0)) continue;
    ObservedMode mode{
        .pole = seen.poles[k], .shape = motion.col(k), .against_base = seen.to_base.col(k)};
    const Eigen::VectorXcd momentum = seen.mechanics.M.cast<Complex>() * mode.shape;
    const double energy = mode.shape.dot(momentum).real();
    if (!(energy > 0.0)) continue;  // oil and valves alone
    mode.shape /= std::sqrt(energy);
    mode.against_base /= std::sqrt(energy);
    mode.input = std::sqrt(energy) * seen.inputs[number(entry)].row(k) * unit.asDiagonal();
    seen.modes.push_back(std::move(mode));
  }
  std::ranges::sort(seen.modes, {}, &ObservedMode::omega);
}

/// In coordinates z of the undamped modes, with the states ω z and ż, whose squares are energies:
/// (ω z)˙ = ω ż, z̈ = ∓ω (ω z) − Γ ż + Φᵀ F; +: modes that have buckled.
void observe_mechanics(const model::Machine& machine, Observation& seen) {
  const auto& model = seen.mechanics;
  const auto modes = modal::normal_modes(model);
  const auto n = modes.omega2.size();
  constexpr double least = 1e-12;  // of the highest
  const Eigen::VectorXd omega = modes.omega2.cwiseAbs().cwiseSqrt();
  const Eigen::VectorXd rate = omega.cwiseMax(least * omega.maxCoeff());
  MatrixXd A = MatrixXd::Zero(2 * n, 2 * n);
  A.topRightCorner(n, n) = rate.asDiagonal();
  A.bottomLeftCorner(n, n) = (-modes.omega2.cwiseQuotient(rate)).asDiagonal();
  A.bottomRightCorner(n, n) =
      -modal::modal_damping_matrix(model, modes, modal::modal_ratio(machine).value);
  const auto [poles, V, converged] = solved(A);
  seen.poles = poles;
  const MatrixXcd motion =
      (modes.shapes * rate.cwiseInverse().asDiagonal()).cast<Complex>() * V.topRows(n);
  seen.to_ground = motion.topRows<6>();
  seen.to_base = model.against_base.cast<Complex>() * seen.to_ground;
  MatrixXd B = MatrixXd::Zero(2 * n, 6);
  B.bottomRows(n) = modes.shapes.topRows<6>().transpose();
  seen.inputs[number(Entry::forces)] = numerics::solve(V, B.cast<Complex>());
  add_modes(motion, Entry::forces, seen);
}

void observe_hydraulics(const model::Machine& machine, bool closed,
                        const control::ControllerParameters* controller, Observation& seen) {
  const auto& model = seen.mechanics;
  const auto system = simulation::linear_system(
      machine, model.X_BP,
      {.kind = model.kind, .closed = closed, .sampled = false, .controller = controller});
  const auto& scales = system.scales;
  const auto [poles, scaled, converged] =
      solved(scales.cwiseInverse().asDiagonal() * system.A * scales.asDiagonal());
  seen.poles = poles;
  const MatrixXcd V = scales.asDiagonal() * scaled;
  const MatrixXcd to_modes = numerics::inverse(scaled) * scales.cwiseInverse().asDiagonal();
  const auto entering = [&](const MatrixXd& B) -> MatrixXcd {
    return to_modes * B.cast<Complex>();
  };
  seen.inputs[number(Entry::forces)] = entering(system.B_wrench);
  if (closed) {
    seen.inputs[number(Entry::commands)] = entering(system.B_command);
    seen.command_speed = entering(system.B_velocity);
  } else {
    seen.inputs[number(Entry::valves)] = entering(system.B_valve);
  }
  // the mechanics' coordinates are the first states, the platform's against the base
  MatrixXcd motion = V.topRows(model.dof());
  seen.to_base = motion.topRows<6>();
  spatial::Matrix6 to_center = spatial::Matrix6::Identity();
  to_center.topRightCorner<3, 3>() = -spatial::skew(model.p_BC - model.X_BP.p_BP);
  seen.to_ground = seen.to_base + (to_center * (system.C_ground - system.C)).cast<Complex>() * V;
  motion.topRows<6>() = seen.to_ground;
  add_modes(motion, closed ? Entry::forces : Entry::valves, seen);
}

}  // namespace

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
    observe_hydraulics(machine, observed == Observed::system, controller, seen);
  return seen;
}

std::vector<ObservedMode> undamped_modes(const dynamics::LinearModel& model,
                                         const dynamics::NormalModes& modes) {
  const Eigen::MatrixXd against_base = model.against_base * modes.shapes.topRows<6>();
  std::vector<ObservedMode> observed;
  for (int k = 0; k < modes.size(); ++k)
    observed.push_back({.pole = {0.0, modes.omega(k)},
                        .shape = modes.shapes.col(k).cast<Complex>(),
                        .against_base = against_base.col(k).cast<Complex>()});
  return observed;
}

int nearest_mode(const Observation& seen, const ObservedMode& mode) {
  const auto modes = modal::normal_modes(seen.mechanics);
  const Eigen::VectorXcd momentum = seen.mechanics.M.cast<Complex>() * mode.shape;
  Eigen::Index nearest = 0;
  (modes.shapes.transpose().cast<Complex>() * momentum).cwiseAbs().maxCoeff(&nearest);
  return static_cast<int>(nearest);
}

std::string_view description(Observed observed) {
  constexpr std::array<std::string_view, 3> descriptions{
      "mechanics with oil springs", "mechanics, hydraulics and valves, without controller",
      "mechanics, hydraulics, valves and controller"};
  return descriptions[static_cast<std::size_t>(observed)];
}

}  // namespace hydrapod::observation
