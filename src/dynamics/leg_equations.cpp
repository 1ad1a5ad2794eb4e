#include "leg_equations.hpp"

#include <Eigen/LU>
#include <cmath>

namespace hydrapod::dynamics {

namespace {

/// ∂g and ∂e by the chart, 3 × (3 + n), and the same of both spins.
template <int n>
struct Partials {
  using Matrix = Eigen::Matrix<double, 3, 3 + n>;
  Matrix g, e;
  Eigen::Matrix<double, 3 + n, 1> rod_spin;

  Partials(const LegMotion& at, double c_g) {
    const Vector3 a1(at.cosine, 0.0, at.sine);
    g.col(0) = a1.cross(at.g);
    g.col(1) << at.g.z(), 0.0, -at.g.x();
    g.col(2) << 0.0, 0.0, 1.0;
    e.col(0) = a1.cross(at.e);
    e.col(1) << at.e.z(), 0.0, -at.e.x();
    e.col(2).setZero();
    if constexpr (n >= 2) {
      g.col(3) = c_g * at.e_1;
      g.col(4) = c_g * at.e_2;
      e.col(3) = at.e_1;
      e.col(4) = at.e_2;
    }
    if constexpr (n == 4) {
      g.template rightCols<2>() << 1.0, 0.0, 0.0, 1.0, 0.0, 0.0;
      e.template rightCols<2>().setZero();
    }
  }

  void add_spin(const LegMotion& at, const Vector3& row) {
    rod_spin.setZero();
    rod_spin[0] = at.cosine * at.e.x() + at.sine * at.e.z();
    rod_spin[1] = at.e.y();
    if constexpr (n >= 2) {
      rod_spin[3] = row.dot(at.e_1);
      rod_spin[4] = row.dot(at.e_2);
    }
  }
};

/// Chart rates (α̇, β̇, ṡ) per joint velocity in L: the inverse of [a1 × P, a2 × P, n].
Matrix3 inverse_joint_rates(const LegMotion& at) {
  const Vector3& P = at.P;
  const double per_k = 1.0 / (at.cosine * P.z() - at.sine * P.x());
  const double per_z = 1.0 / P.z();
  const double beta = -at.sine * P.y() * per_k * per_z;
  Matrix3 inverse;
  inverse << 0.0, -per_k, 0.0, per_z, beta, 0.0, P.x() * per_z,
      at.cosine * P.y() * per_k + P.x() * beta, 1.0;
  return inverse;
}

/// Joint velocity per rates of the flexible coordinates at constant (α, β, s).
template <int n>
Eigen::Matrix<double, 3, n> flexible_joint_rates(const LegMotion& at, double l_mn) {
  Eigen::Matrix<double, 3, n> F;
  F.col(0) = l_mn * at.e_1;
  F.col(1) = l_mn * at.e_2;
  if constexpr (n == 4) F.template rightCols<2>() << 1.0, 0.0, 0.0, 1.0, 0.0, 0.0;
  return F;
}

template <int n>
void mass(const LegMotion& at, const LegSurroundings& around, const Partials<n>& partials,
          LegEquations<n>& out) {
  const auto& tube = around.leg.cylinder_case;
  const auto& rod = around.leg.rod;
  Eigen::Matrix<double, 3 + n, 3 + n> M =
      rod.mass * partials.g.transpose() * partials.g +
      rod.transverse_inertia * partials.e.transpose() * partials.e;
  const double I_b = tube.transverse_inertia + tube.mass * tube.mass_center * tube.mass_center;
  M(0, 0) += I_b * at.cosine * at.cosine;
  M(1, 1) += I_b;
  M(2, 2) += around.leg.added_axial_inertia;
  if (around.spinning) {
    M(0, 0) += tube.axial_inertia * at.sine * at.sine;
    M += rod.axial_inertia * partials.rod_spin * partials.rod_spin.transpose();
  }
  out.A_inverse = inverse_joint_rates(at);
  out.M_cc = M.template topLeftCorner<3, 3>();
  if constexpr (n > 0) {
    const Eigen::Matrix<double, 3, n> G = out.A_inverse * flexible_joint_rates<n>(at, rod.length);
    const Eigen::Matrix<double, 3, n> M_cf = M.template topRightCorner<3, n>();
    out.X = M_cf - out.M_cc * G;
    out.M_ff = M.template bottomRightCorner<n, n>() - M_cf.transpose() * G - G.transpose() * out.X;
    out.M_ff_inverse = out.M_ff.inverse();
  }
}

/// Accelerations of the points of a leg for (α̈, β̈, s̈) = κ and constant flexible rates, in L.
struct PointAccelerations {
  Vector3 n, e, g;
  double s, case_spin, rod_spin;
};

/// Angular acceleration of the frame at α̈ = β̈ = 0: α̇ β̇ a1 × a2.
Vector3 frame_bias(const LegMotion& at) {
  return at.case_rate[0] * at.case_rate[1] * Vector3(-at.sine, 0.0, at.cosine);
}

/// Joint acceleration, in L, when the chart's rates stay constant.
Vector3 joint_bias_in_chart(const LegMotion& at, double l_mn) {
  const Vector3& w = at.omega;
  const Vector3 P_rate =
      Vector3(at.flexible_rate[2], at.flexible_rate[3], at.s_rate) + l_mn * at.e_bending;
  return frame_bias(at).cross(at.P) + w.cross(w.cross(at.P) + 2.0 * P_rate) + l_mn * at.e_curvature;
}

PointAccelerations point_accelerations(const LegMotion& at, const Vector3& kappa, double c_g) {
  const Vector3& w = at.omega;
  Vector3 dw = frame_bias(at);
  dw += Vector3(at.cosine * kappa[0], kappa[1], at.sine * kappa[0]);
  const Vector3 g_rate =
      Vector3(at.flexible_rate[2], at.flexible_rate[3], at.s_rate) + c_g * at.e_bending;
  PointAccelerations out;
  out.n = Vector3(dw.y(), -dw.x(), 0.0) + w.cross(Vector3(w.y(), -w.x(), 0.0));
  out.e = dw.cross(at.e) + w.cross(w.cross(at.e) + 2.0 * at.e_bending) + at.e_curvature;
  out.g = dw.cross(at.g) + w.cross(w.cross(at.g) + 2.0 * g_rate) + c_g * at.e_curvature;
  out.g.z() += kappa[2];
  out.s = kappa[2];
  out.case_spin = dw.z();
  out.rod_spin = dw.dot(at.e) + w.dot(at.e_bending);
  return out;
}

/// Forces that are dual to the motions of n, e, g and s: inertia less what acts.
struct PointForces {
  Vector3 n, e, g;
  double s, case_spin{}, rod_spin{};
};

/// Friction at both joints of the leg; returns the moment on the platform in L.
Vector3 add_joint_friction(const LegMotion& at, const LegSurroundings& around,
                           PointForces& forces) {
  const auto& friction = around.leg.hydraulics.joint_friction;
  if (friction.viscous == 0.0 && friction.coulomb == 0.0) return Vector3::Zero();
  const Vector3 n_rate(at.omega.y(), -at.omega.x(), 0.0);
  forces.n += joint_friction_slope(friction, n_rate.norm()) * n_rate;
  const Vector3 omega_L = at.R_BL.transpose() * around.omega;
  const Vector3 relative = omega_L - at.e * at.e.dot(omega_L) - at.e.cross(at.e_rate);
  const Vector3 moment = joint_friction_slope(friction, relative.norm()) * relative;
  forces.e -= moment.cross(at.e);
  return -moment;
}

PointForces point_forces(const LegMotion& at, const LegSurroundings& around,
                         const PointAccelerations& acceleration, const AxialSpin& spin) {
  const auto& tube = around.leg.cylinder_case;
  const auto& rod = around.leg.rod;
  const double I_b = tube.transverse_inertia + tube.mass * tube.mass_center * tube.mass_center;
  const Vector3 g_L = at.R_BL.transpose() * around.gravity;
  PointForces forces;
  forces.n = I_b * acceleration.n - tube.mass * tube.mass_center * g_L;
  forces.e = rod.transverse_inertia * acceleration.e;
  forces.g = rod.mass * (acceleration.g - g_L);
  forces.s = around.leg.added_axial_inertia * acceleration.s - around.axial_force;
  if (!around.spinning) return forces;
  const Vector3 n_rate(at.omega.y(), -at.omega.x(), 0.0);
  forces.n += tube.axial_inertia * spin.of_case * n_rate.cross(Vector3::UnitZ());
  forces.e += rod.axial_inertia * spin.of_rod * at.e_rate.cross(at.e);
  forces.case_spin = tube.axial_inertia * acceleration.case_spin;
  forces.rod_spin = rod.axial_inertia * (acceleration.rod_spin + spin.row_rate);
  return forces;
}

/// Forces of seals on the chart: springs and dampers. Dampers see what the case sees.
template <int n>
void add_seals(const LegMotion& at, const LegSurroundings& around,
               Eigen::Matrix<double, 3 + n, 1>& r) {
  const auto& leg = around.leg;
  const Vector2 sleeve_damper = leg.guide_sleeve.damping * at.sleeve_offset_rate;
  const Vector2 sleeve = leg.guide_sleeve.stiffness * at.sleeve_offset + sleeve_damper;
  const Vector3 on_slopes = at.sleeve_slopes.transpose() * sleeve;
  r.template segment<3>(2) += on_slopes;
  const auto cross = [](const Vector2& v, const Vector2& force) {
    return v.x() * force.y() - v.y() * force.x();
  };
  double about_n = cross(at.sleeve_offset, sleeve_damper);
  if constexpr (n == 4) {
    const Vector2 offset = at.flexible.tail<2>();
    const Vector2 ring_damper = leg.piston_ring->damping * at.ring_offset_rate;
    r.template tail<2>() += sleeve + leg.piston_ring->stiffness * offset + ring_damper;
    about_n += cross(offset, ring_damper);
  }
  if (!around.spinning) r[0] += at.sine * about_n;
}

template <int n>
Eigen::Matrix<double, 3 + n, 1> residual(const LegMotion& at, const LegSurroundings& around,
                                         const Partials<n>& partials, const PointForces& forces) {
  Eigen::Matrix<double, 3 + n, 1> r =
      partials.g.transpose() * forces.g + partials.e.transpose() * forces.e;
  r[0] -= at.cosine * forces.n.y();
  r[1] += forces.n.x();
  r[2] += forces.s;
  if (around.spinning) {
    r[0] += at.sine * forces.case_spin;
    r += forces.rod_spin * partials.rod_spin;
  }
  if constexpr (n > 0) add_seals<n>(at, around, r);
  return r;
}

}  // namespace

AxialSpin axial_spin(const LegMotion& at, const Vector3& piston_axis) {
  AxialSpin spin{.of_case = at.omega.z()};
  const Vector3 normal = at.e.cross(piston_axis);
  const double square = normal.squaredNorm();
  const double along = piston_axis.dot(at.e);
  spin.row = -along / square * normal;
  spin.of_rod = at.omega.dot(at.e) + spin.row.dot(at.e_bending);
  const Vector3 normal_rate = at.e_bending.cross(piston_axis);
  const Vector3 row_rate =
      (2.0 * along * normal.dot(normal_rate) / square - piston_axis.dot(at.e_bending)) / square *
          normal -
      along / square * normal_rate;
  spin.row_rate = row_rate.dot(at.e_bending) + spin.row.dot(at.e_curvature);
  return spin;
}

double joint_friction_slope(const model::JointFriction& friction, double rate) {
  if (friction.coulomb == 0.0) return friction.viscous;
  const double ratio = rate / friction.smoothing_rate;
  const double per_ratio = ratio > 1e-4 ? std::tanh(ratio) / ratio : 1.0 - ratio * ratio / 3.0;
  return friction.viscous + friction.coulomb / friction.smoothing_rate * per_ratio;
}

template <int n>
void leg_mass(const LegMotion& at, const LegSurroundings& around, LegEquations<n>& equations) {
  Partials<n> partials(at, around.leg.rod.mass_center);
  if (around.spinning) partials.add_spin(at, axial_spin(at, around.piston_axis).row);
  mass<n>(at, around, partials, equations);
}

template <int n>
void leg_equations(const LegMotion& at, const LegSurroundings& around, LegEquations<n>& equations) {
  const auto& rod = around.leg.rod;
  Partials<n> partials(at, rod.mass_center);
  AxialSpin spin;
  if (around.spinning) {
    spin = axial_spin(at, around.piston_axis);
    partials.add_spin(at, spin.row);
  }
  mass<n>(at, around, partials, equations);

  const Vector3 kappa = equations.A_inverse * (at.R_BL.transpose() * around.joint_bias -
                                               joint_bias_in_chart(at, rod.length));
  const auto accelerations = point_accelerations(at, kappa, rod.mass_center);
  PointForces forces = point_forces(at, around, accelerations, spin);
  equations.joint_moment = at.R_BL * add_joint_friction(at, around, forces);
  const Eigen::Matrix<double, 3 + n, 1> r = residual<n>(at, around, partials, forces);
  equations.r_c = r.template head<3>();
  if constexpr (n > 0) {
    const Eigen::Matrix<double, 3, n> F = flexible_joint_rates<n>(at, rod.length);
    equations.r_f =
        r.template tail<n>() - F.transpose() * (equations.A_inverse.transpose() * equations.r_c);
  }
}

template void leg_mass<0>(const LegMotion&, const LegSurroundings&, LegEquations<0>&);
template void leg_mass<2>(const LegMotion&, const LegSurroundings&, LegEquations<2>&);
template void leg_mass<4>(const LegMotion&, const LegSurroundings&, LegEquations<4>&);
template void leg_equations<0>(const LegMotion&, const LegSurroundings&, LegEquations<0>&);
template void leg_equations<2>(const LegMotion&, const LegSurroundings&, LegEquations<2>&);
template void leg_equations<4>(const LegMotion&, const LegSurroundings&, LegEquations<4>&);

}  // namespace hydrapod::dynamics
