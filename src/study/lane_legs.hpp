#pragma once
/// Legs of several designs at once: straight_leg() and bent_leg() of dynamics/leg.hpp, whose header
/// derives them, in the coordinates (v_t, v_2, v_n | φ1, φ2 | u1, u2). Private to the kernels.
///
/// Against dynamics: no dampers, no guide ring, no inertia of oil lines; angles of the gimbals
/// enter by their sines and cosines alone. With h = a1·L, P the joint in the case frame
/// (bent_leg.cpp),
///
///     w = √(P_x² + P_z² − h²),   cos θ = (w P_z + h P_x)/(P_x² + P_z²),   |P_y L⊥ − w a1 × L⊥| =
///     P_y² + w²

#include "lane_numbers.hpp"
#include "lane_vector.hpp"

namespace hydrapod::study {

namespace {

/// A leg linearised. Of symmetric matrices the lower triangle alone.
template <class V, int flexible>
struct LaneLeg {
  static constexpr int size = 3 + flexible;
  Space<V> t, a2, n;  ///< its axes in B
  V M[size][size], K[size][size];
};

/// k_h with the piston at s, gimbals in series.
template <class V>
HYDRAPOD_INLINE V axial_stiffness(const LegNumbers<V>& leg, const V& s) {
  const V k_h = leg.area_squared[0] / (leg.volume[0] + leg.volume_slope[0] * s) +
                leg.area_squared[1] / (leg.volume[1] + leg.volume_slope[1] * s);
  return k_h / (1.0 + leg.gimbal_compliance * k_h);
}

/// Adds factor · row rowᵀ.
template <class V, int size>
HYDRAPOD_INLINE void add_square(const V& factor, const V (&row)[size], V (&A)[size][size]) {
  for (int i = 0; i < size; ++i) {
    const V scaled = factor * row[i];
    for (int j = 0; j <= i; ++j) A[i][j] += scaled * row[j];
  }
}

/// The numbers of `row` that the leg of a smaller model has.
template <class V, int flexible>
struct LegRow {
  V at[3 + flexible];
  HYDRAPOD_INLINE LegRow() {
    for (V& number : at) number = V{};
  }
  HYDRAPOD_INLINE void put(int k, const V& value) {
    if (k < 3 + flexible) at[k] = value;
  }
};

/// Mass and lateral springs of one bending plane. Its coordinates (v, φ, u) are v, phi, u of the
/// leg's; φ turns the rod along v by `sign`.
template <class V, int flexible>
HYDRAPOD_INLINE void add_plane(const LegNumbers<V>& leg, const V& l, int v, int phi, int u,
                               double sign, LaneLeg<V, flexible>& out) {
  const V per_l = 1.0 / l, l_m = l - leg.l_mn, l_mh = leg.L_g - l_m, r_a = l_m + leg.c_g;
  LegRow<V, flexible> omega, v_g, omega_rod, d;  // ω = (v − u̇ − l_mn φ̇) / l
  const V tilt = -(leg.l_mn * per_l);
  omega.put(v, per_l);
  omega.put(phi, sign * tilt);
  omega.put(u, -per_l);
  v_g.put(v, r_a * per_l);
  v_g.put(phi, sign * (r_a * tilt + leg.c_g));
  v_g.put(u, 1.0 - r_a * per_l);
  omega_rod.put(v, per_l);
  omega_rod.put(phi, sign * (1.0 + tilt));
  omega_rod.put(u, -per_l);
  d.put(phi, sign * l_mh);
  d.put(u, V{} + 1.0);
  add_square(leg.m_t * leg.r_b * leg.r_b + leg.I_t, omega.at, out.M);
  add_square(leg.m_g, v_g.at, out.M);
  add_square(leg.I_r, omega_rod.at, out.M);
  add_square(leg.k_s, d.at, out.K);
  if (u < 3 + flexible) out.K[u][u] += leg.k_g;
}

/// Rotations forced by the gimbals.
template <class V, int flexible>
HYDRAPOD_INLINE void add_gimbal_rotations(const LegNumbers<V>& leg, const V& l,
                                          LaneLeg<V, flexible>& out) {
  const Space<V> a1 = space(leg.axis);
  const V sec = 1.0 / dot(a1, out.t), tan = dot(a1, out.n) * sec, per_l = 1.0 / l;
  LegRow<V, flexible> omega_t, spin;  // of the case about t
  omega_t.put(1, -per_l);
  omega_t.put(3, -(leg.l_mn * per_l));
  omega_t.put(6, per_l);
  spin = omega_t;
  spin.put(3, 1.0 - leg.l_mn * per_l);
  add_square(tan * tan * leg.I_ta + sec * sec * leg.I_c, omega_t.at, out.M);
  add_square(tan * tan * leg.I_ra, spin.at, out.M);
}

template <class V, int flexible>
void straight_leg(const LegNumbers<V>& leg, bool gimbal, LaneLeg<V, flexible>& out) {
  const Space<V> L = space(leg.L);
  const V l = root(dot(L, L));
  out.n = (1.0 / l) * L;
  out.a2 = cross(out.n, space(leg.axis));
  out.a2 = (1.0 / root(dot(out.a2, out.a2))) * out.a2;
  out.t = cross(out.a2, out.n);
  for (int i = 0; i < 3 + flexible; ++i)
    for (int j = 0; j <= i; ++j) out.M[i][j] = out.K[i][j] = V{};
  // a tilt about a2 moves the rod towards t, a tilt about t moves it away from a2
  add_plane<V, flexible>(leg, l, 0, 4, 5, 1.0, out);
  add_plane<V, flexible>(leg, l, 1, 3, 6, -1.0, out);
  out.M[2][2] += leg.m_g + leg.m_a;
  out.K[2][2] += axial_stiffness(leg, l - leg.l_mn);
  if (gimbal) add_gimbal_rotations<V, flexible>(leg, l, out);
}

/// Sine and cosine up to π/4: series that end below rounding there.
template <class V>
HYDRAPOD_INLINE void sine_cosine(const V& x, V& sine, V& cosine) {
  const V q = x * x;
  V s = V{} + 1.0, c = s;
  for (int k = 16; k >= 2; k -= 2) {
    s = 1.0 - (1.0 / (k * (k + 1))) * (q * s);
    c = 1.0 - (1.0 / (k * (k - 1))) * (q * c);
  }
  sine = x * s;
  cosine = c;
}

/// Where a leg stands: φ and u, and the oil's force.
template <class V, int flexible>
struct LaneLegState {
  V at[flexible == 0 ? 1 : flexible];
  V oil_force;

  HYDRAPOD_INLINE V phi(int k) const { return flexible >= 2 ? at[k] : V{}; }
  HYDRAPOD_INLINE V u(int k) const { return flexible == 4 ? at[2 + k] : V{}; }
};

/// bent_leg() in steps: place(), then what the balance and its derivatives need, then the element.
template <class V, int flexible>
class LaneBentLeg {
 public:
  static constexpr int size = 3 + flexible;
  Space<V> t, a2, n;            ///< axes of the case in B
  Space<V> joint_force;         ///< λ in B
  V gradient[size];             ///< ∂V/∂(φ, u) at a fixed joint, from [3] on
  V s_x[size];                  ///< extension per coordinate
  V K_without_oil[size][size];  ///< lower triangle
  V l_mh;

  /// NaN where no extension closes the leg or its tilt is more than π/4.
  void place(const LegNumbers<V>& leg, const Space<V>& gravity,
             const LaneLegState<V, flexible>& state) {
    rod_direction(state);
    close(leg, state);
    sleeve();
    const Space<V> g_L{dot(t, gravity), dot(a2, gravity), dot(n, gravity)};
    of_case_ = -leg.m_t * g_L;
    of_rod_ = -leg.m_g * g_L;
    Rates joint_rates(*this, leg.l_mn), rod_rates(*this, leg.c_g);
    first_derivatives(leg, state, joint_rates, rod_rates);
    second_derivatives(leg, joint_rates, rod_rates);
  }

  void element(const LegNumbers<V>& leg, bool gimbal, LaneLeg<V, flexible>& out) const {
    out.t = t;
    out.a2 = a2;
    out.n = n;
    const V k_h = axial_stiffness(leg, s_);
    for (int i = 0; i < size; ++i)
      for (int j = 0; j <= i; ++j) out.K[i][j] = K_without_oil[i][j];
    add_square(k_h, s_x, out.K);
    V M[size][size];
    chart_mass(leg, gimbal, M);
    to_local(M, out.M);
  }

 private:
  static constexpr int alpha = 0, beta = 1, extension = 2, phi = 3, offset = 5;

  Space<V> e_, e_1_, e_2_, e_11_, e_12_, e_22_;  ///< of the rod, and derivatives by φ1, φ2
  Space<V> P_, a1_;                              ///< joint and gimbal axis in the case frame
  Space<V> of_case_, of_rod_, lambda_;           ///< −weights, force of the joint, there
  V s_, u_[2];
  V d_[2], tau_[2], tau_1_[2], tau_2_[2], tau_11_[2], tau_12_[2], tau_22_[2];  ///< offset at sleeve
  V G_[3][size];  ///< (α, β, s) per coordinate of the leg

  /// ∂P/∂chart of a point of the rod, ξ from the piston.
  struct Rates {
    Space<V> P;
    Space<V> by[size];
    HYDRAPOD_INLINE Rates(const LaneBentLeg& leg, const V& xi) {
      const V zero{}, one = zero + 1.0;
      P = Space<V>{leg.u_[0], leg.u_[1], leg.s_} + xi * leg.e_;
      by[alpha] = cross(leg.a1_, P);
      by[beta] = {P.z, zero, -P.x};
      by[extension] = {zero, zero, one};
      if constexpr (flexible >= 2) {
        by[phi] = xi * leg.e_1_;
        by[phi + 1] = xi * leg.e_2_;
      }
      if constexpr (flexible == 4) {
        by[offset] = {one, zero, zero};
        by[offset + 1] = {zero, one, zero};
      }
    }
  };

  HYDRAPOD_INLINE void rod_direction(const LaneLegState<V, flexible>& state) {
    V s1, c1, s2, c2;
    const V zero{};
    sine_cosine(state.phi(0), s1, c1);
    sine_cosine(state.phi(1), s2, c2);
    e_ = {s2, -s1 * c2, c1 * c2};
    e_1_ = {zero, -c1 * c2, -s1 * c2};
    e_2_ = {c2, s1 * s2, -c1 * s2};
    e_11_ = {zero, s1 * c2, -c1 * c2};
    e_12_ = {zero, c1 * s2, s1 * s2};
    e_22_ = {-s2, s1 * c2, -c1 * c2};
  }

  HYDRAPOD_INLINE void close(const LegNumbers<V>& leg, const LaneLegState<V, flexible>& state) {
    const Space<V> L = space(leg.L), a1 = space(leg.axis);
    for (int k = 0; k < 2; ++k) u_[k] = state.u(k);
    const Space<V> q = Space<V>{u_[0], u_[1], V{}} + leg.l_mn * e_;
    constexpr double quarter_pi = 0.785398163397448;
    const auto folded = (size_of(state.phi(0)) > quarter_pi) | (size_of(state.phi(1)) > quarter_pi);
    const V length = select(folded, V{} - 1.0, dot(L, L) - q.x * q.x - q.y * q.y);
    s_ = root(length) - q.z;  // q_z² + L² − q²
    l_mh = leg.L_g - s_;
    P_ = {q.x, q.y, q.z + s_};
    const V h = dot(a1, L), square = P_.x * P_.x + P_.z * P_.z, w = root(square - h * h);
    const V per_square = 1.0 / square;
    const V c = (w * P_.z + h * P_.x) * per_square, sine = (h * P_.z - w * P_.x) * per_square;
    const Space<V> normal = L - h * a1;
    a2 = (1.0 / (P_.y * P_.y + w * w)) * (P_.y * normal - w * cross(a1, normal));
    const Space<V> third = cross(a1, a2);
    t = c * a1 - sine * third;
    n = sine * a1 + c * third;
    a1_ = {c, V{}, sine};
    const V per_w = 1.0 / w, per_z = 1.0 / P_.z, b = -(sine * P_.y * per_w * per_z);
    const V inverse[3][3] = {{V{}, -per_w, V{}},  // of [a1 × P, a2 × P, n]
                             {per_z, b, V{}},
                             {P_.x * per_z, c * P_.y * per_w + P_.x * b, V{} + 1.0}};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) G_[i][j] = inverse[i][j];
      if constexpr (flexible >= 2) {
        G_[i][phi] = -(leg.l_mn * apply(inverse[i], e_1_));
        G_[i][phi + 1] = -(leg.l_mn * apply(inverse[i], e_2_));
      }
      if constexpr (flexible == 4)
        for (int k = 0; k < 2; ++k) G_[i][offset + k] = -inverse[i][k];
    }
    for (int j = 0; j < size; ++j) s_x[j] = G_[extension][j];
  }

  static HYDRAPOD_INLINE V apply(const V (&row)[3], const Space<V>& v) {
    return row[0] * v.x + row[1] * v.y + row[2] * v.z;
  }

  /// Lateral offset at the guide sleeve, d = u + (L_g − s) τ.
  HYDRAPOD_INLINE void sleeve() {
    const V per_z = 1.0 / e_.z;
    const V e[2] = {e_.x, e_.y}, e_1[2] = {e_1_.x, e_1_.y}, e_2[2] = {e_2_.x, e_2_.y},
            e_11[2] = {e_11_.x, e_11_.y}, e_12[2] = {e_12_.x, e_12_.y},
            e_22[2] = {e_22_.x, e_22_.y};
    for (int k = 0; k < 2; ++k) {
      tau_[k] = e[k] * per_z;
      tau_1_[k] = (e_1[k] - tau_[k] * e_1_.z) * per_z;
      tau_2_[k] = (e_2[k] - tau_[k] * e_2_.z) * per_z;
      tau_11_[k] = (e_11[k] - 2.0 * (tau_1_[k] * e_1_.z) - tau_[k] * e_11_.z) * per_z;
      tau_12_[k] = (e_12[k] - tau_1_[k] * e_2_.z - tau_2_[k] * e_1_.z - tau_[k] * e_12_.z) * per_z;
      tau_22_[k] = (e_22[k] - 2.0 * (tau_2_[k] * e_2_.z) - tau_[k] * e_22_.z) * per_z;
      d_[k] = u_[k] + l_mh * tau_[k];
    }
  }

  /// ∂d/∂chart in direction k.
  HYDRAPOD_INLINE LegRow<V, flexible> sleeve_slope(int k) const {
    LegRow<V, flexible> slope;
    slope.put(extension, -tau_[k]);
    slope.put(phi, l_mh * tau_1_[k]);
    slope.put(phi + 1, l_mh * tau_2_[k]);
    slope.put(offset + k, V{} + 1.0);
    return slope;
  }

  HYDRAPOD_INLINE void first_derivatives(const LegNumbers<V>& leg,
                                         const LaneLegState<V, flexible>& state, const Rates& joint,
                                         const Rates& rod) {
    const LegRow<V, flexible> D_0 = sleeve_slope(0), D_1 = sleeve_slope(1);
    V chart[size];
    for (int j = 0; j < size; ++j)
      chart[j] = leg.k_s * (D_0.at[j] * d_[0] + D_1.at[j] * d_[1]) + dot(rod.by[j], of_rod_);
    chart[alpha] -= leg.r_b * (a1_.x * of_case_.y);  // the case's centre, r_b n
    chart[beta] += leg.r_b * of_case_.x;
    chart[extension] += state.oil_force;
    if constexpr (flexible == 4)
      for (int k = 0; k < 2; ++k) chart[offset + k] += leg.k_g * u_[k];
    V lambda[3];
    for (int j = 0; j < 3; ++j)
      lambda[j] = G_[0][j] * chart[0] + G_[1][j] * chart[1] + G_[2][j] * chart[2];
    lambda_ = {lambda[0], lambda[1], lambda[2]};
    joint_force = lambda_.x * t + lambda_.y * a2 + lambda_.z * n;
    for (int j = 3; j < size; ++j) gradient[j] = chart[j] - dot(joint.by[j], lambda_);
  }

  /// ∂²V/∂chart² − λ·∂²a/∂chart² at constant oil force, brought to the leg's coordinates.
  HYDRAPOD_INLINE void second_derivatives(const LegNumbers<V>& leg, const Rates& joint,
                                          const Rates& rod) {
    V H[size][size];
    for (int i = 0; i < size; ++i)
      for (int j = 0; j <= i; ++j) H[i][j] = V{};
    for (int k = 0; k < 2; ++k) {
      add_square(leg.k_s, sleeve_slope(k).at, H);
      const V force = leg.k_s * d_[k];
      if constexpr (flexible >= 2) {
        H[phi][extension] -= force * tau_1_[k];
        H[phi + 1][extension] -= force * tau_2_[k];
        H[phi][phi] += force * (l_mh * tau_11_[k]);
        H[phi + 1][phi] += force * (l_mh * tau_12_[k]);
        H[phi + 1][phi + 1] += force * (l_mh * tau_22_[k]);
      }
      if constexpr (flexible == 4) H[offset + k][offset + k] += leg.k_g;
    }
    add_curvature(rod, of_rod_, leg.c_g, H);
    add_curvature(joint, -lambda_, leg.l_mn, H);
    // the case's centre r_b n: ∂α = −r_b cos θ a2, ∂β = r_b t
    const Space<V> by_alpha = cross(of_case_, a1_);
    H[alpha][alpha] -= by_alpha.y * (leg.r_b * a1_.x);
    H[beta][alpha] += by_alpha.x * leg.r_b;
    H[beta][beta] -= of_case_.z * leg.r_b;
    to_local(H, K_without_oil);
  }

  /// Adds γ·∂²P/∂chart² of a point of the rod.
  HYDRAPOD_INLINE void add_curvature(const Rates& point, const Space<V>& gamma, const V& xi,
                                     V (&H)[size][size]) const {
    const Space<V> by_alpha = cross(gamma, a1_);
    const Space<V> by_beta{-gamma.z, V{}, gamma.x};  // γ × a2
    for (int j = 0; j < size; ++j) H[j][alpha] += dot(by_alpha, point.by[j]);
    for (int j = 1; j < size; ++j) H[j][beta] += dot(by_beta, point.by[j]);
    if constexpr (flexible >= 2) {
      H[phi][phi] += xi * dot(gamma, e_11_);
      H[phi + 1][phi] += xi * dot(gamma, e_12_);
      H[phi + 1][phi + 1] += xi * dot(gamma, e_22_);
    }
  }

  /// Tᵀ A T of the lower triangle of A, T = [G; 0 1].
  HYDRAPOD_INLINE void to_local(const V (&A)[size][size], V (&out)[size][size]) const {
    V AT[size][size];
    for (int i = 0; i < size; ++i)
      for (int j = 0; j < size; ++j) {
        V sum = A[i][0] * G_[0][j];
        for (int k = 1; k < 3; ++k) sum += (i >= k ? A[i][k] : A[k][i]) * G_[k][j];
        AT[i][j] = j < 3 ? sum : sum + (i >= j ? A[i][j] : A[j][i]);
      }
    for (int i = 0; i < size; ++i)
      for (int j = 0; j <= i; ++j) {
        const V sum = G_[0][i] * AT[0][j] + G_[1][i] * AT[1][j] + G_[2][i] * AT[2][j];
        out[i][j] = i < 3 ? sum : sum + AT[i][j];
      }
  }

  HYDRAPOD_INLINE void chart_mass(const LegNumbers<V>& leg, bool gimbal, V (&M)[size][size]) const {
    const Rates rod(*this, leg.c_g);
    Space<V> e_by[size];  // ė, whose length is the rod's transverse rate
    for (auto& one : e_by) one = {V{}, V{}, V{}};
    e_by[alpha] = cross(a1_, e_);
    e_by[beta] = {e_.z, V{}, -e_.x};
    if constexpr (flexible >= 2) {
      e_by[phi] = e_1_;
      e_by[phi + 1] = e_2_;
    }
    for (int i = 0; i < size; ++i)
      for (int j = 0; j <= i; ++j)
        M[i][j] = leg.m_g * dot(rod.by[i], rod.by[j]) + leg.I_r * dot(e_by[i], e_by[j]);
    const V I_base = leg.m_t * leg.r_b * leg.r_b + leg.I_t;
    M[alpha][alpha] += I_base * a1_.x * a1_.x;
    M[beta][beta] += I_base;
    M[extension][extension] += leg.m_a;
    if (!gimbal) return;
    // Case: σ = a1·n α̇. Rod: two revolute joints, first axis a1, second normal to a1 and e.
    M[alpha][alpha] += leg.I_c + leg.I_ta * a1_.z * a1_.z;
    const Space<V> normal = cross(e_, a1_);
    const V along = dot(a1_, e_), ratio = along / dot(normal, normal);
    LegRow<V, flexible> spin;
    spin.put(alpha, along);
    spin.put(beta, e_.y);
    spin.put(phi, -(ratio * dot(normal, e_1_)));
    spin.put(phi + 1, -(ratio * dot(normal, e_2_)));
    add_square(leg.I_ra, spin.at, M);
  }
};

}  // namespace

}  // namespace hydrapod::study
