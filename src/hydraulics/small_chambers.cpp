#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "hydrapod/hydraulics/servo_axis.hpp"

namespace hydrapod::hydraulics {

SmallChambers small_chambers(const ServoAxis& axis, const model::Supply& supply,
                             const HydraulicRest& rest, double s) {
  const auto volume = axis.volumes(s);
  const auto slopes = valve_flow_slopes(
      axis.valve, rest.spool, {supply.pressure, supply.return_pressure, rest.p_cap, rest.p_rod});
  SmallChambers chambers;
  chambers.capacity << volume.cap * compressibility(axis.oil, rest.p_cap) +
                           axis.cap_line_compliance,
      volume.rod * compressibility(axis.oil, rest.p_rod) + axis.rod_line_compliance;
  const double past = axis.internal_leakage, out = axis.external_leakage;
  chambers.conductance << past + out - slopes.cap_p, -past, -past, past + out - slopes.rod_p;
  chambers.area << axis.area.piston, -axis.area.annulus;
  return chambers;
}

RelaxingSpring relaxing_spring(const SmallChambers& chambers, double compliance) {
  Eigen::Matrix2d C = chambers.capacity.asDiagonal();
  C += compliance * chambers.area * chambers.area.transpose();
  // In pressures scaled to the same size: capacities differ by little, but are 1e-13 m³/Pa.
  const Eigen::Vector2d scale = C.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::Matrix2d unit = scale.asDiagonal() * C * scale.asDiagonal();
  const Eigen::Matrix2d flow = scale.asDiagonal() * chambers.conductance * scale.asDiagonal();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> solver(flow, unit);
  const Eigen::Vector2d a = solver.eigenvectors().transpose() * scale.asDiagonal() * chambers.area;
  RelaxingSpring spring;
  for (Eigen::Index j = 0; j < 2; ++j) {
    spring.stiffness[static_cast<std::size_t>(j)] = a[j] * a[j];
    spring.rate[static_cast<std::size_t>(j)] = std::max(solver.eigenvalues()[j], 0.0);
  }
  return spring;
}

}  // namespace hydrapod::hydraulics
