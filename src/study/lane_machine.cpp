#include "lane_machine.hpp"

#include <algorithm>

#include "hydrapod/hydraulics/servo_axis.hpp"
#include "hydrapod/modal/mode_table.hpp"

namespace hydrapod::study {

namespace {

using spatial::Matrix3;
using spatial::Vector3;

bool has_line_inertia(const model::Leg& leg) {
  const auto& cylinder = leg.oil_spring.cylinder;
  return cylinder && (cylinder->cap_line_length != 0.0 || cylinder->rod_line_length != 0.0);
}

void put(const Vector3& v, double (&numbers)[3]) { std::copy_n(v.data(), 3, numbers); }

/// hydraulics::oil_stiffness() as a function of the piston's position.
void put_oil(const model::Leg& leg, LegNumbers<double>& numbers) {
  numbers.gimbal_compliance = leg.gimbal_stiffness ? 1.0 / *leg.gimbal_stiffness : 0.0;
  if (leg.oil_spring.stiffness || leg.screw) {
    numbers.area_squared[0] = leg.screw ? leg.screw->stiffness : *leg.oil_spring.stiffness;
    numbers.area_squared[1] = 0.0;
    std::fill_n(numbers.volume, 2, 1.0);
    std::fill_n(numbers.volume_slope, 2, 0.0);
    return;
  }
  const auto& cylinder = *leg.oil_spring.cylinder;
  const double beta = hydraulics::effective_bulk_modulus(cylinder);
  const auto [piston, annulus] = hydraulics::areas(cylinder);
  const bool equal = cylinder.volumes == model::VolumeRule::equal;
  hydraulics::ChamberVolumes at_zero;
  if (equal)
    at_zero.cap = at_zero.rod = hydraulics::control_volume(leg);
  else
    at_zero = hydraulics::chamber_volumes(cylinder, *leg.stroke, 0.0);
  numbers.area_squared[0] = piston * piston;
  numbers.area_squared[1] = annulus * annulus;
  numbers.volume[0] = at_zero.cap / beta + cylinder.cap_line_compliance;
  numbers.volume[1] = at_zero.rod / beta + cylinder.rod_line_compliance;
  numbers.volume_slope[0] = equal ? 0.0 : piston / beta;
  numbers.volume_slope[1] = equal ? 0.0 : -annulus / beta;
}

void put_bodies(const model::Leg& leg, LegNumbers<double>& numbers) {
  const auto& tube = leg.cylinder_case;
  const auto& rod = leg.rod;
  numbers.l_mn = rod.length;
  numbers.L_g = leg.guide_sleeve.position;
  numbers.m_t = tube.mass;
  numbers.r_b = tube.mass_center;
  numbers.I_t = tube.transverse_inertia;
  numbers.I_ta = tube.axial_inertia;
  numbers.m_g = rod.mass;
  numbers.c_g = rod.mass_center;
  numbers.I_r = rod.transverse_inertia;
  numbers.I_ra = rod.axial_inertia;
  numbers.I_c = leg.gimbal_cross_inertia;
  numbers.m_a = leg.added_axial_inertia;
  numbers.k_s = leg.guide_sleeve.stiffness;
  numbers.k_g = leg.piston_ring ? leg.piston_ring->stiffness : 0.0;
}

}  // namespace

bool fits_lanes(const model::Machine& machine) {
  return model::leg_type(machine) != model::LegType::strut && !machine.base_mount &&
         machine.payload_modes.empty() && !model::has_chambers(machine) &&
         !model::has_elastomers(machine) && !model::has_elastic_legs(machine) &&
         std::ranges::none_of(machine.legs, [](const model::Leg& leg) {
           return leg.guide_sleeve.gap || has_line_inertia(leg) || leg.stick_stiffness > 0.0;
         });
}

LaneOptions lane_options(const model::Machine& machine, double resonance_share) {
  return {.gimbal = machine.flexible_axes == model::FlexibleAxes::gimbal,
          .gravity = !machine.gravity.isZero(0.0),
          .tolerance = dynamics::StaticsOptions{}.tolerance,
          .resonance_share = resonance_share,
          .local_mode_energy = modal::local_mode_energy,
          .repeated_tolerance = modal::repeated_tolerance};
}

MachineNumbers<double> lane_numbers(const model::Machine& machine, const spatial::Pose& X_BP,
                                    const dynamics::StaticEquilibrium* flexible,
                                    const dynamics::StaticEquilibrium* rigid) {
  MachineNumbers<double> numbers;
  const Vector3 C = kinematics::mass_center(machine, X_BP);
  const Matrix3 inertia = X_BP.R_BP * machine.platform.inertia * X_BP.R_BP.transpose();
  numbers.m = machine.platform.mass;
  for (int i = 0, at = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) numbers.inertia[at++] = inertia(i, j);
  put(machine.gravity, numbers.gravity);
  for (int i = 0; i < leg_number; ++i) {
    const auto& leg = machine.legs[i];
    auto& of_leg = numbers.legs[i];
    const Vector3 a = X_BP * leg.platform_joint, L = a - leg.base_joint;
    put(L, of_leg.L);
    put(a - C, of_leg.arm);
    put(dynamics::frame_axis(L.normalized(), leg.gimbal_axis, machine.flexible_axes), of_leg.axis);
    put_bodies(leg, of_leg);
    put_oil(leg, of_leg);
    const dynamics::LegState state = flexible != nullptr ? flexible->legs[i] : dynamics::LegState{};
    std::copy_n(state.flexible.data(), most_flexible, of_leg.flexible);
    of_leg.oil_force = state.oil_force;
    of_leg.oil_force_rigid = rigid != nullptr ? rigid->legs[i].oil_force : 0.0;
  }
  return numbers;
}

}  // namespace hydrapod::study
