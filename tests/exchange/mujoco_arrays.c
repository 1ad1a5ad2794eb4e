// MuJoCo's state as plain arrays, for mujoco_check.py: the compiler knows the layout of its structs.

#include <mujoco/mujoco.h>

// Numbers of generalised positions, velocities and rows of constraints.
void sizes(const mjModel* m, const mjData* d, int out[3]) {
  out[0] = m->nq;
  out[1] = m->nv;
  out[2] = d->nefc;
}

// Everything that follows from `qpos` and `qvel`.
void place(const mjModel* m, mjData* d, const double* qpos, const double* qvel) {
  mju_copy(d->qpos, qpos, m->nq);
  mju_copy(d->qvel, qvel, m->nv);
  mj_fwdPosition(m, d);
  mj_fwdVelocity(m, d);
}

void positions(const mjModel* m, const mjData* d, double* qpos) { mju_copy(qpos, d->qpos, m->nq); }

// nv × nv
void mass(const mjModel* m, const mjData* d, double* M) { mj_fullM(m, M, d->qM); }

// Of springs, dampers, gravity and motion.
void force(const mjModel* m, const mjData* d, double* f) {
  mju_sub(f, d->qfrc_passive, d->qfrc_bias, m->nv);
}

// The gaps of the constraints, and the transpose of their Jacobian by rows: nv × nefc.
void constraints(const mjModel* m, mjData* d, double* transposed, double* gap) {
  mju_copy(gap, d->efc_pos, d->nefc);
  double unit[1000] = {0};
  for (int i = 0; i < m->nv; ++i) {
    unit[i] = 1.0;
    mj_mulJacVec(m, d, transposed + i * d->nefc, unit);
    unit[i] = 0.0;
  }
}
