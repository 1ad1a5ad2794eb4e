#include "hydrapod/simulation/linear_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <unsupported/Eigen/MatrixFunctions>

#include "origin_from_center.hpp"

namespace hydrapod::simulation {

namespace {

using control::ControllerInputs;
using control::LinearController;
using Eigen::MatrixXd;

constexpr int highest_pade_order = 8;

/// One input, one output.
struct ScalarSystem {
  MatrixXd A{}, B{}, C{};
  double D{};
};

/// Padé approximation of e^{−sτ}, order N/N, in controllable form with time in units of τ.
ScalarSystem pade_delay(double tau, int order) {
  const int N = order;
  Eigen::VectorXd c(N + 1);  // of (sτ)^k in the denominator, (−1)^k of it in the numerator
  c[0] = 1.0;
  for (int k = 1; k <= N; ++k)
    c[k] = c[k - 1] * static_cast<double>(N - k + 1) / (static_cast<double>(k) * (2 * N - k + 1));
  ScalarSystem pade{MatrixXd::Zero(N, N), MatrixXd::Zero(N, 1), MatrixXd::Zero(1, N),
                    N % 2 == 0 ? 1.0 : -1.0};
  for (int i = 0; i + 1 < N; ++i) pade.A(i, i + 1) = 1.0;
  for (int k = 0; k < N; ++k) {
    pade.A(N - 1, k) = -c[k] / c[N];
    const double numerator = k % 2 == 0 ? c[k] : -c[k];
    pade.C(0, k) = numerator / c[N] - pade.D * c[k] / c[N];
  }
  pade.B(N - 1, 0) = 1.0;
  pade.A /= tau;
  pade.B /= tau;
  return pade;
}

/// Rows of the plant's linear outputs, by what the sensors see.
struct OutputRows {
  /// In place of pressures electric drives have torque and speed of the motors.
  static constexpr int pose = 0, length = 6, pressures = 18, acceleration = 30;
};

/// Measurements of the controller per plant state: 24 × states.
MatrixXd measurements(const LinearPlant& plant, const model::Machine& machine, const Pose& X_BP,
                      bool accelerations) {
  MatrixXd C = MatrixXd::Zero(24, plant.A.cols());
  C.middleRows(ControllerInputs::length, 6) = plant.C.middleRows(OutputRows::length, 6);
  const bool pressures = model::leg_type(machine) == model::LegType::cylinder;
  for (int i = 0; i < 6 && pressures; ++i) {
    C.row(ControllerInputs::cap_pressure + i) = plant.C.row(OutputRows::pressures + 2 * i);
    C.row(ControllerInputs::rod_pressure + i) = plant.C.row(OutputRows::pressures + 2 * i + 1);
  }
  if (accelerations) {
    const auto legs = kinematics::inverse_kinematics(machine, X_BP);
    const auto J = kinematics::leg_jacobian(legs, kinematics::mass_center(machine, X_BP));
    C.middleRows(ControllerInputs::acceleration, 6) =
        J * plant.C.middleRows(OutputRows::acceleration, 6);
  }
  return C;
}

std::vector<StatePart> plant_parts(const StateLayout& layout, int flexible) {
  constexpr Part directions[6]{Part::x, Part::y, Part::z, Part::rx, Part::ry, Part::rz};
  std::vector<StatePart> parts(static_cast<size_t>(layout.tangent()));
  const int shift = 1;  // the quaternion's place is one shorter in a small change
  const auto mechanics = [&](int first) {
    for (int i = 0; i < 6; ++i) parts[static_cast<size_t>(first + i)] = {directions[i], -1};
    for (int i = 0; i < model::leg_count * flexible; ++i)
      parts[static_cast<size_t>(first + 6 + i)] = {Part::seal, i / flexible};
    for (int i = 0; i < layout.payload; ++i)
      parts[static_cast<size_t>(first + 6 + model::leg_count * flexible + i)] = {Part::payload, -1};
  };
  mechanics(0);
  mechanics(layout.positions - shift);
  for (int i = 0; layout.nuts >= 0 && i < 3 * model::leg_count; ++i)
    parts[static_cast<size_t>(layout.nuts - shift + i)] = {Part::motor, i / 3};
  for (int i = 0; layout.pressures >= 0 && i < 12; ++i) {
    parts[static_cast<size_t>(layout.pressures - shift + i)] = {Part::oil, i / 2};
    parts[static_cast<size_t>(layout.spools - shift + i)] = {Part::valve, i / 2};
  }
  if (layout.supply >= 0) parts[static_cast<size_t>(layout.supply - shift)] = {Part::supply, -1};
  for (int i = 0; layout.bristles >= 0 && i < 6; ++i)
    parts[static_cast<size_t>(layout.bristles - shift + i)] = {Part::friction, i};
  for (int i = 0; i < 2 * model::leg_count; ++i)
    for (int k = 0; layout.lines[static_cast<size_t>(i)] >= 0 && k < layout.line_states; ++k)
      parts[static_cast<size_t>(layout.lines[static_cast<size_t>(i)] - shift + k)] = {Part::line,
                                                                                      i / 2};
  const int end = layout.arms < 0 ? layout.size : layout.arms;
  for (int i = layout.base; i >= 0 && i < end; ++i)
    parts[static_cast<size_t>(i - shift)] = {Part::base, -1};
  constexpr int per_seal = 2 * static_cast<int>(dynamics::arms_per_seal);
  for (const auto* first : {&layout.sleeve_arms, &layout.ring_arms})
    for (int leg = 0; leg < model::leg_count; ++leg)
      for (int i = 0; (*first)[static_cast<size_t>(leg)] >= 0 && i < per_seal; ++i)
        parts[static_cast<size_t>((*first)[static_cast<size_t>(leg)] + i - shift)] = {Part::seal,
                                                                                      leg};
  return parts;
}

/// Plant::scales with the quaternion's four numbers replaced by the rotation vector's three.
Eigen::VectorXd tangent_scales(const Plant& plant) {
  const Eigen::VectorXd scales = plant.scales();
  Eigen::VectorXd tangent(scales.size() - 1);
  tangent << scales.head<3>(), scales.segment<3>(4), scales.tail(scales.size() - 7);
  return tangent;
}

/// Motion that the base's states give a point at `r`: 6 × states of the plant.
MatrixXd carried_by_base(const Plant& plant, const Vector3& r) {
  const auto& layout = plant.layout();
  const auto& base = plant.base();
  MatrixXd rows = MatrixXd::Zero(6, layout.tangent());
  for (int k = 0; k < base.count; ++k)
    rows.col(layout.base - 1 + k) =
        dynamics::carried(spatial::Vector6::Unit(base.directions[static_cast<size_t>(k)]), r);
  return rows;
}

/// What the loop is made of.
struct Pieces {
  LinearPlant plant{};
  MatrixXd measured{};  ///< 24 × plant states
  LinearController controller{};
  double sample_time{}, delay{};  ///< [s], [samples]

  [[nodiscard]] MatrixXd valve() const { return plant.B.leftCols(6); }
  [[nodiscard]] MatrixXd D_measured() const { return controller.D.leftCols(24); }
};

/// Plant, controller and Padé states as one continuous system.
void close_continuous(const Pieces& p, LinearSystem& system) {
  const double tau = system.delay;
  const int order = tau > 0.0 ? system.pade_order : 0;
  const auto n = p.plant.A.rows(), nc = p.controller.A.rows();
  const Eigen::Index nd = 6 * order, all = n + nc + nd;
  // u = u_x [x; ξ] + u_r r + u_v ṙ; at the valves D_p u + C_p η, the same for each leg
  MatrixXd u = MatrixXd::Zero(6, all);
  u.leftCols(n) = p.D_measured() * p.measured;
  u.middleCols(n, nc) = p.controller.C;
  const MatrixXd u_command = p.controller.D.middleCols(ControllerInputs::command, 6);
  const MatrixXd u_velocity = p.controller.D.middleCols(ControllerInputs::velocity, 6);
  const ScalarSystem pade = order > 0 ? pade_delay(tau, order) : ScalarSystem{{}, {}, {}, 1.0};

  MatrixXd applied = pade.D * u;
  system.A = MatrixXd::Zero(all, all);
  system.B_command = system.B_velocity = MatrixXd::Zero(all, 6);
  for (int leg = 0; leg < 6 && order > 0; ++leg) {
    const auto first = n + nc + leg * order;
    system.A.block(first, first, order, order) += pade.A;
    system.A.middleRows(first, order) += pade.B * u.row(leg);
    system.B_command.middleRows(first, order) = pade.B * u_command.row(leg);
    system.B_velocity.middleRows(first, order) = pade.B * u_velocity.row(leg);
    applied.row(leg).segment(first, order) += pade.C;
  }
  system.A.topLeftCorner(n, n) += p.plant.A;
  system.A.topRows(n) += p.valve() * applied;
  system.applied = {applied, pade.D * u_command, pade.D * u_velocity};
  system.A.block(n, 0, nc, n) += p.controller.B.leftCols(24) * p.measured;
  system.A.block(n, n, nc, nc) += p.controller.A;
  system.B_command.topRows(n) += pade.D * p.valve() * u_command;
  system.B_velocity.topRows(n) += pade.D * p.valve() * u_velocity;
  system.B_command.middleRows(n, nc) = p.controller.B.middleCols(ControllerInputs::command, 6);
  system.B_velocity.middleRows(n, nc) = p.controller.B.middleCols(ControllerInputs::velocity, 6);
  for (const auto& state : p.controller.states) {
    system.states.push_back(state);
    system.parts.push_back({Part::controller, -1});
  }
  for (int i = 0; i < nd; ++i) {
    system.states.push_back(fmt::format("delay of leg {}, {}", i / order + 1, i % order + 1));
    system.parts.push_back({Part::delay, i / order});
  }
}

/// e^{A t} and ∫e^{A s} ds B over `t`.
struct Stepped {
  MatrixXd Phi{}, Gamma{};
};
Stepped stepped(const MatrixXd& A, const MatrixXd& B, const Eigen::VectorXd& scales, double t) {
  const auto n = A.rows(), m = B.cols();
  MatrixXd both =
      MatrixXd::Zero(n + m, n + m);  // in scaled states, or the exponential loses digits
  both.topLeftCorner(n, n) = t * scales.cwiseInverse().asDiagonal() * A * scales.asDiagonal();
  both.topRightCorner(n, m) = t * scales.cwiseInverse().asDiagonal() * B;
  const MatrixXd power = both.exp();
  return {scales.asDiagonal() * power.topLeftCorner(n, n) * scales.cwiseInverse().asDiagonal(),
          scales.asDiagonal() * power.topRightCorner(n, m)};
}

/// x_{k+1} from x_k, ξ_k and the drives of the last samples, and from the command.
void close_sampled(const Pieces& p, LinearSystem& system) {
  const Eigen::VectorXd& scales = system.scales;
  const auto n = p.plant.A.rows(), nc = p.controller.A.rows();
  const int whole = static_cast<int>(std::floor(p.delay + 1e-9));
  const double part = std::max(p.delay - whole, 0.0);
  const bool fraction = part > 1e-9;
  // Drives of the sample k − whole act from the fraction on, those of k − whole − 1 before it.
  const Stepped late = stepped(p.plant.A, p.valve(), scales, (1.0 - part) * p.sample_time);
  const Stepped early =
      fraction ? stepped(p.plant.A, p.valve(), scales, part * p.sample_time) : Stepped{};
  const int memory = whole + (fraction ? 1 : 0);  // past drives u_{k−1} … u_{k−memory}
  const auto all = n + nc + 6 * memory;
  // u_k from the states, and in twelve columns more from r_k and ṙ_k
  MatrixXd u = MatrixXd::Zero(6, all + 12);
  u.leftCols(n) = p.D_measured() * p.measured;
  u.middleCols(n, nc) = p.controller.C;
  u.rightCols(12) = p.controller.D.middleCols(ControllerInputs::command, 12);
  const auto drive = [&](int back) -> MatrixXd {  // u_{k−back} from the states
    if (back == 0) return u;
    MatrixXd past = MatrixXd::Zero(6, all + 12);
    past.middleCols(n + nc + 6 * (back - 1), 6).setIdentity();
    return past;
  };
  MatrixXd next = MatrixXd::Zero(all, all + 12);
  next.topLeftCorner(n, n) = fraction ? MatrixXd(late.Phi * early.Phi) : late.Phi;
  next.topRows(n) += late.Gamma * drive(whole);
  if (fraction) next.topRows(n) += late.Phi * early.Gamma * drive(whole + 1);
  next.block(n, 0, nc, n) = p.controller.B_d.leftCols(24) * p.measured;
  next.block(n, n, nc, nc) = p.controller.A_d;
  next.block(n, all, nc, 12) = p.controller.B_d.middleCols(ControllerInputs::command, 12);
  for (int back = 1; back <= memory; ++back)
    next.middleRows(n + nc + 6 * (back - 1), 6) = drive(back - 1);
  system.sampled = next.leftCols(all);
  system.sampled_command = next.middleCols(all, 6);
  system.sampled_velocity = next.rightCols(6);
  const MatrixXd applied = drive(memory);
  system.sampled_applied = {applied.leftCols(all), applied.middleCols(all, 6),
                            applied.rightCols(6)};
}

}  // namespace

const char* name(Part part) {
  constexpr const char* names[part_count]{
      "platform x", "platform y", "platform z", "platform rx", "platform ry", "platform rz",
      "seals",      "oil",        "valves",     "supply",      "friction",    "controller",
      "delay",      "base",       "payload",    "lines",       "motors"};
  return names[static_cast<int>(part)];
}

LinearSystem linear_system(const model::Machine& machine, const Pose& X_BP,
                           const LinearSystemOptions& options) {
  if (options.pade_order < 0 || options.pade_order > highest_pade_order)
    throw std::invalid_argument(
        fmt::format("LinearSystemOptions::pade_order is {}, expected 0 to {}", options.pade_order,
                    highest_pade_order));
  const Plant plant(machine, options.kind, small_motions, X_BP);
  const auto rest = plant.equilibrium(X_BP);
  Pieces pieces{.plant = plant.linearise(rest.x, rest.input)};

  LinearSystem system;
  system.states = plant.tangent_names();
  system.parts = plant_parts(plant.layout(), dynamics::flexible_per_leg(options.kind));
  system.scales = tangent_scales(plant);
  const auto n = pieces.plant.A.rows();
  if (!options.closed) {
    system.A = pieces.plant.A;
    system.B_command = system.B_velocity = MatrixXd::Zero(n, 6);
  } else {
    const auto p = options.controller != nullptr ? *options.controller
                                                 : tune_controller(machine, X_BP).parameters;
    Vector6 loads = Vector6::Zero();  // electric drives are not corrected for them
    for (int i = 0; plant.layout().pressures >= 0 && i < 6; ++i)
      loads[i] = rest.x[plant.layout().cap(i)] * p.axes[static_cast<size_t>(i)].piston_area -
                 rest.x[plant.layout().rod(i)] * p.axes[static_cast<size_t>(i)].annulus_area;
    pieces.controller = control::linear_controller(machine, p, X_BP, rest.input.command, loads);
    pieces.measured = measurements(pieces.plant, machine, X_BP,
                                   p.feedback == model::DampingFeedback::acceleration);
    pieces.sample_time = system.sample_time = p.sample_time;
    pieces.delay = p.delay;
    system.pade_order = options.pade_order;
    system.delay = options.pade_order > 0 ? (p.delay + 0.5) * p.sample_time : 0.0;
    if (options.sampled) close_sampled(pieces, system);
    close_continuous(pieces, system);
  }
  system.B_valve = system.B_wrench = MatrixXd::Zero(system.A.rows(), 6);
  system.B_valve.topRows(n) = pieces.valve();
  system.B_wrench.topRows(n) = pieces.plant.B.rightCols(6);
  system.C = MatrixXd::Zero(6, system.A.rows());
  system.C.leftCols(n) = origin_from_center(machine, X_BP) * pieces.plant.C.topRows(6);
  system.C_ground = system.C;
  system.C_ground.leftCols(n) += carried_by_base(plant, X_BP.p_BP);
  const Eigen::VectorXd plant_scales = system.scales;
  system.scales = Eigen::VectorXd::Ones(system.A.rows());
  system.scales.head(n) = plant_scales;
  return system;
}

}  // namespace hydrapod::simulation
