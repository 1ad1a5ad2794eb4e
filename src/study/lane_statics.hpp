#pragma once
/// Static equilibria of several designs at once: dynamics::static_equilibrium(), one per lane.
/// Private to the kernels.
///
/// A lane that has ended keeps its state while the others go on, so that an equilibrium does not
/// depend on the designs beside it. Lanes that end otherwise than converged, or have not ended
/// after `most_iterations`, are marked; their designs are computed alone.

#include "lane_legs.hpp"

namespace hydrapod::study {

namespace {

/// Newton needs three to six from a neighbour, up to ten from straight legs.
constexpr int most_iterations = 16;

template <class V>
HYDRAPOD_INLINE void put_wrench(const Space<V>& force, const Space<V>& arm, V (&w)[6]) {
  const Space<V> moment = cross(arm, force);
  w[0] = force.x;
  w[1] = force.y;
  w[2] = force.z;
  w[3] = moment.x;
  w[4] = moment.y;
  w[5] = moment.z;
}

/// x of A x = b; Gauss with the largest pivot of each lane. A and b are destroyed.
template <class V, int size>
void solve_lanes(V (&A)[size][size], V (&b)[size]) {
  for (int k = 0; k < size; ++k) {
    for (int row = k + 1; row < size; ++row) {
      const auto swapped = size_of(A[row][k]) > size_of(A[k][k]);
      const auto swap = [&](V& x, V& y) {
        const V old = x;
        x = select(swapped, y, x);
        y = select(swapped, old, y);
      };
      for (int j = k; j < size; ++j) swap(A[k][j], A[row][j]);
      swap(b[k], b[row]);
    }
    const V per_pivot = 1.0 / A[k][k];
    for (int row = k + 1; row < size; ++row) {
      const V factor = A[row][k] * per_pivot;
      for (int j = k + 1; j < size; ++j) A[row][j] -= factor * A[k][j];
      b[row] -= factor * b[k];
    }
    A[k][k] = per_pivot;
  }
  for (int k = size - 1; k >= 0; --k) {
    for (int j = k + 1; j < size; ++j) b[k] -= A[k][j] * b[j];
    b[k] = b[k] * A[k][k];
  }
}

/// The legs of the designs on their way to equilibrium.
template <class V, int flexible>
class LaneStatics {
 public:
  static constexpr int n = flexible == 0 ? 1 : flexible;
  LaneBentLeg<V, flexible> legs[leg_number];
  V failed{};  ///< NaN where there is no equilibrium

  LaneStatics(const MachineNumbers<V>& machine, double tolerance) : machine_(machine) {
    for (int i = 0; i < leg_number; ++i) {
      const auto& leg = machine.legs[i];
      for (int k = 0; k < flexible; ++k) state_[i].at[k] = leg.flexible[k];
      state_[i].oil_force = flexible == 0 ? leg.oil_force_rigid : leg.oil_force;
    }
    scales();
    auto open = failed == failed;
    V before = V{} + 1e300;
    for (int iteration = 0;; ++iteration) {
      const V residual = evaluate();
      const auto ended =
          (residual <= tolerance) | ((residual > 0.5 * before) & (residual <= rounding_));
      const auto lost = ~(residual == residual);
      open = open & ~ended & ~lost;
      failed = select(lost, V{} / V{}, failed);
      if (iteration == most_iterations || !any(open)) break;
      step(open);
      before = residual;
    }
    failed = select(open, V{} / V{}, failed);
    for (const auto& leg : legs)
      if (flexible > 0) failed = select(leg.l_mh > 0.0, failed, V{} / V{});
  }

 private:
  const MachineNumbers<V>& machine_;
  LaneLegState<V, flexible> state_[leg_number];
  V weight_, rounding_;

  /// Of the residual: Problem of statics.cpp.
  void scales() {
    const Space<V> g = space(machine_.gravity);
    V mass = machine_.m, largest{};
    for (const auto& leg : machine_.legs) {
      constexpr double units = 16.0 * rounding_unit;
      mass += leg.m_t + leg.m_g;
      const Space<V> L = space(leg.L);
      largest = larger(largest, V(units * root(dot(L, L)) * larger(leg.k_s, leg.k_g)));
    }
    weight_ = larger(V(mass * root(dot(g, g))), V{} + 1e-300);
    rounding_ = largest / weight_;
  }

  /// The largest residual over the weight.
  V evaluate() {
    const Space<V> g = space(machine_.gravity);
    V balance[6], worst{}, sum{};
    put_wrench(machine_.m * g, {V{}, V{}, V{}}, balance);
    for (int i = 0; i < leg_number; ++i) {
      legs[i].place(machine_.legs[i], g, state_[i]);
      V pushed[6];
      put_wrench(legs[i].joint_force, space(machine_.legs[i].arm), pushed);
      for (int k = 0; k < 6; ++k) balance[k] -= pushed[k];
      for (int k = 3; k < 3 + flexible; ++k) {
        worst = larger(size_of(legs[i].gradient[k]), worst);
        sum += legs[i].gradient[k];
      }
    }
    for (const V& one : balance) {
      worst = larger(size_of(one), worst);
      sum += one;
    }
    return worst / weight_ + 0.0 * sum;  // NaN, where one is
  }

  /// The answer of a leg's own coordinates to a change of its oil force: constant + slope δf.
  struct Response {
    V constant[n], slope[n];
    Space<V> force_constant, force_slope;
  };

  static void respond(const LaneBentLeg<V, flexible>& leg, Response& response) {
    V at_rest[3] = {V{}, V{}, V{}}, per_force[3];
    for (int k = 0; k < 3; ++k) per_force[k] = leg.s_x[k];
    if constexpr (flexible > 0) {
      V H[2][n][n];
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j)
          H[0][i][j] = H[1][i][j] =
              i >= j ? leg.K_without_oil[3 + i][3 + j] : leg.K_without_oil[3 + j][3 + i];
        response.constant[i] = -leg.gradient[3 + i];
        response.slope[i] = -leg.s_x[3 + i];
      }
      solve_lanes<V, n>(H[0], response.constant);
      solve_lanes<V, n>(H[1], response.slope);
      for (int i = 0; i < n; ++i)
        for (int k = 0; k < 3; ++k) {
          at_rest[k] += leg.K_without_oil[3 + i][k] * response.constant[i];
          per_force[k] += leg.K_without_oil[3 + i][k] * response.slope[i];
        }
    }
    const auto in_base = [&](const V(&v)[3]) {
      return v[0] * leg.t + v[1] * leg.a2 + v[2] * leg.n;
    };
    response.force_constant = leg.joint_force + in_base(at_rest);
    response.force_slope = in_base(per_force);
  }

  template <class M>
  void step(const M& open) {
    Response responses[leg_number];
    V A[6][6], df[6];
    put_wrench(machine_.m * space(machine_.gravity), {V{}, V{}, V{}}, df);
    for (int i = 0; i < leg_number; ++i) {
      respond(legs[i], responses[i]);
      const Space<V> arm = space(machine_.legs[i].arm);
      V column[6], pushed[6];
      put_wrench(responses[i].force_slope, arm, column);
      put_wrench(responses[i].force_constant, arm, pushed);
      for (int k = 0; k < 6; ++k) {
        A[k][i] = column[k];
        df[k] -= pushed[k];
      }
    }
    solve_lanes<V, 6>(A, df);
    for (int i = 0; i < leg_number; ++i) move(open, responses[i], df[i], state_[i]);
  }

  template <class M>
  static void move(const M& open, const Response& response, const V& df,
                   LaneLegState<V, flexible>& state) {
    state.oil_force = select(open, V(state.oil_force + df), state.oil_force);
    if constexpr (flexible > 0) {
      constexpr double largest_tilt = 0.2;  // rad per step; offsets follow in proportion
      V change[n];
      for (int k = 0; k < n; ++k) change[k] = response.constant[k] + df * response.slope[k];
      const V tilt = root(change[0] * change[0] + change[1] * change[1]);
      const V share = select(tilt < largest_tilt, V{} + 1.0, largest_tilt / tilt);
      for (int k = 0; k < n; ++k)
        state.at[k] = select(open, V(state.at[k] + share * change[k]), state.at[k]);
    }
  }
};

}  // namespace

}  // namespace hydrapod::study
