/// Electric cylinders with free motors, for small motions: docs/theory/actuators.md.

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <stdexcept>

#include "hydrapod/dynamics/linear_model.hpp"
#include "hydrapod/hydraulics/servo_axis.hpp"
#include "hydrapod/kinematics/legs.hpp"
#include "hydrapod/simulation/linear_system.hpp"
#include "hydrapod/spatial/pose.hpp"
#include "origin_from_center.hpp"

namespace hydrapod::simulation {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using model::leg_count;

/// M, K, C of y and, behind it, the ways of the nuts.
struct WithNuts {
  MatrixXd M, K, C;
};

/// With the nuts held, leg i stores ½ k (s_y·y)²; with a nut at s_n it is ½ k (s_y·y − s_n)².
WithNuts with_nuts(const model::Machine& machine, const dynamics::LinearModel& model) {
  const int n = model.dof(), all = n + leg_count;
  WithNuts system{MatrixXd::Zero(all, all), MatrixXd::Zero(all, all), MatrixXd::Zero(all, all)};
  system.M.topLeftCorner(n, n) = model.M;
  system.K.topLeftCorner(n, n) = model.K;
  system.C.topLeftCorner(n, n) = model.C;
  for (int i = 0; i < leg_count; ++i) {
    const auto& leg = machine.legs[static_cast<std::size_t>(i)];
    const auto& element = model.legs[static_cast<std::size_t>(i)];
    const auto& screw = leg.screw.value();
    const VectorXd s_y = dynamics::per_coordinate(model, i, element.s_x);
    const double k = element.k_h;
    const double c =
        hydraulics::axial_spring(leg, element.l_m).damping + machine.damping.rayleigh_stiffness * k;
    const int at = n + i;
    system.M(at, at) = screw.reflected_mass();
    system.K(at, at) = k;
    system.C(at, at) = c + screw.viscous_friction * screw.ratio() * screw.ratio() +
                       machine.damping.rayleigh_mass * screw.reflected_mass();
    system.K.col(at).head(n) = -k * s_y;
    system.C.col(at).head(n) = -c * s_y;
    system.K.row(at).head(n) = system.K.col(at).head(n).transpose();
    system.C.row(at).head(n) = system.C.col(at).head(n).transpose();
  }
  return system;
}

/// What each of the `n` coordinates of `model` is of.
std::vector<StatePart> parts_of(const dynamics::LinearModel& model) {
  std::vector<StatePart> parts;
  for (int d = 0; d < 6; ++d) parts.push_back({static_cast<Part>(d), -1});
  const int per_leg = dynamics::flexible_per_leg(model.kind);
  for (int k = 0; k < leg_count * per_leg; ++k) parts.push_back({Part::seal, k / per_leg});
  for (int k = 0; k < model.base_count(); ++k) parts.push_back({Part::base, -1});
  for (int k = 0; k < model.payload_count(); ++k) parts.push_back({Part::payload, -1});
  for (int i = 0; i < leg_count; ++i) parts.push_back({Part::motor, i});
  return parts;
}

}  // namespace

LinearSystem screw_system(const model::Machine& machine, const spatial::Pose& X_BP,
                          dynamics::ModelKind kind) {
  if (model::leg_type(machine) != model::LegType::screw)
    throw std::invalid_argument("screw_system: the legs are no electric cylinders");
  const auto model = dynamics::linear_model(machine, X_BP, kind);
  const auto nuts = with_nuts(machine, model);
  const auto n = model.dof();
  const Eigen::Index all = n + leg_count;
  const auto size = 2 * all + static_cast<Eigen::Index>(model.arms.size());
  const Eigen::LLT<MatrixXd> mass(nuts.M);
  MatrixXd torque = MatrixXd::Zero(all, leg_count), wrench = MatrixXd::Zero(all, 6);
  for (int i = 0; i < leg_count; ++i)
    torque(n + i, i) = machine.legs[static_cast<std::size_t>(i)].screw->ratio();
  wrench.topRows<6>().setIdentity();

  LinearSystem system;
  system.A = MatrixXd::Zero(size, size);
  system.A.block(0, all, all, all).setIdentity();
  system.A.block(all, 0, all, all) = -mass.solve(nuts.K);
  system.A.block(all, all, all, all) = -mass.solve(nuts.C);
  system.B_valve = system.B_wrench = MatrixXd::Zero(size, 6);
  system.B_valve.middleRows(all, all) = mass.solve(torque);
  system.B_wrench.middleRows(all, all) = mass.solve(wrench);
  system.B_command = system.B_velocity = MatrixXd::Zero(size, 6);
  system.C_ground = MatrixXd::Zero(6, size);
  const auto T = origin_from_center(machine, X_BP);
  system.C_ground.leftCols<6>() = T;
  system.C = MatrixXd::Zero(6, size);
  system.C.leftCols(n) = T * model.against_base;
  auto names = dynamics::coordinate_names(kind, model.base_directions, model.payload_names);
  for (int i = 1; i <= leg_count; ++i) names.push_back(fmt::format("leg{}.nut", i));
  const auto parts = parts_of(model);
  system.states = names;
  system.parts = parts;
  for (std::size_t k = 0; k < names.size(); ++k) {
    system.states.push_back(names[k] + "_rate");
    system.parts.push_back(parts[k]);
  }
  system.scales = VectorXd::Ones(size);
  system.scales.segment(all, all) *= 10.0;  // [1/s]
  // η̇ = λ (s_y·y − η) and the force κ s_y η on y
  for (std::size_t k = 0; k < model.arms.size(); ++k) {
    const auto& arm = model.arms[k];
    const auto at = 2 * all + static_cast<Eigen::Index>(k);
    VectorXd pull = VectorXd::Zero(all);
    pull.head(n) = arm.s_y;
    system.A.block(all, at, all, 1) = arm.stiffness * mass.solve(pull);
    system.A.block(at, 0, 1, all) = arm.rate * pull.transpose();
    system.A(at, at) = -arm.rate;
    system.states.push_back(fmt::format("leg{}.{}{}", arm.leg + 1,
                                        arm.what == dynamics::Relaxing::ring ? "ring" : "sleeve",
                                        k + 1));
    system.parts.push_back({Part::seal, arm.leg});
  }
  return system;
}

}  // namespace hydrapod::simulation
