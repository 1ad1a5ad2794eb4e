#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <unsupported/Eigen/MatrixFunctions>

#include "hydrapod/base/error.hpp"
#include "hydrapod/base/text.hpp"
#include "hydrapod/exchange/exchange.hpp"
#include "hydrapod/modal/normal_modes.hpp"
#include "hydrapod/numerics/dense.hpp"
#include "hydrapod/response/frequency_response.hpp"

namespace hydrapod::exchange {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using spatial::direction_names;

using Signals = std::vector<Signal>;

/// "x", … with a prefix; lengths have the unit `of_length`, angles `of_angle`.
void add_directions(const std::string& prefix, const char* of_length, const char* of_angle,
                    Signals& signals) {
  for (int i = 0; i < 6; ++i)
    signals.push_back(
        {prefix + direction_names[static_cast<std::size_t>(i)], i < 3 ? of_length : of_angle, 0.0});
}

void add_legs(const char* name, const char* unit, Signals& signals) {
  for (int i = 1; i <= model::leg_count; ++i)
    signals.push_back({fmt::format("leg{}.{}", i, name), unit, 0.0});
}

void add_wrench(Signals& signals) {
  constexpr std::array names{"fx", "fy", "fz", "mx", "my", "mz"};
  for (std::size_t i = 0; i < 6; ++i)
    signals.push_back({std::string("wrench.") + names[i], i < 3 ? "N" : "N m", 0.0});
}

void set_rest(const Eigen::Ref<const VectorXd>& values, std::size_t first, Signals& signals) {
  for (Index i = 0; i < values.size(); ++i)
    signals[first + static_cast<std::size_t>(i)].rest = values[i];
}

/// Position of P's origin and rotation vector of R_BP.
Eigen::Matrix<double, 6, 1> pose_numbers(const Pose& X_BP) {
  const Eigen::AngleAxisd turn(X_BP.R_BP);
  Eigen::Matrix<double, 6, 1> numbers;
  numbers << X_BP.p_BP, turn.angle() * turn.axis();
  return numbers;
}

/// `arms`: those of chambers that relax.
Signals mechanics_states(const dynamics::LinearModel& linear,
                         const std::vector<dynamics::RelaxingArm>& arms) {
  Signals states;
  const auto names =
      dynamics::coordinate_names(linear.kind, linear.base_directions, linear.payload_names);
  for (int rate = 0; rate < 2; ++rate)
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto& name = names[i];
      const bool angle = i < 6                          ? i >= 3
                         : name.starts_with("base.")    ? name.starts_with("base.r")
                         : name.starts_with("payload.") ? false  // for a modal mass of 1 kg
                                                        : name.find(".phi") != std::string::npos;
      states.push_back({name + (rate == 1 ? "_rate" : ""),
                        std::string(angle ? "rad" : "m") + (rate == 1 ? "/s" : ""), 0.0});
    }
  for (std::size_t j = 0; j < arms.size(); ++j) {
    const auto& arm = arms[j];
    const auto before = std::count_if(arms.begin(), arms.begin() + static_cast<std::ptrdiff_t>(j),
                                      [&](const dynamics::RelaxingArm& other) {
                                        return other.leg == arm.leg && other.what == arm.what &&
                                               other.axis == arm.axis;
                                      });
    constexpr const char* seal_axes[]{"t", "a2"};
    const std::string name = arm.what == dynamics::Relaxing::oil      ? "oil"
                             : arm.what == dynamics::Relaxing::sleeve ? "sleeve_"
                                                                      : "ring_";
    states.push_back(
        {fmt::format("leg{}.{}{}{}", arm.leg + 1, name,
                     arm.what == dynamics::Relaxing::oil ? "" : seal_axes[arm.axis], before + 1),
         "m", 0.0});
  }
  return states;
}

StateSpace mechanics(const Machine& machine, const Pose& X_BP, const StateSpaceOptions& options) {
  const auto linear = dynamics::linear_model(machine, X_BP, options.kind);
  const auto modes = modal::normal_modes(linear);
  const double ratio = model::modal_ratio(machine).value;
  const auto at_wrench = response::response_model(linear, modes, ratio, options.p_PQ);
  const auto at_legs =
      response::response_model(linear, modes, ratio, options.p_PQ, response::Input::actuator);
  const Index n = linear.dof(), arms = static_cast<Index>(at_wrench.arms.size());
  // Oil forces f push with s_yᵀ f; the loads at hand are s_yᵀ (∂s/∂q)⁻ᵀ, whose platform part is 1.
  MatrixXd s_q(6, 6);
  const Vector3 arm = at_wrench.p_BQ - linear.p_BC;
  for (int i = 0; i < model::leg_count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    spatial::Matrix6 T = spatial::Matrix6::Identity();  // motion of C per motion of Q
    T.topRightCorner<3, 3>() = spatial::skew(arm);
    s_q.row(i) = linear.legs[k].s_x.head<3>().transpose() * linear.J[k] * T;
  }
  const MatrixXd leg_loads = MatrixXd(at_legs.loads) * s_q.transpose();
  MatrixXd loads(n, 12);
  loads << MatrixXd(at_wrench.loads), leg_loads;
  const MatrixXd M = at_wrench.M;
  const Eigen::LLT<MatrixXd> llt(M);
  StateSpace system;
  system.A = MatrixXd::Zero(2 * n + arms, 2 * n + arms);
  system.A.block(0, n, n, n).setIdentity();
  system.A.block(n, 0, n, n) = -llt.solve(MatrixXd(at_wrench.K));
  system.A.block(n, n, n, n) = -llt.solve(MatrixXd(response::damping_matrix(at_wrench)));
  for (Index j = 0; j < arms; ++j) {
    const auto& oil = at_wrench.arms[static_cast<std::size_t>(j)];
    system.A.col(2 * n + j).segment(n, n) = llt.solve(MatrixXd(oil.stiffness * oil.s_y));
    system.A.row(2 * n + j).head(n) = oil.rate * oil.s_y.transpose();
    system.A(2 * n + j, 2 * n + j) = -oil.rate;
  }
  system.B = MatrixXd::Zero(2 * n + arms, 12);
  system.B.middleRows(n, n) = llt.solve(loads);
  system.C = MatrixXd::Zero(24, 2 * n + arms);
  system.D = MatrixXd::Zero(24, 12);
  system.C.topLeftCorner(6, 6).setIdentity();
  system.C.block(6, n, 6, 6).setIdentity();
  system.C.middleRows(12, 6) = system.A.middleRows(n, 6);
  system.D.middleRows(12, 6) = system.B.middleRows(n, 6);
  system.C.block(18, 0, 6, n) = leg_loads.transpose();
  system.states = mechanics_states(linear, at_wrench.arms);
  add_wrench(system.inputs);
  add_legs("force", "N", system.inputs);
  for (std::size_t i = 0; i < 6; ++i) system.inputs[6 + i].rest = linear.statics.legs[i].oil_force;
  add_directions("", "m", "rad", system.outputs);
  auto at_Q = pose_numbers(X_BP);
  at_Q.head<3>() = at_wrench.p_BQ;
  set_rest(at_Q, 0, system.outputs);
  add_directions("velocity.", "m/s", "rad/s", system.outputs);
  add_directions("acceleration.", "m/s^2", "rad/s^2", system.outputs);
  add_legs("s", "m", system.outputs);
  for (std::size_t i = 0; i < 6; ++i) system.outputs[18 + i].rest = linear.legs[i].l_m;
  return system;
}

/// Units of δx: the quaternion's four numbers are a rotation vector there.
std::vector<std::string> tangent_units(const simulation::Plant& plant) {
  auto units = plant.state_units();
  units.erase(units.begin() + 3);
  std::fill_n(units.begin() + 3, 3, "rad");
  return units;
}

VectorXd tangent_rest(const VectorXd& x, const Pose& X_BP) {
  VectorXd rest(x.size() - 1);
  rest << x.head(3), pose_numbers(X_BP).tail<3>(), x.tail(x.size() - 7);
  return rest;
}

std::string controller_unit(const std::string& state, model::ControlSpace space) {
  if (state.find("delay") == 0) return "1";
  if (state.find("slow force") == 0) return "N";
  if (state.find("slow acceleration") == 0) return "m/s^2";
  const bool angle = space == model::ControlSpace::pose && state.find("integral r") == 0;
  return angle ? "rad s" : "m s";
}

/// A linear output of the plant, by its name.
Signal plant_signal(const std::string& name, const simulation::PlantOutput& at_rest) {
  if (name[0] == 'a') return {name, name[1] == 'r' ? "rad/s^2" : "m/s^2", 0.0};
  const auto& leg = at_rest.legs[static_cast<std::size_t>(name[3] - '1')];
  const auto what = name.substr(name.find('.') + 1);
  if (what == "l_rate") return {name, "m/s", 0.0};
  if (what == "p_cap") return {name, "Pa", leg.cap_pressure};
  if (what == "p_rod") return {name, "Pa", leg.rod_pressure};
  if (what == "torque") return {name, "N m", leg.torque};
  if (what == "motor_speed") return {name, "rad/s", leg.motor_speed};
  return {name, "m", leg.length};
}

/// What the plant's sensors show besides the pose: its linear outputs from the lengths on.
void add_plant_outputs(const simulation::Plant& plant, const simulation::PlantOutput& at_rest,
                       const Pose& X_BP, StateSpace& system) {
  add_directions("", "m", "rad", system.outputs);
  set_rest(pose_numbers(X_BP), 0, system.outputs);
  add_directions("ground.", "m", "rad", system.outputs);
  const auto names = plant.linear_output_names();
  for (std::size_t i = 6; i < names.size(); ++i)
    system.outputs.push_back(plant_signal(names[i], at_rest));
}

/// What the outputs of the plant depend on.
struct PlantRows {
  MatrixXd C{};                   ///< its states
  MatrixXd commands{}, wrench{};  ///< those of valves or motors; force and moment
};

/// Displacement of the platform against base and ground, then plant_signal()s.
PlantRows plant_rows(const simulation::LinearSystem& linear, const simulation::LinearPlant& plant) {
  const Index n = plant.A.rows(), more = plant.C.rows() - 6;
  PlantRows rows{MatrixXd::Zero(12 + more, n), MatrixXd::Zero(12 + more, 6),
                 MatrixXd::Zero(12 + more, 6)};
  rows.C << linear.C.leftCols(n), linear.C_ground.leftCols(n), plant.C.bottomRows(more);
  rows.commands.bottomRows(more) = plant.D.bottomLeftCorner(more, 6);
  rows.wrench.bottomRows(more) = plant.D.bottomRightCorner(more, 6);
  return rows;
}

/// C, and D per commanded pose and its rate, of plant and controller; the plant is the first part
/// of the states.
void set_outputs(const PlantRows& rows, const simulation::AppliedCommands& applied,
                 StateSpace& system) {
  system.C = rows.commands * applied.state;
  system.C.leftCols(rows.C.cols()) += rows.C;
  system.D.resize(system.C.rows(), 12);
  system.D << rows.commands * applied.command, rows.commands * applied.velocity;
}

/// Inputs of the closed loop in front: commands and their rates.
void add_commands(const Pose& X_BP, Signals& inputs) {
  add_directions("command.", "m", "rad", inputs);
  set_rest(pose_numbers(X_BP), inputs.size() - 6, inputs);
  add_directions("command_rate.", "m/s", "rad/s", inputs);
}

void sample_loop(const simulation::LinearSystem& linear, const PlantRows& rows, const Pose& X_BP,
                 StateSpace& system) {
  const Index all = linear.sampled.rows();
  system.A = linear.sampled;
  system.B.resize(all, 12);
  system.B << linear.sampled_command, linear.sampled_velocity;
  set_outputs(rows, linear.sampled_applied, system);
  system.inputs.clear();
  add_commands(X_BP, system.inputs);
  std::size_t own = static_cast<std::size_t>(rows.C.cols());
  while (own < system.states.size() && system.states[own].name.find("delay") != 0) ++own;
  system.states.resize(own);
  for (Index i = static_cast<Index>(own); i < all; ++i) {
    const auto past = i - static_cast<Index>(own);
    system.states.push_back(
        {fmt::format("leg{}.drive {} samples ago", past % 6 + 1, past / 6 + 1), "1", 0.0});
  }
  system.sample_time = linear.sample_time;
  system.delay = 0.0;
  system.pade_order = 0;
}

/// States, inputs and outputs of the plant, with the controller if it is `closed`.
void name_signals(const Machine& machine, const Pose& X_BP, const simulation::Plant& plant,
                  const simulation::Plant::Rest& rest, const std::vector<std::string>& states,
                  bool closed, StateSpace& system) {
  const auto units = tangent_units(plant);
  for (std::size_t i = 0; i < states.size(); ++i)
    system.states.push_back(
        {states[i],
         i < units.size() ? units[i] : controller_unit(states[i], machine.controller.space)});
  set_rest(tangent_rest(rest.x, X_BP), 0, system.states);
  if (closed) add_commands(X_BP, system.inputs);
  add_legs(model::leg_type(machine) == model::LegType::screw ? "drive" : "valve", "1",
           system.inputs);
  set_rest(rest.input.command, system.inputs.size() - 6, system.inputs);
  add_wrench(system.inputs);
  add_plant_outputs(plant, plant.outputs(rest.x.data(), rest.input), X_BP, system);
}

StateSpace with_actuators(const Machine& machine, const Pose& X_BP,
                          const StateSpaceOptions& options) {
  hydraulics::require_actuators(machine);
  const bool closed = options.system == SystemKind::loop;
  const auto linear = simulation::linear_system(
      machine, X_BP, {.kind = options.kind, .pade_order = options.pade_order, .closed = closed});
  const simulation::Plant plant(machine, options.kind, simulation::small_motions, X_BP);
  const auto rest = plant.equilibrium(X_BP);
  const auto rows = plant_rows(linear, plant.linearise(rest.x, rest.input));
  StateSpace system{.A = linear.A, .delay = linear.delay, .pade_order = linear.pade_order};
  name_signals(machine, X_BP, plant, rest, linear.states, closed, system);
  if (options.sampled_controller) {
    sample_loop(linear, rows, X_BP, system);
    return system;
  }
  const Index commands = closed ? 12 : 0;
  system.B.resize(linear.A.rows(), commands + 12);
  if (closed) system.B.leftCols(12) << linear.B_command, linear.B_velocity;
  system.B.rightCols(12) << linear.B_valve, linear.B_wrench;
  if (closed)
    set_outputs(rows, linear.applied, system);
  else
    system.C = rows.C;
  system.D.conservativeResize(rows.C.rows(), commands + 12);
  system.D.rightCols(12) << rows.commands, rows.wrench;
  return system;
}

/// Places in `all` of the signals called `names`.
std::vector<Index> places(const Signals& all, const std::vector<std::string>& names,
                          const char* what) {
  std::vector<std::string_view> known;
  for (const auto& signal : all) known.push_back(signal.name);
  std::vector<Index> found;
  for (const auto& name : names) {
    const auto at = std::ranges::find(known, name);
    if (at == known.end()) {
      const auto near = base::nearest(name, known);
      std::string list;
      for (const auto& one : known) list += (list.empty() ? "" : ", ") + std::string(one);
      base::refuse(fmt::format("{} {}", what, name),
                   near ? fmt::format("no such signal; did you mean '{}'?", *near)
                        : "no such signal, expected one of " + list);
    }
    found.push_back(at - known.begin());
  }
  return found;
}

void select(const StateSpaceOptions& options, StateSpace& system) {
  const auto chosen = [](const Signals& all, const std::vector<Index>& at) {
    Signals some;
    for (const Index i : at) some.push_back(all[static_cast<std::size_t>(i)]);
    return some;
  };
  if (!options.inputs.empty()) {
    const auto at = places(system.inputs, options.inputs, "--inputs");
    system.B = MatrixXd(system.B(Eigen::all, at));
    system.D = MatrixXd(system.D(Eigen::all, at));
    system.inputs = chosen(system.inputs, at);
  }
  if (!options.outputs.empty()) {
    const auto at = places(system.outputs, options.outputs, "--outputs");
    system.C = MatrixXd(system.C(at, Eigen::all));
    system.D = MatrixXd(system.D(at, Eigen::all));
    system.outputs = chosen(system.outputs, at);
  }
}

}  // namespace

StateSpace discretised(const StateSpace& system, double sample_time) {
  if (!(sample_time > 0.0) || system.sample_time != 0.0)
    throw std::invalid_argument(fmt::format(
        "discretised: sample_time is {} s, expected > 0, of a continuous system", sample_time));
  const Index n = system.A.rows(), m = system.B.cols();
  const VectorXd d = numerics::balancing(system.A);
  MatrixXd both = MatrixXd::Zero(n + m, n + m);
  both.topLeftCorner(n, n) =
      sample_time * d.cwiseInverse().asDiagonal() * system.A * d.asDiagonal();
  MatrixXd inputs = sample_time * d.cwiseInverse().asDiagonal() * system.B;
  VectorXd sizes(m);  // inputs of like size too, or large ones cost digits
  for (Index j = 0; j < m; ++j) {
    const double size = inputs.col(j).lpNorm<Eigen::Infinity>();
    sizes[j] = size > 0.0 ? size : 1.0;
  }
  both.topRightCorner(n, m) = inputs * sizes.cwiseInverse().asDiagonal();
  const MatrixXd power = both.exp();
  StateSpace result = system;
  result.A = d.asDiagonal() * power.topLeftCorner(n, n) * d.cwiseInverse().asDiagonal();
  result.B = d.asDiagonal() * power.topRightCorner(n, m) * sizes.asDiagonal();
  result.sample_time = sample_time;
  if (!result.A.allFinite() || !result.B.allFinite())
    throw base::ComputationError(fmt::format(
        "the state space has no discrete form at a sample time of {:g} s: its numbers are beyond "
        "those of doubles",
        sample_time));
  return result;
}

StateSpace state_space(const Machine& machine, const Pose& X_BP, const StateSpaceOptions& options) {
  if (options.reduced_states > 0 && options.sampled_controller)
    throw std::invalid_argument("StateSpaceOptions: reduced_states is for continuous systems");
  if (options.sample_time < 0.0 ||
      (options.sampled_controller &&
       (options.system != SystemKind::loop || options.sample_time > 0.0)))
    throw std::invalid_argument(
        "StateSpaceOptions: sample_time must be ≥ 0, and sampled_controller is for the loop alone");
  StateSpace system = options.system == SystemKind::mechanics
                          ? mechanics(machine, X_BP, options)
                          : with_actuators(machine, X_BP, options);
  system.system = options.system;
  select(options, system);
  if (options.reduced_states > 0) system = reduced(system, options.reduced_states);
  return options.sample_time > 0.0 ? discretised(system, options.sample_time) : system;
}

}  // namespace hydrapod::exchange
