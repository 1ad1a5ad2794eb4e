#pragma once
/// M and K of several designs at once: dynamics::linear_model() on a base that stands still.
/// Private to the kernels.

#include "lane_statics.hpp"

namespace hydrapod::study {

namespace {

template <class V, int flexible>
HYDRAPOD_INLINE void clear(BlockMatrix<V, flexible>& A) {
  for (auto& number : A.platform) number = V{};
}

/// Adds a leg's matrix, brought to the coordinates of the model by J.
template <class V, int flexible>
HYDRAPOD_INLINE void add_leg(const V (&A)[3 + flexible][3 + flexible], const V (&J)[3][6], int leg,
                             BlockMatrix<V, flexible>& sum) {
  V AJ[3][6];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 6; ++j)
      AJ[i][j] = A[i][0] * J[0][j] + (i >= 1 ? A[i][1] : A[1][i]) * J[1][j] +
                 (i >= 2 ? A[i][2] : A[2][i]) * J[2][j];
  for (int i = 0, at = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j, ++at)
      sum.platform[at] += J[0][i] * AJ[0][j] + J[1][i] * AJ[1][j] + J[2][i] * AJ[2][j];
  auto& of_leg = sum.legs[leg];
  for (int i = 0, at = 0; i < flexible; ++i) {
    for (int j = 0; j < 6; ++j)
      of_leg.border[i][j] = A[3 + i][0] * J[0][j] + A[3 + i][1] * J[1][j] + A[3 + i][2] * J[2][j];
    for (int j = 0; j <= i; ++j) of_leg.own[at++] = A[3 + i][3 + j];
  }
}

/// `arm`: from the platform's mass centre to the joint.
template <class V, int flexible>
HYDRAPOD_INLINE void add_leg(const LaneLeg<V, flexible>& leg, const Space<V>& arm, int number,
                             BlockMatrix<V, flexible>& M, BlockMatrix<V, flexible>& K) {
  const Space<V> axes[3] = {leg.t, leg.a2, leg.n};
  V J[3][6];
  for (int i = 0; i < 3; ++i) put_wrench(axes[i], arm, J[i]);
  add_leg<V, flexible>(leg.M, J, number, M);
  add_leg<V, flexible>(leg.K, J, number, K);
}

/// λ·∂²a/∂w² of a joint that carries λ; the platform's rotation moves it on a sphere.
template <class V, int flexible>
HYDRAPOD_INLINE void add_rotation_curvature(const Space<V>& lambda, const Space<V>& arm,
                                            BlockMatrix<V, flexible>& K) {
  const V force[3] = {lambda.x, lambda.y, lambda.z}, along[3] = {arm.x, arm.y, arm.z};
  const V power = dot(lambda, arm);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) {
      V& entry = K.platform[BlockMatrix<V, flexible>::below(3 + i, 3 + j)];
      entry += 0.5 * (force[i] * along[j] + force[j] * along[i]);
      if (i == j) entry -= power;
    }
}

/// The model of the machines; what is added to a residual: NaN where there is no equilibrium.
template <class V, int flexible>
V assemble(const MachineNumbers<V>& machine, const LaneOptions& options,
           BlockMatrix<V, flexible>& M, BlockMatrix<V, flexible>& K) {
  clear(M);
  clear(K);
  for (int i = 0; i < 3; ++i) {
    M.platform[BlockMatrix<V, flexible>::below(i, i)] = machine.m;
    for (int j = 0; j <= i; ++j)
      M.platform[BlockMatrix<V, flexible>::below(3 + i, 3 + j)] =
          machine.inertia[BlockMatrix<V, flexible>::below(i, j)];
  }
  LaneLeg<V, flexible> element;
  if (!options.gravity) {
    for (int i = 0; i < leg_number; ++i) {
      straight_leg(machine.legs[i], options.gimbal, element);
      add_leg(element, space(machine.legs[i].arm), i, M, K);
    }
    return V{};
  }
  const LaneStatics<V, flexible> statics(machine, options.tolerance);
  for (int i = 0; i < leg_number; ++i) {
    const Space<V> arm = space(machine.legs[i].arm);
    statics.legs[i].element(machine.legs[i], options.gimbal, element);
    add_leg(element, arm, i, M, K);
    add_rotation_curvature(statics.legs[i].joint_force, arm, K);
  }
  return statics.failed;
}

}  // namespace

}  // namespace hydrapod::study
