#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <ranges>

#include "hydrapod/base/error.hpp"
#include "hydrapod/spatial/pose.hpp"
#include "plant_work.hpp"

namespace hydrapod::simulation {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using model::leg_count;

constexpr int inputs = 12;
constexpr int quaternion = 3;  // place in y

/// One kind of state: how it is called, its unit, what size of it matters, and the step for
/// differences: small against what bends f (the seals' geometry, tanh(v / v_0), √Δp), large against
/// rounding.
struct Kind {
  const char* unit;
  double scale, step;
};
constexpr Kind length{"m", 1e-2, 3e-4}, turn{"1", 1e-2, 3e-4}, tilt{"rad", 1e-2, 3e-4},
    offset{"m", 1e-3, 3e-5}, velocity{"m/s", 0.1, 1e-5}, turning{"rad/s", 0.1, 1e-5},
    tilting{"rad/s", 0.1, 1e-5}, shifting{"m/s", 1e-2, 1e-6}, pressure{"Pa", 1e6, 30.0},
    line_flow{"m^3/s", 1e-3, 1e-6}, spool{"1", 0.1, 3e-5}, spool_rate{"1/s", 10.0, 1e-2},
    bristle{"m", 1e-5, 1e-8}, joint_bristle{"rad", 1e-5, 1e-8}, base_shift{"m", 1e-2, 1e-5},
    base_turn{"rad", 1e-2, 1e-5}, base_shifting{"m/s", 0.1, 1e-4}, base_turning{"rad/s", 0.1, 1e-4},
    arm{"m", 1e-4, 1e-6},  //
    square{"1", 0.1, 1e-5}, swing{"m", 0.1, 3e-3}, swinging{"m/s", 1.0, 1e-4}, nut{"m", 1e-2, 1e-5},
    nut_rate{"m/s", 0.1, 1e-5}, torque{"N m", 10.0, 1e-3};

struct Described {
  std::string name;
  Kind kind;
};

void add_flexible(int per_leg, const char* suffix, const Kind& of_tilt, const Kind& of_offset,
                  std::vector<Described>& all) {
  constexpr std::array<const char*, 4> names{"phi1", "phi2", "u1", "u2"};
  for (int leg = 1; leg <= leg_count; ++leg)
    for (int k = 0; k < per_leg; ++k)
      all.push_back(
          {fmt::format("leg{}.{}{}", leg, names[k], suffix), k < 2 ? of_tilt : of_offset});
}

void add_base(const dynamics::MovingBase& base, const char* suffix, const Kind& of_shift,
              const Kind& of_turn, std::vector<Described>& all) {
  for (int k = 0; k < base.count; ++k) {
    const int direction = base.directions[static_cast<size_t>(k)];
    all.push_back({fmt::format("base.{}{}", spatial::direction_name(direction), suffix),
                   direction < 3 ? of_shift : of_turn});
  }
}

/// Those of the guide sleeves, then those of the piston rings.
void add_arms(const StateLayout& layout, std::vector<Described>& all) {
  const auto add = [&](const std::array<int, leg_count>& first, const char* seal) {
    for (size_t leg = 0; leg < leg_count; ++leg)
      for (size_t j = 1; first[leg] >= 0 && j <= dynamics::arms_per_seal; ++j)
        for (const char* axis : {"t", "a2"})
          all.push_back({fmt::format("leg{}.{}_{}{}", leg + 1, seal, axis, j), arm});
  };
  add(layout.sleeve_arms, "sleeve");
  add(layout.ring_arms, "ring");
}

/// In the same order.
void add_softening(const StateLayout& layout, std::vector<Described>& all) {
  const auto add = [&](const std::array<int, leg_count>& first, const char* seal) {
    for (size_t leg = 0; leg < leg_count; ++leg) {
      if (first[leg] < 0) continue;
      all.push_back({fmt::format("leg{}.{}_amplitude_square", leg + 1, seal), square});
      for (const char* axis : {"t", "a2"})
        all.push_back({fmt::format("leg{}.{}_mean_{}", leg + 1, seal, axis), arm});
    }
  };
  add(layout.sleeve_softening, "sleeve");
  add(layout.ring_softening, "ring");
}

/// Segments: pressures from the valve on, flows. Modes: those of the modes from the column on, of
/// which the column's pressure is that at the valve with a share of the chamber's.
void add_lines(const StateLayout& layout, bool modal, std::vector<Described>& all) {
  for (size_t k = 0; k < layout.lines.size(); ++k) {
    if (layout.lines[k] < 0) continue;
    const auto line = fmt::format("leg{}.{}_line", k / 2 + 1, k % 2 == 0 ? "cap" : "rod");
    const int pairs = layout.line_states / 2, first_flow = modal ? 0 : 1;
    const char *of_pressure = modal ? "mode_p" : "p", *of_flow = modal ? "mode_q" : "q";
    for (int j = 0; j < pairs; ++j)
      all.push_back({fmt::format("{}.{}{}", line, of_pressure, j), pressure});
    for (int j = 0; j < pairs; ++j)
      all.push_back({fmt::format("{}.{}{}", line, of_flow, first_flow + j), line_flow});
  }
}

void add_joints(const StateLayout& layout, std::vector<Described>& all) {
  for (int leg = 1; layout.joints >= 0 && leg <= leg_count; ++leg)
    for (const char* joint : {"base", "platform"})
      for (const char* axis : {"t", "a2"})
        all.push_back({fmt::format("leg{}.{}_joint_bristle_{}", leg, joint, axis), joint_bristle});
}

/// Every state in the order of x.
std::vector<Described> described(const StateLayout& layout,
                                 const dynamics::NonlinearModel& mechanics,
                                 const dynamics::MovingBase& base) {
  std::vector<Described> all;
  const auto add_payload = [&](const char* suffix, const Kind& kind) {
    for (const auto& mode : mechanics.machine().payload_modes)
      all.push_back({fmt::format("payload.{}{}", mode.name, suffix), kind});
  };
  for (const char* name : {"x", "y", "z"}) all.push_back({name, length});
  for (const char* name : {"qw", "qx", "qy", "qz"}) all.push_back({name, turn});
  add_flexible(mechanics.flexible(), "", tilt, offset, all);
  add_payload("", swing);
  for (const char* name : {"vx", "vy", "vz"}) all.push_back({name, velocity});
  for (const char* name : {"wx", "wy", "wz"}) all.push_back({name, turning});
  add_flexible(mechanics.flexible(), "_rate", tilting, shifting, all);
  add_payload("_rate", swinging);
  const auto per_leg = [&](const char* name, const Kind& kind, const char* second,
                           const Kind& of_second) {
    for (int leg = 1; leg <= leg_count; ++leg) {
      all.push_back({fmt::format("leg{}.{}", leg, name), kind});
      if (second) all.push_back({fmt::format("leg{}.{}", leg, second), of_second});
    }
  };
  if (layout.pressures >= 0) {
    per_leg("p_cap", pressure, "p_rod", pressure);
    per_leg("spool", spool, "spool_rate", spool_rate);
  }
  for (int leg = 1; layout.nuts >= 0 && leg <= leg_count; ++leg) {
    all.push_back({fmt::format("leg{}.nut", leg), nut});
    all.push_back({fmt::format("leg{}.nut_rate", leg), nut_rate});
    all.push_back({fmt::format("leg{}.torque_integral", leg), torque});
  }
  if (layout.supply >= 0) all.push_back({"p_supply", pressure});
  if (layout.bristles >= 0) per_leg("bristle", bristle, nullptr, bristle);
  add_lines(layout, mechanics.machine().hydraulics.lines.modes > 0.0, all);
  add_joints(layout, all);
  add_base(base, "", base_shift, base_turn, all);
  add_base(base, "_rate", base_shifting, base_turning, all);
  add_arms(layout, all);
  add_softening(layout, all);
  return all;
}

/// The same for small changes: a rotation vector instead of the quaternion.
std::vector<Described> described_tangent(const StateLayout& layout,
                                         const dynamics::NonlinearModel& mechanics,
                                         const dynamics::MovingBase& base) {
  auto all = described(layout, mechanics, base);
  all.erase(all.begin() + quaternion);
  const Kind angle{"rad", turn.scale, turn.step};
  constexpr std::array<const char*, 3> names{"rx", "ry", "rz"};
  for (int k = 0; k < 3; ++k) all[quaternion + k] = {names[k], angle};
  return all;
}

std::vector<std::string> names_of(const std::vector<Described>& all) {
  std::vector<std::string> names;
  for (const auto& state : all) names.push_back(state.name);
  return names;
}

Vector3 rotation_vector(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) {
  const Eigen::AngleAxisd turned(to * from.conjugate());
  const double angle = turned.angle() > M_PI ? turned.angle() - 2.0 * M_PI : turned.angle();
  return angle * turned.axis();
}

Eigen::Quaterniond orientation(const double* x) {
  return Eigen::Quaterniond(x[3], x[4], x[5], x[6]).normalized();
}

/// Of the steps for positions: the corner of a guide ring is some hundredths of a millimetre wide
/// (dynamics/guide_contact.hpp), tens of times less than the steps that suit everything else.
double position_steps(const model::Machine& machine) {
  constexpr double within_corner = 1e-2;
  const bool contact = std::ranges::any_of(
      machine.legs, [](const model::Leg& leg) { return leg.guide_sleeve.gap.has_value(); });
  return contact ? within_corner : 1.0;
}

}  // namespace

std::vector<std::string> Plant::state_names() const {
  return names_of(described(layout_, mechanics_, base_));
}

std::vector<std::string> Plant::tangent_names() const {
  return names_of(described_tangent(layout_, mechanics_, base_));
}

std::vector<std::string> Plant::state_units() const {
  std::vector<std::string> units;
  for (const auto& state : described(layout_, mechanics_, base_))
    units.emplace_back(state.kind.unit);
  return units;
}

VectorXd Plant::scales() const {
  const auto all = described(layout_, mechanics_, base_);
  VectorXd scales(layout_.size);
  for (int k = 0; k < layout_.size; ++k) scales[k] = all[k].kind.scale;
  return scales;
}

VectorXd Plant::steps() const {
  const auto all = described(layout_, mechanics_, base_);
  const double finer = position_steps(machine_);
  VectorXd steps(layout_.size);
  for (int k = 0; k < layout_.size; ++k)
    steps[k] = k < layout_.velocity() ? finer * all[k].kind.step : all[k].kind.step;
  return steps;
}

std::vector<std::string> Plant::linear_output_names() const {
  std::vector<std::string> names(spatial::direction_names.begin(), spatial::direction_names.end());
  const auto per_leg = [&](const char* name) {
    for (int leg = 1; leg <= leg_count; ++leg) names.push_back(fmt::format("leg{}.{}", leg, name));
  };
  per_leg("l");
  per_leg("l_rate");
  const auto two_per_leg = [&](const char* first, const char* second) {
    for (int leg = 1; leg <= leg_count; ++leg)
      for (const char* name : {first, second}) names.push_back(fmt::format("leg{}.{}", leg, name));
  };
  if (layout_.pressures >= 0) two_per_leg("p_cap", "p_rod");
  if (layout_.nuts >= 0) two_per_leg("torque", "motor_speed");
  for (const char* name : {"ax", "ay", "az", "arx", "ary", "arz"}) names.emplace_back(name);
  return names;
}

void Plant::displace(const double* x, const double* change, double* result) const {
  for (int k = 0; k < 3; ++k) result[k] = x[k] + change[k];
  const Vector3 turned(change[3], change[4], change[5]);
  const double angle = turned.norm();
  const Eigen::Quaterniond by(
      Eigen::AngleAxisd(angle, angle > 0.0 ? Vector3(turned / angle) : Vector3::UnitX()));
  const Eigen::Quaterniond q = by * Eigen::Quaterniond(x[3], x[4], x[5], x[6]);
  result[3] = q.w();
  result[4] = q.x();
  result[5] = q.y();
  result[6] = q.z();
  for (int k = 7; k < layout_.size; ++k) result[k] = x[k] + change[k - 1];
}

/// Rates of a small change of x, then outputs.
VectorXd Plant::tangent_rates(const VectorXd& x, const VectorXd& x_0,
                              const PlantInput& input) const {
  Work work;
  VectorXd rate(layout_.size);
  if (!evaluate(x.data(), input, rate.data(), work))
    throw base::ComputationError("linearisation: a leg does not close near this state");
  const VectorXd& v = x;
  const int n = layout_.tangent(), first_v = layout_.velocity();
  const int of_actuators = options_.hydraulics ? 2 * leg_count : 0;
  VectorXd out(n + 24 + of_actuators);
  out.head<3>() = rate.head<3>();
  out.segment<3>(3) = v.segment<3>(first_v + 3);
  out.segment(6, n - 6) = rate.tail(n - 6);
  auto y = out.tail(24 + of_actuators);
  y.head<3>() = x.head<3>() - x_0.head<3>();
  y.segment<3>(3) = rotation_vector(orientation(x_0.data()), orientation(x.data()));
  for (int i = 0; i < leg_count; ++i) {
    y[6 + i] = work.motion.legs[i].length;
    y[12 + i] = work.motion.legs[i].length_rate;
  }
  if (layout_.pressures >= 0)
    y.segment(18, of_actuators) = x.segment(layout_.pressures, of_actuators);
  for (int i = 0; layout_.nuts >= 0 && i < leg_count; ++i) {
    y[18 + 2 * i] = work.legs[i].torque;
    y[19 + 2 * i] = work.legs[i].motor_speed;
  }
  y.tail<6>() =
      rate.segment<6>(first_v) + dynamics::carried(work.base_acceleration, work.motion.p_BC);
  return out;
}

LinearPlant Plant::linearise(const VectorXd& x, const PlantInput& input) const {
  const auto states = described_tangent(layout_, mechanics_, base_);
  const int n = layout_.tangent();
  const double finer = position_steps(machine_);
  const int first_rate = layout_.velocity() - 1;  // the rotation has three numbers here
  const auto column = [&](double h, const auto& rates_at) -> VectorXd {
    return (8.0 * (rates_at(h) - rates_at(-h)) - (rates_at(2.0 * h) - rates_at(-2.0 * h))) /
           (12.0 * h);
  };
  const auto rows = tangent_rates(x, x, input).size();
  MatrixXd all(rows, n + inputs);
  VectorXd change = VectorXd::Zero(n), moved(layout_.size);
  for (int k = 0; k < n; ++k) {
    const double step = states[k].kind.step;
    all.col(k) = column(k < first_rate ? finer * step : step, [&](double h) {
      change[k] = h;
      displace(x.data(), change.data(), moved.data());
      change[k] = 0.0;
      return tangent_rates(moved, x, input);
    });
  }
  for (int k = 0; k < inputs; ++k) {
    // Linear in the wrench; in commands too, as long as the spool keeps its rate.
    const double step = k < 6 ? spool.step : machine_.platform.mass;
    all.col(n + k) = column(step, [&](double h) {
      PlantInput changed = input;
      (k < 6 ? changed.command[k] : changed.wrench[k - 6]) += h;
      return tangent_rates(x, x, changed);
    });
  }
  // R = exp(δθ) R_0 with R_0 turning: (δθ)˙ = δω + ω × δθ.
  all.block<3, 3>(3, 3) += spatial::skew(x.segment<3>(layout_.velocity() + 3));
  return {all.topLeftCorner(n, n), all.topRightCorner(n, inputs), all.bottomLeftCorner(rows - n, n),
          all.bottomRightCorner(rows - n, inputs)};
}

}  // namespace hydrapod::simulation
