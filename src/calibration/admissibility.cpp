#include "admissibility.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

#include "hydrapod/kinematics/legs.hpp"

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

/// Gathers margins and, where somebody will read them, statements.
class Collector {
 public:
  explicit Collector(bool statements) : statements_(statements) {}

  void add(std::string_view what, double margin) {
    constraints_.push_back({statements_ ? std::string{what} : std::string{}, leg_, margin});
  }
  void sign(std::string_view what, double value) {
    add(statements_ ? fmt::format("{} is not negative", what) : "", not_negative(value));
  }
  void of_leg(std::size_t leg) { leg_ = static_cast<int>(leg); }
  [[nodiscard]] bool statements() const { return statements_; }
  std::vector<Constraint> take() { return std::move(constraints_); }

 private:
  bool statements_;
  std::optional<int> leg_{};
  std::vector<Constraint> constraints_{};
};

void check_platform(const Machine& machine, Collector& collector) {
  const auto& platform = machine.platform;
  Eigen::SelfAdjointEigenSolver<spatial::Matrix3> eigen;
  eigen.computeDirect(platform.inertia, Eigen::EigenvaluesOnly);
  const auto I = eigen.eigenvalues();
  collector.add("the platform's mass is positive", not_negative(platform.mass));
  collector.add("the platform's principal moments of inertia are positive",
                I[0] > 0.0 ? 1.0 : above(I[0], I[2]));
  collector.add(collector.statements()
                    ? fmt::format("no principal moment of inertia of the platform exceeds the sum "
                                  "of the other two ({:.4g}, {:.4g}, {:.4g} kg m²)",
                                  I[0], I[1], I[2])
                    : "",
                above(I[0] + I[1], I[2]));
}

/// Where piston and sleeve stand at the poses, as shares of the leg's length.
void check_places(const Leg& leg, const std::vector<double>& lengths, Collector& collector) {
  double piston = 1e300, guided = 1e300, free = 1e300;
  for (const double l : lengths) {
    const double l_m = l - leg.rod.length;
    piston = std::min(piston, l_m / l);
    guided = std::min(guided, (leg.guide_sleeve.position - l_m) / l);
    free = std::min(free, (l - leg.guide_sleeve.position) / l);
  }
  collector.add("the piston lies beyond the base joint at every pose", piston);
  collector.add("the guide sleeve lies beyond the piston at every pose", guided);
  collector.add("the guide sleeve lies before the platform joint at every pose", free);
}

void check_leg(const Leg& leg, const std::vector<double>& lengths, Collector& collector) {
  if (leg.strut) return collector.sign("the stiffness of the strut", leg.strut->stiffness);
  const auto& tube = leg.cylinder_case;
  const auto& rod = leg.rod;
  collector.sign("the mass of the case", tube.mass);
  collector.sign("the mass of the rod", rod.mass);
  collector.sign("the added axial inertia", leg.added_axial_inertia);
  collector.sign("the transverse inertia of the case", tube.transverse_inertia);
  collector.sign("the transverse inertia of the rod", rod.transverse_inertia);
  collector.sign("the axial inertia of the case", tube.axial_inertia);
  collector.sign("the axial inertia of the rod", rod.axial_inertia);
  collector.add("the axial inertia of the case is at most twice its transverse inertia",
                above(2.0 * tube.transverse_inertia, tube.axial_inertia));
  collector.add("the axial inertia of the rod is at most twice its transverse inertia",
                above(2.0 * rod.transverse_inertia, rod.axial_inertia));
  collector.sign("the stiffness of the guide sleeve", leg.guide_sleeve.stiffness);
  if (leg.piston_ring)
    collector.sign("the stiffness of the piston ring", leg.piston_ring->stiffness);
  if (leg.oil_spring.stiffness)
    collector.sign("the stiffness of the oil", *leg.oil_spring.stiffness);
  if (leg.screw) collector.sign("the stiffness of the screw", leg.screw->stiffness);
  collector.sign("the distance of the case's mass centre from the base joint", tube.mass_center);
  collector.add("the case's mass centre lies before the guide sleeve",
                above(leg.guide_sleeve.position, tube.mass_center));
  collector.sign("the distance of the rod's mass centre from the piston", rod.mass_center);
  collector.add("the rod's mass centre lies before the platform joint",
                above(rod.length, rod.mass_center));
  check_places(leg, lengths, collector);
}

std::vector<Constraint> collect(const Machine& machine, bool statements) {
  Collector collector(statements);
  check_platform(machine, collector);
  std::array<std::vector<double>, model::leg_count> lengths;
  for (const auto& pose : machine.poses) {
    const auto l = kinematics::leg_lengths(machine, pose.X_BP);
    for (std::size_t i = 0; i < model::leg_count; ++i)
      lengths[i].push_back(l[static_cast<Eigen::Index>(i)]);
  }
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    collector.of_leg(i);
    check_leg(machine.legs[i], lengths[i], collector);
  }
  return collector.take();
}

}  // namespace

std::vector<Constraint> admissibility(const Machine& machine) { return collect(machine, true); }

std::vector<double> admissibility_margins(const Machine& machine) {
  std::vector<double> margins;
  for (const auto& constraint : collect(machine, false)) margins.push_back(constraint.margin);
  return margins;
}

std::vector<std::string> violations(const model::Machine& machine) {
  std::map<std::string, std::vector<std::string>> legs_of;
  std::vector<std::string> order;
  for (const auto& [what, leg, margin] : admissibility(machine)) {
    if (margin >= 0.0) continue;
    if (!legs_of.contains(what)) order.push_back(what);
    auto& legs = legs_of[what];
    if (leg) legs.push_back(fmt::format("leg {}", *leg + 1));
  }
  std::vector<std::string> list;
  for (const auto& what : order) {
    const auto& legs = legs_of[what];
    list.push_back(legs.empty() ? what
                   : legs.size() == model::leg_count
                       ? "all legs: " + what
                       : fmt::format("{}: {}", fmt::join(legs, ", "), what));
  }
  return list;
}

}  // namespace hydrapod::calibration
