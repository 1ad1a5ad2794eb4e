#include <limits>

#include "legs_in_motion.hpp"
#include "statics_search.hpp"

namespace hydrapod::dynamics {

void add_beams(const model::Machine& machine, ModelKind kind, const spatial::Pose& X_reference,
               const kinematics::LegGeometries& geometry, LegConstants& to) {
  to.bends = kind != ModelKind::rigid && model::has_elastic_legs(machine);
  if (!to.bends) return;
  const auto rest = static_equilibrium(machine, X_reference, kind);
  std::array<BowMass, model::leg_count> mass;
  std::array<Eigen::Matrix2d, model::leg_count> slope;
  std::array<Vector2, model::leg_count> at_rest;
  for (std::size_t i = 0; i < model::leg_count; ++i) {
    const auto& leg = machine.legs[i];
    constexpr double rigid = std::numeric_limits<double>::infinity();
    to.beams[i] = leg_beams(leg).value_or(
        LegBeams{.EI_rod = rigid, .EI_case = rigid, .l_mn = leg.rod.length});
    const LegState state = rest.status == StaticsStatus::converged ? rest.legs[i] : LegState{};
    to.compression[i] = -state.oil_force;
    const auto element =
        bent_leg_without_bow_mass(leg, geometry[i].a, machine.flexible_axes, machine.gravity, state)
            .element;
    mass[i] = to.beams[i].bow_mass(element.l_m, to.compression[i], element.k_s + element.k_contact);
    slope[i] = InSeries(element).F_d;
    at_rest[i] = element.bending_force -
                 slope[i] * (element.sleeve_offset + element.bending * element.bending_force);
  }
  const auto each = [&](auto value) {
    return gather([&](int i) { return value(static_cast<std::size_t>(i)); });
  };
  for (int k = 0; k < 2; ++k) {
    to.bow_rest[k] = each([&](std::size_t i) { return at_rest[i][k]; });
    for (int j = 0; j < 2; ++j) to.bow_slope(k, j) = each([&](auto i) { return slope[i](k, j); });
  }
  to.bow_piston = each([&](std::size_t i) { return mass[i].piston; });
  to.bow_tilt = each([&](std::size_t i) { return mass[i].tilt; });
  to.bow_case = each([&](std::size_t i) { return mass[i].around; });
  to.bow_self = each([&](std::size_t i) { return mass[i].self; });
  to.bow_moment = each([&](std::size_t i) { return mass[i].moment; });
}

}  // namespace hydrapod::dynamics
