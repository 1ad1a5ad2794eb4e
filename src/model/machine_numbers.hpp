#pragma once
/// Every number of a machine that its linear models depend on, one after the other. Private to the
/// module.

#include "hydrapod/model/machine.hpp"

namespace hydrapod::model {

template <class Visit, class Matrix>
void visit_matrix(Matrix& matrix, Visit& visit) {
  for (Eigen::Index i = 0; i < matrix.size(); ++i) visit(matrix.data()[i]);
}

template <class Visit>
void visit_cylinder(Cylinder& c, Visit& visit) {
  for (double* number : {&c.bore, &c.rod_diameter, &c.cap_dead_volume, &c.rod_dead_volume,
                         &c.cap_line_volume, &c.rod_line_volume, &c.bulk_modulus})
    visit(*number);
  if (c.air)
    for (double* number : {&c.air->fraction, &c.air->pressure, &c.air->polytropic}) visit(*number);
  if (c.control_volume) visit(*c.control_volume);
}

template <class Visit>
void visit_leg(Leg& leg, Visit& visit) {
  visit_matrix(leg.base_joint, visit);
  visit_matrix(leg.platform_joint, visit);
  visit_matrix(leg.gimbal_axis, visit);
  auto& tube = leg.cylinder_case;
  for (double* number :
       {&tube.mass, &tube.mass_center, &tube.transverse_inertia, &tube.axial_inertia})
    visit(*number);
  auto& rod = leg.rod;
  for (double* number :
       {&rod.length, &rod.mass, &rod.mass_center, &rod.transverse_inertia, &rod.axial_inertia})
    visit(*number);
  auto& sleeve = leg.guide_sleeve;
  for (double* number : {&sleeve.position, &sleeve.stiffness, &sleeve.damping}) visit(*number);
  if (leg.piston_ring)
    for (double* number : {&leg.piston_ring->stiffness, &leg.piston_ring->damping}) visit(*number);
  auto& oil = leg.oil_spring;
  if (oil.stiffness) visit(*oil.stiffness);
  if (oil.cylinder) visit_cylinder(*oil.cylinder, visit);
  visit(oil.damping);
  visit(leg.added_axial_inertia);
  if (leg.gimbal_stiffness) visit(*leg.gimbal_stiffness);
  // where both chambers are equal, the stroke's middle gives their volume
  if (leg.stroke)
    for (double* number : {&leg.stroke->retracted, &leg.stroke->length}) visit(*number);
}

/// Calls visit(double&) for every number, in an order that depends only on what is there.
template <class Visit>
void for_each_number(Machine& machine, Visit visit) {
  visit_matrix(machine.gravity, visit);
  visit(machine.platform.mass);
  visit_matrix(machine.platform.mass_center, visit);
  visit_matrix(machine.platform.inertia, visit);
  for (auto& leg : machine.legs) visit_leg(leg, visit);
  if (machine.base_mount) {
    for (auto& stiffness : machine.base_mount->stiffness)
      if (stiffness) visit(*stiffness);
    visit(machine.base_mount->mass);
    visit_matrix(machine.base_mount->inertia, visit);
  }
  if (machine.damping.modal_ratio) visit(*machine.damping.modal_ratio);
  visit(machine.damping.rayleigh_mass);
  visit(machine.damping.rayleigh_stiffness);
  for (auto& pose : machine.poses) {
    visit_matrix(pose.X_BP.R_BP, visit);
    visit_matrix(pose.X_BP.p_BP, visit);
  }
}

}  // namespace hydrapod::model
