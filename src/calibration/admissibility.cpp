#include "hydrapod/calibration/admissibility.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <map>

#include "hydrapod/kinematics/inverse.hpp"

namespace hydrapod::calibration {

namespace {

using model::Leg;
using model::Machine;

/// Share by which `a` is above `b`.
double above(double a, double b) {
  const double scale = std::abs(a) + std::abs(b);
  return scale > 0.0 ? (a - b) / scale : 0.0;
}

/// 0 or more, as a margin that does not grow with the number.
double not_negative(double value) { return value < 0.0 ? -1.0 + std::exp(value) : 0.0; }

void check_platform(const Machine& machine, std::vector<Constraint>& constraints) {
  const auto& platform = machine.platform;
  const Eigen::SelfAdjointEigenSolver<spatial::Matrix3> eigen(platform.inertia,
                                                              Eigen::EigenvaluesOnly);
  const auto I = eigen.eigenvalues();
  constraints.push_back({"the platform's mass is positive", not_negative(platform.mass)});
  constraints.push_back({"the platform's principal moments of inertia are positive",
                         I[0] > 0.0 ? 1.0 : above(I[0], I[2])});
  constraints.push_back(
      {fmt::format("no principal moment of inertia of the platform exceeds the sum "
                   "of the other two ({:.4g}, {:.4g}, {:.4g} kg m²)",
                   I[0], I[1], I[2]),
       above(I[0] + I[1], I[2])});
}

void check_leg(const Leg& leg, const std::string& name, const std::vector<double>& lengths,
               std::vector<Constraint>& constraints) {
  const auto& tube = leg.cylinder_case;
  const auto& rod = leg.rod;
  const auto add = [&](const std::string& what, double margin) {
    constraints.push_back({name + ": " + what, margin});
  };
  const auto sign = [&](const std::string& what, double value) {
    add(fmt::format("{} is not negative", what), not_negative(value));
  };
  sign("the mass of the case", tube.mass);
  sign("the mass of the rod", rod.mass);
  sign("the added axial inertia", leg.added_axial_inertia);
  sign("the transverse inertia of the case", tube.transverse_inertia);
  sign("the transverse inertia of the rod", rod.transverse_inertia);
  sign("the axial inertia of the case", tube.axial_inertia);
  sign("the axial inertia of the rod", rod.axial_inertia);
  add("the axial inertia of the case is at most twice its transverse inertia",
      above(2.0 * tube.transverse_inertia, tube.axial_inertia));
  add("the axial inertia of the rod is at most twice its transverse inertia",
      above(2.0 * rod.transverse_inertia, rod.axial_inertia));
  sign("the stiffness of the guide sleeve", leg.guide_sleeve.stiffness);
  if (leg.piston_ring) sign("the stiffness of the piston ring", leg.piston_ring->stiffness);
  if (leg.oil_spring.stiffness) sign("the stiffness of the oil", *leg.oil_spring.stiffness);
  sign("the case's mass centre from the base joint", tube.mass_center);
  add("the case's mass centre lies before the guide sleeve",
      above(leg.guide_sleeve.position, tube.mass_center));
  sign("the rod's mass centre from the piston", rod.mass_center);
  add("the rod's mass centre lies before the platform joint", above(rod.length, rod.mass_center));
  double piston = 1e300, guided = 1e300, free = 1e300;
  for (const double l : lengths) {
    const double l_m = l - rod.length;
    piston = std::min(piston, l_m / l);
    guided = std::min(guided, (leg.guide_sleeve.position - l_m) / l);
    free = std::min(free, (l - leg.guide_sleeve.position) / l);
  }
  add("the piston lies beyond the base joint at every pose", piston);
  add("the guide sleeve lies beyond the piston at every pose", guided);
  add("the guide sleeve lies before the platform joint at every pose", free);
}

}  // namespace

std::vector<Constraint> admissibility(const model::Machine& machine) {
  std::vector<Constraint> constraints;
  check_platform(machine, constraints);
  std::vector<std::vector<double>> lengths(model::leg_count);
  for (const auto& pose : machine.poses) {
    const auto l = kinematics::leg_lengths(machine, pose.X_BP);
    for (std::size_t i = 0; i < model::leg_count; ++i)
      lengths[i].push_back(l[static_cast<Eigen::Index>(i)]);
  }
  for (std::size_t i = 0; i < model::leg_count; ++i)
    check_leg(machine.legs[i], fmt::format("leg {}", i + 1), lengths[i], constraints);
  return constraints;
}

std::vector<std::string> violations(const model::Machine& machine) {
  std::map<std::string, std::vector<std::string>> legs_of;  // statement without the leg
  std::vector<std::string> order;
  for (const auto& [statement, margin] : admissibility(machine)) {
    if (margin >= 0.0) continue;
    const bool of_leg = statement.starts_with("leg ");
    const auto split = of_leg ? statement.find(": ") : 0;
    const std::string what = of_leg ? statement.substr(split + 2) : statement;
    if (!legs_of.contains(what)) order.push_back(what);
    legs_of[what].push_back(of_leg ? statement.substr(0, split) : "");
  }
  std::vector<std::string> list;
  for (const auto& what : order) {
    const auto& legs = legs_of[what];
    if (legs.front().empty()) {
      list.push_back(what);
    } else if (legs.size() == model::leg_count) {
      list.push_back("all legs: " + what);
    } else {
      list.push_back(fmt::format("{}: {}", fmt::join(legs, ", "), what));
    }
  }
  return list;
}

}  // namespace hydrapod::calibration
