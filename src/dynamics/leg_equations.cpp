#include "leg_equations.hpp"

#include <Eigen/LU>
#include <cmath>

#include "guide_contact.hpp"

namespace hydrapod::dynamics {

namespace {

const Lanes zero(0.0), one(1.0), two(2.0);

/// ∂g and ∂e by the chart, 3 × (3 + n), and that of the rod's spin.
template <int n>
struct Partials {
  using Matrix = Eigen::Matrix<Lanes, 3, 3 + n>;
  Matrix g, e;
  Matrix bow, bow_momentum;  ///< of b and of what it is dual to; where legs bend
  Eigen::Matrix<Lanes, 3 + n, 1> rod_spin;

  Partials(const LegsInMotion& at, const LegConstants& legs) {
    const Lanes& c_g = legs.c_g;
    const Vector3L a1(at.cosine, zero, at.sine);
    g.col(0) = a1.cross(at.g);
    g.col(1) = Vector3L(at.g[2], zero, -at.g[0]);
    g.col(2) = Vector3L(zero, zero, one);
    e.col(0) = a1.cross(at.e);
    e.col(1) = Vector3L(at.e[2], zero, -at.e[0]);
    e.col(2) = Vector3L(zero, zero, zero);
    if constexpr (n >= 2) {
      g.col(3) = c_g * at.e_1;
      g.col(4) = c_g * at.e_2;
      e.col(3) = at.e_1;
      e.col(4) = at.e_2;
    }
    if constexpr (n == 4) {
      g.col(5) = Vector3L(one, zero, zero);
      g.col(6) = Vector3L(zero, one, zero);
      e.col(5) = e.col(6) = Vector3L(zero, zero, zero);
    }
    if constexpr (n >= 2)
      if (legs.bends) add_bow(at, legs);
  }

  /// ∂b, and what multiplies ḃ in the kinetic energy per chart rate but for ½ bow_self |ḃ|².
  void add_bow(const LegsInMotion& at, const LegConstants& legs) {
    const auto lateral = [](const Vector2L& v) { return Vector3L(v[0], v[1], zero); };
    const Vector3L a1(at.cosine, zero, at.sine), piston(at.flexible[2], at.flexible[3], at.s);
    bow.col(0) = a1.cross(at.bow);
    bow.col(1) = Vector3L(zero, zero, -at.bow[0]);
    for (int k = 0; k < 3; ++k) bow.col(2 + k) = lateral(legs.bow_slope * at.sleeve_slopes.col(k));
    if constexpr (n == 4)
      for (int k = 0; k < 2; ++k) bow.col(5 + k) = lateral(legs.bow_slope.col(k));
    bow_momentum = -legs.bow_tilt * e;
    bow_momentum.col(0) -= legs.bow_piston * a1.cross(piston);
    bow_momentum.col(0)[1] -= legs.bow_case * at.cosine;  // ∂n/∂α = a1 × n
    bow_momentum.col(1) -= legs.bow_piston * Vector3L(piston[2], zero, -piston[0]);
    bow_momentum.col(1)[0] += legs.bow_case;
    bow_momentum.col(2)[2] -= legs.bow_piston;
    if constexpr (n == 4)
      for (int k = 0; k < 2; ++k) bow_momentum.col(5 + k)[k] -= legs.bow_piston;
  }

  /// r += (∂p)ᵀ force, p: the piston.
  void add_piston(const LegsInMotion& at, const Vector3L& force,
                  Eigen::Matrix<Lanes, 3 + n, 1>& r) const {
    const Vector3L a1(at.cosine, zero, at.sine), piston(at.flexible[2], at.flexible[3], at.s);
    r[0] += a1.cross(piston).dot(force);
    r[1] += piston[2] * force[0] - piston[0] * force[2];
    r[2] += force[2];
    if constexpr (n == 4)
      for (int k = 0; k < 2; ++k) r[5 + k] += force[k];
  }

  void add_spin(const LegsInMotion& at, const Vector3L& row) {
    rod_spin.setConstant(zero);
    rod_spin[0] = at.cosine * at.e[0] + at.sine * at.e[2];
    rod_spin[1] = at.e[1];
    if constexpr (n >= 2) {
      rod_spin[3] = row.dot(at.e_1);
      rod_spin[4] = row.dot(at.e_2);
    }
  }
};

/// Chart rates (α̇, β̇, ṡ) per joint velocity in L: the inverse of [a1 × P, a2 × P, n].
Matrix3L inverse_joint_rates(const LegsInMotion& at) {
  const Vector3L& P = at.P;
  const Lanes per_k = 1.0 / (at.cosine * P[2] - at.sine * P[0]);
  const Lanes per_z = 1.0 / P[2];
  const Lanes beta = -at.sine * P[1] * per_k * per_z;
  Matrix3L inverse;
  inverse << zero, -per_k, zero, per_z, beta, zero, P[0] * per_z,
      at.cosine * P[1] * per_k + P[0] * beta, one;
  return inverse;
}

/// Joint velocity per rates of the flexible coordinates at constant (α, β, s).
template <int n>
Eigen::Matrix<Lanes, 3, n> flexible_joint_rates(const LegsInMotion& at, const Lanes& l_mn) {
  Eigen::Matrix<Lanes, 3, n> F;
  F.col(0) = l_mn * at.e_1;
  F.col(1) = l_mn * at.e_2;
  if constexpr (n == 4) {
    F.col(2) = Vector3L(one, zero, zero);
    F.col(3) = Vector3L(zero, one, zero);
  }
  return F;
}

/// Symmetric and positive definite: by 2×2 blocks.
Eigen::Matrix<Lanes, 2, 2> inverse(const Eigen::Matrix<Lanes, 2, 2>& A) {
  const Lanes per_determinant = 1.0 / (A(0, 0) * A(1, 1) - A(0, 1) * A(1, 0));
  Eigen::Matrix<Lanes, 2, 2> result;
  result << A(1, 1) * per_determinant, -A(0, 1) * per_determinant, -A(1, 0) * per_determinant,
      A(0, 0) * per_determinant;
  return result;
}

Eigen::Matrix<Lanes, 4, 4> inverse(const Eigen::Matrix<Lanes, 4, 4>& A) {
  using Block = Eigen::Matrix<Lanes, 2, 2>;
  const Block P = A.topLeftCorner<2, 2>(), Q = A.topRightCorner<2, 2>(),
              S = A.bottomRightCorner<2, 2>();
  const Block P_inverse = inverse(P), G = P_inverse * Q;
  const Block C = inverse(Block(S - Q.transpose() * G)), H = G * C;
  Eigen::Matrix<Lanes, 4, 4> result;
  result.topLeftCorner<2, 2>() = P_inverse + H * G.transpose();
  result.topRightCorner<2, 2>() = -H;
  result.bottomLeftCorner<2, 2>() = -H.transpose();
  result.bottomRightCorner<2, 2>() = C;
  return result;
}

template <int n>
void mass(const LegsInMotion& at, const LegSurroundings& around, const Partials<n>& partials,
          LegEquations<n>& out) {
  const auto& legs = around.legs;
  constexpr int size = 3 + n;
  Eigen::Matrix<Lanes, size, size> M;
  for (int column = 0; column < size; ++column)
    for (int row = 0; row <= column; ++row) {
      Lanes sum = legs.m_g * partials.g.col(row).dot(partials.g.col(column));
      if (row != 2 && column != 2)
        sum += legs.I_r * partials.e.col(row).dot(partials.e.col(column));
      if (around.spinning) sum += legs.I_ra * partials.rod_spin[row] * partials.rod_spin[column];
      if (legs.bends && n > 0)
        sum += partials.bow.col(row).dot(partials.bow_momentum.col(column) +
                                         legs.bow_self * partials.bow.col(column)) +
               partials.bow_momentum.col(row).dot(partials.bow.col(column));
      M(row, column) = M(column, row) = sum;
    }
  M(0, 0) += legs.I_b * at.cosine * at.cosine;
  M(1, 1) += legs.I_b;
  M(2, 2) += legs.m_a;
  if (around.spinning) M(0, 0) += legs.I_ta * at.sine * at.sine + legs.I_c;
  out.A_inverse = inverse_joint_rates(at);
  out.M_cc = M.template topLeftCorner<3, 3>();
  if constexpr (n > 0) {
    const Eigen::Matrix<Lanes, 3, n> G = out.A_inverse * flexible_joint_rates<n>(at, legs.l_mn);
    const Eigen::Matrix<Lanes, 3, n> M_cf = M.template topRightCorner<3, n>();
    out.X = M_cf - out.M_cc * G;
    out.M_ff = M.template bottomRightCorner<n, n>() - M_cf.transpose() * G - G.transpose() * out.X;
    out.M_ff_inverse = inverse(out.M_ff);
  }
}

/// Accelerations of the points of a leg for (α̈, β̈, s̈) = κ and constant flexible rates, in L.
struct PointAccelerations {
  Vector3L n, e, g;
  Vector3L piston, bow;                 ///< of legs that bend
  Lanes s, cross, case_spin, rod_spin;  ///< cross: of the lower gimbal, about a1
};

/// Angular acceleration of the frame at α̈ = β̈ = 0: α̇ β̇ a1 × a2.
Vector3L frame_bias(const LegsInMotion& at) {
  const Lanes product = at.alpha * at.beta;
  return {-at.sine * product, zero, at.cosine * product};
}

Vector3L piston_rate(const LegsInMotion& at) {
  return {at.flexible_rate[2], at.flexible_rate[3], at.s_rate};
}

/// Joint acceleration, in L, when the chart's rates stay constant.
Vector3L joint_bias_in_chart(const LegsInMotion& at, const Lanes& l_mn) {
  const Vector3L& w = at.omega;
  const Vector3L P_rate = piston_rate(at) + l_mn * at.e_bending;
  const Vector3L inner = w.cross(at.P) + two * P_rate;
  return frame_bias(at).cross(at.P) + w.cross(inner) + l_mn * at.e_curvature;
}

PointAccelerations point_accelerations(const LegsInMotion& at, const Vector3L& kappa,
                                       const LegConstants& legs, bool bends) {
  const Lanes& c_g = legs.c_g;
  const Vector3L& w = at.omega;
  const Vector3L dw = frame_bias(at) + Vector3L(at.cosine * kappa[0], kappa[1], at.sine * kappa[0]);
  const Vector3L g_rate = piston_rate(at) + c_g * at.e_bending;
  const Vector3L e_inner = w.cross(at.e) + two * at.e_bending;
  const Vector3L g_inner = w.cross(at.g) + two * g_rate;
  PointAccelerations out;
  out.n = Vector3L(dw[1], -dw[0], zero) + w.cross(Vector3L(w[1], -w[0], zero));
  out.e = dw.cross(at.e) + w.cross(e_inner) + at.e_curvature;
  out.g = dw.cross(at.g) + w.cross(g_inner) + c_g * at.e_curvature;
  out.g[2] += kappa[2];
  out.s = kappa[2];
  out.cross = kappa[0];
  out.case_spin = dw[2];
  out.rod_spin = dw.dot(at.e) + w.dot(at.e_bending);
  if (!bends) return out;
  const Vector3L piston(at.flexible[2], at.flexible[3], at.s);
  const Vector3L piston_inner = w.cross(piston) + two * piston_rate(at);
  out.piston = dw.cross(piston) + w.cross(piston_inner);
  out.piston[2] += kappa[2];
  const Vector3L bow_inner = at.bow_rate - w.cross(at.bow);  // b° that L sees
  const Vector3L bow_twice = at.bow_rate + bow_inner;
  const Vector2L by_extension = kappa[2] * (legs.bow_slope * at.sleeve_slopes.col(0));
  out.bow = dw.cross(at.bow) + w.cross(bow_twice) + at.bow_curvature +
            Vector3L(by_extension[0], by_extension[1], zero);
  return out;
}

/// Forces that are dual to the motions of n, e, g and s: inertia less what acts.
struct PointForces {
  Vector3L n, e, g;
  Vector3L piston, bow;  ///< of legs that bend
  Lanes s, cross, case_spin, rod_spin;
};

PointForces point_forces(const LegsInMotion& at, const LegSurroundings& around,
                         const PointAccelerations& acceleration, const AxialSpin& spin) {
  const auto& legs = around.legs;
  const Vector3L g_L = in_cases(at, around.gravity);
  PointForces forces;
  forces.n = legs.I_b * acceleration.n - legs.m_t_r_b * g_L;
  forces.e = legs.I_r * acceleration.e;
  forces.g = legs.m_g * (acceleration.g - g_L);
  forces.s = legs.m_a * acceleration.s - around.axial_force;
  if (!around.spinning) return forces;
  // Angular momentum along a turning axis: I σ ė × e on the axis' motion, and ṅ = (ω_2, −ω_1, 0).
  const Lanes momentum = legs.I_ta * spin.of_case;
  forces.n += Vector3L(-momentum * at.omega[0], -momentum * at.omega[1], zero);
  forces.e += (legs.I_ra * spin.of_rod) * at.e_rate.cross(at.e);
  forces.cross = legs.I_c * acceleration.cross;
  forces.case_spin = legs.I_ta * acceleration.case_spin;
  forces.rod_spin = legs.I_ra * (acceleration.rod_spin + spin.row_rate);
  return forces;
}

/// Inertia of the bow: 2T = 2 ḃ·(bow_case ṅ − bow_piston ṗ − bow_tilt ė) + bow_self |ḃ|².
void add_bow_inertia(const LegConstants& legs, const PointAccelerations& acceleration,
                     PointForces& forces) {
  forces.n += legs.bow_case * acceleration.bow;
  forces.e -= legs.bow_tilt * acceleration.bow;
  forces.piston = -legs.bow_piston * acceleration.bow;
  forces.bow = legs.bow_case * acceleration.n - legs.bow_piston * acceleration.piston -
               legs.bow_tilt * acceleration.e + legs.bow_self * acceleration.bow;
}

/// Friction at both joints of the legs; returns the moments on the platform in L.
Vector3L add_joint_friction(const LegsInMotion& at, const LegSurroundings& around,
                            PointForces& forces) {
  if (!around.joint_friction) return {zero, zero, zero};
  const auto turning = joint_turning(at, around.legs, around.omega);
  forces.n += turning.base_slope * turning.base_rate;
  Vector3L moment = turning.platform_slope * turning.platform_rate;
  if (around.joints_stick) {
    const AcrossRod across(at);
    forces.n += Vector3L(around.base_torque[0], around.base_torque[1], zero);
    moment += around.platform_torque[0] * across.first + around.platform_torque[1] * across.second;
  }
  forces.e -= moment.cross(at.e);
  return -moment;
}

Lanes cross(const Vector2L& v, const Vector2L& force) { return v[0] * force[1] - v[1] * force[0]; }

/// `part` of the guide contact of every leg.
Lanes of_guides(const LegsInMotion& at, const LegConstants& legs, double GuideContact::*part) {
  const Vector2L& at_seal = legs.bends ? at.seal_offset : at.sleeve_offset;
  const Lanes offset = sqrt(at_seal.dot(at_seal));
  Lanes result;
  for (int i = 0; i < Lanes::size; ++i)
    result.set(i, guide_contact(offset[i], legs.gap[i], legs.k_c[i]).*part);
  return result;
}

/// What the guide sleeve brings against d_s, of which `damper` (dampers, and arms of elastomers)
/// turns with the case.
struct SleeveForce {
  Vector2L force, damper;
  Vector2L damped;   ///< the offset that the damper sees
  Lanes along_case;  ///< against s, beside what d_s does
};

SleeveForce sleeve_force(const LegsInMotion& at, const LegSurroundings& around) {
  const auto& legs = around.legs;
  SleeveForce sleeve;
  if (!legs.bends) {
    sleeve.damped = at.sleeve_offset;
    sleeve.damper = legs.c_s * at.sleeve_offset_rate;
    if (around.seals_press) sleeve.damper += around.sleeve_force;
    sleeve.force =
        (legs.guide_contact ? legs.k_s + guide_secant(at, legs) : legs.k_s) * at.sleeve_offset +
        sleeve.damper;
    return sleeve;
  }
  sleeve.damped = at.seal_offset;
  sleeve.damper = legs.c_s * at.seal_offset_rate;
  if (around.seals_press) sleeve.damper += around.sleeve_force;
  const Vector2L on_chords = at.seal_per_offset * sleeve.damper;
  sleeve.force = at.bending_force + on_chords;
  sleeve.along_case = -at.bending_slope * at.bending_force.dot(0.5 * at.bending_force + on_chords);
  return sleeve;
}

/// Forces of seals on the chart: springs and dampers. Dampers see what the case sees.
template <int n>
void add_seals(const LegsInMotion& at, const LegSurroundings& around,
               Eigen::Matrix<Lanes, 3 + n, 1>& r) {
  const auto& legs = around.legs;
  const SleeveForce of_sleeve = sleeve_force(at, around);
  const Vector2L& sleeve = of_sleeve.force;
  for (int k = 0; k < 3; ++k) r[2 + k] += at.sleeve_slopes.col(k).dot(sleeve);
  if (legs.bends) r[2] += of_sleeve.along_case;
  Lanes about_n = cross(of_sleeve.damped, of_sleeve.damper);
  if constexpr (n == 4) {
    const Vector2L offset(at.flexible[2], at.flexible[3]);
    Vector2L ring_damper = legs.c_ring * at.ring_offset_rate;
    if (around.seals_press) ring_damper += around.ring_force;
    for (int k = 0; k < 2; ++k) r[5 + k] += sleeve[k] + legs.k_g * offset[k] + ring_damper[k];
    about_n += cross(offset, ring_damper);
  }
  if (around.seals_press) about_n += around.frame_moment;
  if (!around.spinning) r[0] += at.sine * about_n;
}

template <int n>
Eigen::Matrix<Lanes, 3 + n, 1> residual(const LegsInMotion& at, const LegSurroundings& around,
                                        const Partials<n>& partials, const PointForces& forces) {
  Eigen::Matrix<Lanes, 3 + n, 1> r;
  for (int k = 0; k < 3 + n; ++k) {
    r[k] = partials.g.col(k).dot(forces.g);
    if (k != 2) r[k] += partials.e.col(k).dot(forces.e);
    if (around.spinning) r[k] += forces.rod_spin * partials.rod_spin[k];
    if (n > 0 && around.legs.bends) r[k] += partials.bow.col(k).dot(forces.bow);
  }
  if (n > 0 && around.legs.bends) partials.add_piston(at, forces.piston, r);
  r[0] -= at.cosine * forces.n[1];
  r[1] += forces.n[0];
  r[2] += forces.s;
  if (around.spinning) r[0] += forces.cross + at.sine * forces.case_spin;
  if constexpr (n > 0) add_seals<n>(at, around, r);
  return r;
}

}  // namespace

Lanes guide_secant(const LegsInMotion& at, const LegConstants& legs) {
  return of_guides(at, legs, &GuideContact::secant);
}

Lanes guide_energy(const LegsInMotion& at, const LegConstants& legs) {
  return of_guides(at, legs, &GuideContact::energy);
}

namespace {

/// Velocities of the piston and of n in B, components in L.
struct AlongLeg {
  Vector3L piston, piston_rate, n_rate;

  explicit AlongLeg(const LegsInMotion& at)
      : piston(at.flexible[2], at.flexible[3], at.s),
        piston_rate(at.omega.cross(piston) + dynamics::piston_rate(at)),
        n_rate(at.omega[1], -at.omega[0], zero) {}
};

}  // namespace

Lanes bow_energy(const LegsInMotion& at, const LegConstants& legs) {
  const AlongLeg leg(at);
  const Vector3L momentum =
      legs.bow_case * leg.n_rate - legs.bow_piston * leg.piston_rate - legs.bow_tilt * at.e_rate;
  return at.bow_rate.dot(two * momentum + legs.bow_self * at.bow_rate);
}

BowMomentum bow_momentum(const LegsInMotion& at, const LegConstants& legs) {
  const AlongLeg leg(at);
  const Vector3L n(zero, zero, one);
  const auto about = [&](const Vector3L& arm, const Vector3L& arm_rate) {
    return Vector3L(arm.cross(at.bow_rate) + at.bow.cross(arm_rate));
  };
  return {-legs.bow_moment * at.bow_rate, legs.bow_case * about(n, leg.n_rate) -
                                              legs.bow_piston * about(leg.piston, leg.piston_rate) -
                                              legs.bow_tilt * about(at.e, at.e_rate) +
                                              legs.bow_self * at.bow.cross(at.bow_rate)};
}

Vector3L in_cases(const LegsInMotion& at, const Vector3& v) {
  return at.R_BL.transpose() * Vector3L(Lanes(v.x()), Lanes(v.y()), Lanes(v.z()));
}

AxialSpin axial_spin(const LegsInMotion& at, const Vector3L& piston_axis) {
  AxialSpin spin;
  spin.of_case = at.omega[2];
  const Vector3L normal = at.e.cross(piston_axis);
  const Lanes per_square = 1.0 / normal.dot(normal);
  const Lanes along = piston_axis.dot(at.e), ratio = along * per_square;
  spin.row = -ratio * normal;
  spin.of_rod = at.omega.dot(at.e) + spin.row.dot(at.e_bending);
  const Vector3L normal_rate = at.e_bending.cross(piston_axis);
  const Lanes growth =
      (two * ratio * normal.dot(normal_rate) - piston_axis.dot(at.e_bending)) * per_square;
  const Vector3L row_rate = growth * normal - ratio * normal_rate;
  spin.row_rate = row_rate.dot(at.e_bending) + spin.row.dot(at.e_curvature);
  return spin;
}

JointTurning joint_turning(const LegsInMotion& at, const LegConstants& legs, const Vector3& omega) {
  JointTurning turning;
  turning.base_rate = Vector3L(at.omega[1], -at.omega[0], zero);
  const Vector3L omega_L = in_cases(at, omega);
  turning.platform_rate = omega_L - at.e.dot(omega_L) * at.e - at.e.cross(at.e_rate);
  const auto slope = [&](const Vector3L& rate) {
    const Lanes ratio = sqrt(rate.dot(rate)) / legs.joint_smoothing;
    const Lanes saturated =
        each(ratio, [](double q) { return q > 1e-4 ? std::tanh(q) / q : 1.0 - q * q / 3.0; });
    return legs.joint_viscous + legs.joint_coulomb / legs.joint_smoothing * saturated;
  };
  turning.base_slope = slope(turning.base_rate);
  turning.platform_slope = slope(turning.platform_rate);
  return turning;
}

template <int n>
void leg_mass(const LegsInMotion& at, const LegSurroundings& around, LegEquations<n>& equations) {
  Partials<n> partials(at, around.legs);
  if (around.spinning) partials.add_spin(at, axial_spin(at, around.legs.piston_axis).row);
  mass<n>(at, around, partials, equations);
}

template <int n>
void leg_equations(const LegsInMotion& at, const LegSurroundings& around,
                   LegEquations<n>& equations) {
  const auto& legs = around.legs;
  Partials<n> partials(at, legs);
  AxialSpin spin;
  if (around.spinning) {
    spin = axial_spin(at, legs.piston_axis);
    partials.add_spin(at, spin.row);
  }
  mass<n>(at, around, partials, equations);

  const Vector3L bias =
      at.R_BL.transpose() * around.joint_bias - joint_bias_in_chart(at, legs.l_mn);
  const Vector3L kappa = equations.A_inverse * bias;
  const auto accelerations = point_accelerations(at, kappa, legs, n > 0 && legs.bends);
  PointForces forces = point_forces(at, around, accelerations, spin);
  if (n > 0 && legs.bends) add_bow_inertia(legs, accelerations, forces);
  equations.joint_moment = at.R_BL * add_joint_friction(at, around, forces);
  const Eigen::Matrix<Lanes, 3 + n, 1> r = residual<n>(at, around, partials, forces);
  equations.r_c = r.template head<3>();
  if constexpr (n > 0) {
    const Eigen::Matrix<Lanes, 3, n> F = flexible_joint_rates<n>(at, legs.l_mn);
    const Vector3L at_joint = equations.A_inverse.transpose() * equations.r_c;
    equations.r_f = r.template tail<n>() - F.transpose() * at_joint;
  }
}

template void leg_mass<0>(const LegsInMotion&, const LegSurroundings&, LegEquations<0>&);
template void leg_mass<2>(const LegsInMotion&, const LegSurroundings&, LegEquations<2>&);
template void leg_mass<4>(const LegsInMotion&, const LegSurroundings&, LegEquations<4>&);
template void leg_equations<0>(const LegsInMotion&, const LegSurroundings&, LegEquations<0>&);
template void leg_equations<2>(const LegsInMotion&, const LegSurroundings&, LegEquations<2>&);
template void leg_equations<4>(const LegsInMotion&, const LegSurroundings&, LegEquations<4>&);

}  // namespace hydrapod::dynamics
