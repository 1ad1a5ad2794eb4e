#include "support/mujoco_equilibrium.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "hydrapod/hydraulics/servo_axis.hpp"

namespace hydrapod::test {

namespace {

constexpr int constraint_rows = 3 * model::leg_count;

/// Piston from the base joint along the case [m].
double piston_position(const MujocoHexapod& hexapod, int i) {
  return hexapod.case_axes(i).col(2).dot(hexapod.piston(i) - hexapod.machine().legs[i].base_joint);
}

void add_guide_sleeve(const MujocoHexapod& hexapod, int i, VectorXd& force) {
  const auto& leg = hexapod.machine().legs[i];
  const Vector3 n = hexapod.case_axes(i).col(2), e = hexapod.rod_direction(i);
  const Vector3 center = leg.base_joint + leg.guide_sleeve.position * n;
  const double along_rod = n.dot(center - hexapod.piston(i)) / n.dot(e);
  const Vector3 point = hexapod.piston(i) + along_rod * e;  // where the rod pierces the sleeve
  const Vector3 offset = point - center;
  double stiffness = leg.guide_sleeve.stiffness;
  // a ring with a sharp edge
  if (const auto gap = leg.guide_sleeve.gap; gap && offset.norm() > *gap)
    stiffness += leg.guide_sleeve.guide_stiffness * (1.0 - *gap / offset.norm());
  const Vector3 across = -stiffness * offset;
  hexapod.add_pair(i, across - n * across.dot(e) / n.dot(e), point, force);
}

}  // namespace

VectorXd applied_force(const MujocoHexapod& hexapod, const Vector6& oil_force) {
  VectorXd force = hexapod.gravity_force();
  for (int i = 0; i < model::leg_count; ++i) {
    hexapod.add_pair(i, -oil_force[i] * hexapod.case_axes(i).col(2), hexapod.piston(i), force);
    if (hexapod.kind() == ModelKind::rigid) continue;
    add_guide_sleeve(hexapod, i, force);
    if (hexapod.kind() == ModelKind::full)
      hexapod.add_pair(i,
                       -hexapod.machine().legs[i].piston_ring->stiffness * hexapod.piston_offset(i),
                       hexapod.piston(i), force);
  }
  return force;
}

namespace {

double weight(const model::Machine& machine) {
  double mass = machine.platform.mass;
  for (const auto& leg : machine.legs) mass += leg.cylinder_case.mass + leg.rod.mass;
  return mass * machine.gravity.norm();
}

/// Unknowns: displacement of the legs' coordinates (nv − 6), oil forces, constraint forces.
class Equilibrium {
 public:
  explicit Equilibrium(MujocoHexapod& hexapod) : hexapod_(hexapod), start_(hexapod.qpos()) {
    x_.setZero(legs() + model::leg_count + constraint_rows);
  }

  [[nodiscard]] Vector6 oil_force() const { return x_.segment<6>(legs()); }

  /// Constraint errors, then unbalanced forces.
  VectorXd residual(const VectorXd& x) {
    VectorXd displacement = VectorXd::Zero(hexapod_.nv());
    displacement.tail(legs()) = x.head(legs());
    hexapod_.move(start_, displacement);
    VectorXd r(constraint_rows + hexapod_.nv());
    r.head<constraint_rows>() = hexapod_.constraint_error();
    r.tail(hexapod_.nv()) = applied_force(hexapod_, x.segment<6>(legs())) +
                            hexapod_.constraint_jacobian().transpose() * x.tail<constraint_rows>();
    return r;
  }

  /// Newton; the derivative is by differences, which only affects how fast it gets there.
  void solve(int& iterations, double& unbalanced) {
    constexpr int most_iterations = 40;
    const double scale = weight(hexapod_.machine());
    unbalanced = INFINITY;
    for (iterations = 0; iterations < most_iterations; ++iterations) {
      const VectorXd r = residual(x_);
      const double now = r.tail(hexapod_.nv()).lpNorm<Eigen::Infinity>() / scale;
      const bool closed = r.head<constraint_rows>().lpNorm<Eigen::Infinity>() < 1e-12;
      const bool stalled = closed && now < 1e-10 && now >= 0.5 * unbalanced;
      unbalanced = now;
      if (stalled) return;
      const VectorXd step = derivative().partialPivLu().solve(r);
      constexpr double largest = 0.2;  // [rad] and [m]: a leg must not turn over
      x_ -= std::min(1.0, largest / step.head(legs()).lpNorm<Eigen::Infinity>()) * step;
    }
    residual(x_);
  }

 private:
  [[nodiscard]] int legs() const { return hexapod_.nv() - 6; }

  MatrixXd derivative() {
    MatrixXd D(x_.size(), x_.size());
    for (int k = 0; k < x_.size(); ++k) {
      const double h = k < legs() ? 1e-6 : 1.0;  // the residual is linear in the forces
      VectorXd high = x_, low = x_;
      high[k] += h;
      low[k] -= h;
      D.col(k) = (residual(high) - residual(low)) / (2.0 * h);
    }
    return D;
  }

  MujocoHexapod& hexapod_;
  VectorXd start_, x_;
};

MujocoEquilibrium equilibrium_with(const model::Machine& machine, const spatial::Pose& X_BP,
                                   ModelKind kind, const PistonAxes* axes) {
  MujocoEquilibrium result{.hexapod = MujocoHexapod(machine, X_BP, kind, axes)};
  Equilibrium equilibrium(result.hexapod);
  equilibrium.solve(result.iterations, result.residual);
  result.oil_force = equilibrium.oil_force();
  return result;
}

/// The mechanism near its equilibrium, by the coordinates of MujocoHexapod::allowed_motions.
class Neighbourhood {
 public:
  explicit Neighbourhood(MujocoEquilibrium& equilibrium)
      : hexapod_(equilibrium.hexapod),
        at_rest_(hexapod_.qpos()),
        motions_(hexapod_.allowed_motions()),
        oil_force_(equilibrium.oil_force) {
    for (int i = 0; i < model::leg_count; ++i) {
      rest_position_[i] = piston_position(hexapod_, i);
      oil_stiffness_[i] = hydraulics::oil_stiffness(hexapod_.machine().legs[i], rest_position_[i]);
    }
  }

  /// Generalised force per allowed motion, oil springs included, after a displacement `y`.
  VectorXd force(const VectorXd& y) {
    place(y);
    Vector6 oil_force = oil_force_;
    for (int i = 0; i < model::leg_count; ++i)
      oil_force[i] += oil_stiffness_[i] * (piston_position(hexapod_, i) - rest_position_[i]);
    return hexapod_.allowed_motions().transpose() * applied_force(hexapod_, oil_force);
  }

  void rest() { hexapod_.move(at_rest_, VectorXd::Zero(hexapod_.nv())); }

 private:
  /// Platform and flexible coordinates as told; base angles and extensions close the constraints.
  void place(const VectorXd& y) {
    constexpr int newton_steps = 4;  // from an error of y²: 1e-6, 1e-12, rounding
    VectorXd displacement = motions_ * y;
    for (int step = 0; step < newton_steps; ++step) {
      hexapod_.move(at_rest_, displacement);
      const MatrixXd J = hexapod_.constraint_jacobian();
      const VectorXd error = hexapod_.constraint_error();
      for (int i = 0; i < model::leg_count; ++i) {
        const int theta = hexapod_.theta_of(i);
        displacement.segment<3>(theta) -=
            J.block<3, 3>(3 * i, theta).partialPivLu().solve(Vector3(error.segment<3>(3 * i)));
      }
    }
    hexapod_.move(at_rest_, displacement);
  }

  MujocoHexapod& hexapod_;
  VectorXd at_rest_;
  MatrixXd motions_;
  Vector6 oil_force_, rest_position_, oil_stiffness_;
};

}  // namespace

MujocoEquilibrium mujoco_equilibrium(const model::Machine& machine, const spatial::Pose& X_BP,
                                     ModelKind kind) {
  auto found = equilibrium_with(machine, X_BP, kind, nullptr);
  if (machine.flexible_axes == model::FlexibleAxes::transverse || kind == ModelKind::rigid)
    return found;
  PistonAxes axes;
  for (int i = 0; i < model::leg_count; ++i)
    axes[i] = found.hexapod.case_axes(i).transpose() * machine.legs[i].gimbal_axis;
  return equilibrium_with(machine, X_BP, kind, &axes);
}

MatrixXd stiffness_at(MujocoEquilibrium& equilibrium, double h) {
  Neighbourhood near(equilibrium);
  const int dof = equilibrium.hexapod.dof();
  MatrixXd K(dof, dof);
  for (int k = 0; k < dof; ++k) {
    const auto force = [&](double step) { return near.force(step * VectorXd::Unit(dof, k)); };
    K.col(k) = (force(2.0 * h) - force(-2.0 * h) - 8.0 * (force(h) - force(-h))) / (12.0 * h);
  }
  near.rest();
  return K;
}

MatrixXd mass_at(const MujocoEquilibrium& equilibrium) {
  const MatrixXd N = equilibrium.hexapod.allowed_motions();
  return N.transpose() * equilibrium.hexapod.mass() * N;
}

MatrixXd damping_at(const MujocoEquilibrium& equilibrium) {
  const MatrixXd N = equilibrium.hexapod.allowed_motions();
  return N.transpose() * equilibrium.hexapod.damping() * N;
}

}  // namespace hydrapod::test
