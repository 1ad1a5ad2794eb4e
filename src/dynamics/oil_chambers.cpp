#include "oil_chambers.hpp"

#include <fmt/format.h>

#include <cmath>

#include "hydrapod/base/error.hpp"
#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"

namespace hydrapod::dynamics {

namespace {

/// `force`: of the oil on the piston [N].
hydraulics::HydraulicRest rest_of(const hydraulics::ServoAxis& axis, const model::Supply& supply,
                                  int i, double s, double force) {
  if (s < axis.stops.low || s > axis.stops.high)
    throw base::ComputationError(fmt::format(
        "chambers of the oil: at this pose the piston of leg {} stands at {:.4g} m from the base "
        "joint, outside its stroke of {:.4g} to {:.4g} m; damping.oil = \"viscous\" does without "
        "chambers",
        i + 1, s, axis.stops.low, axis.stops.high));
  const auto rest = hydraulics::hydraulic_rest(axis, supply, force);
  if (!rest.found)
    throw base::ComputationError(fmt::format(
        "chambers of the oil: a supply of {:.4g} MPa cannot hold the static force of {:.4g} N on "
        "leg {} at this pose; expected a higher `supply.pressure`, a larger cylinder, less leakage "
        "or damping.oil = \"viscous\", which does without chambers",
        1e-6 * supply.pressure, force, i + 1));
  return rest;
}

}  // namespace

void fill_chambers(const model::Machine& machine, LinearModel& model) {
  const auto& supply = machine.hydraulics.supply;
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine.legs[i];
    auto& element = model.legs[i];
    const auto axis = hydraulics::servo_axis(machine, i);
    const double force = 0.0 - model.statics.legs[i].oil_force;
    const auto rest = rest_of(axis, supply, i, element.l_m, force);
    const auto chambers = hydraulics::small_chambers(axis, supply, rest, element.l_m);
    // Seals that stick are beside the oil, and gimbals in series with both: of c = 1/k_j and D =
    // 1 + c k_b (Z + k_b)/(1 + c (Z + k_b)) = k_b/D + Z/(1 + Z c/D)/D².
    const double compliance = leg.gimbal_stiffness ? 1.0 / *leg.gimbal_stiffness : 0.0;
    const double beside = 1.0 + compliance * leg.stick_stiffness;
    auto spring = hydraulics::relaxing_spring(chambers, compliance / beside);
    for (double& k : spring.stiffness) k /= beside * beside;
    const Matrix7 along = element.s_x * element.s_x.transpose();
    const double stiffness = spring.closed() + leg.stick_stiffness / beside;
    element.K += (stiffness - element.k_h) * along;
    element.k_h = stiffness;
    element.C += axis.friction.viscous * along;
    for (std::size_t j = 0; j < 2; ++j)
      model.arms.push_back(
          {.leg = i, .stiffness = spring.stiffness[j], .rate = spring.rate[j], .s_y = element.s_x});
  }
}

void point_arms(LinearModel& model) {
  for (auto& arm : model.arms) arm.s_y = per_coordinate(model, arm.leg, Vector7(arm.s_y));
}

void damp_mount(const model::Machine& machine, LinearModel& model) {
  const double ratio = model::seal_ratio(machine).value;
  const double beta = machine.damping.rayleigh_stiffness;
  Matrix6 inertia = model.base_inertia.asDiagonal();
  for (const auto& leg : model.legs_on_base) inertia += leg.inertia;
  Matrix6 carried = Matrix6::Identity();
  carried.topRightCorner<3, 3>() = -spatial::skew(model.p_BC);
  const Matrix6 swinging = model.payload * model.payload.transpose();
  const Matrix6 platform =
      model.payload_count() == 0 ? model.platform_mass : Matrix6(model.platform_mass + swinging);
  inertia += carried.transpose() * platform * carried;
  for (int k = 0; k < model.base_count(); ++k) {
    const int direction = model.base_directions[static_cast<std::size_t>(k)];
    const double stiffness = model.k_mount[direction];
    const int at = model.first_of_base() + k;
    model.C(at, at) +=
        2.0 * ratio * std::sqrt(stiffness * inertia(direction, direction)) + beta * stiffness;
  }
}

}  // namespace hydrapod::dynamics
