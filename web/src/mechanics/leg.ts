// How one leg moves when its platform joint and its flexible coordinates do, to first order.
//
// In the case's frame (t, a2, n) the platform joint stands at  s n + u + l_mn e(φ)  from the base
// joint, with the piston at s n + u and the rod's direction e = Rot(t, φ1) Rot(a2, φ2) n. Its
// motion δa is
//
//     δa = δs n + ω × (s n + u + l_mn e) + δu + l_mn δe,     ω = ω_t (t + τ n) + ω_2 a2,
//
// with τ the case's spin per rotation about t (gimbal axes; else 0). Three equations for δs, ω_t,
// ω_2. For a straight leg (φ = u = 0) they give  ω⊥ = [n × (δa − δu) − l_mn δφ⊥]/l  and  δs = n·δa.

import type { Leg, Vector } from '../document';
import { add, along, cross, scale, solveColumns, subtract } from './vector';

/** Points of a leg, at rest [m] or as a displacement. */
export interface LegPoints {
  base: Vector;
  /** Guide sleeve on the case's axis. */
  sleeve: Vector;
  piston: Vector;
  /** Rod where it passes the guide sleeve. */
  rodAtSleeve: Vector;
  /** Platform joint. */
  joint: Vector;
}

/** Flexible coordinates of a leg: φ1, φ2 [rad], u1, u2 [m]. */
export type Flexible = [number, number, number, number];

export function restPoints(leg: Leg): LegPoints {
  const base = leg.base_joint_m;
  const { n } = leg.axes;
  const piston = add(along(base, leg.l_m, n), offset(leg));
  const e = rodDirection(leg);
  return {
    base,
    sleeve: along(base, leg.L_g, n),
    piston,
    rodAtSleeve: along(piston, rodToSleeve(leg), e),
    joint: leg.platform_joint_m,
  };
}

/** The straight leg that a rigid machine has in the same place. */
export function straightLeg(leg: Leg): Leg {
  const L = subtract(leg.platform_joint_m, leg.base_joint_m);
  const l = leg.length_m;
  const n = scale(1 / l, L);
  const side: Vector = Math.abs(n[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0];
  const normal = cross(n, side);
  const a2 = scale(1 / Math.hypot(...normal), normal);
  return {
    ...leg,
    axes: { t: cross(a2, n), a2, n },
    l_m: l - leg.l_mn,
    l_mh: leg.L_g - l + leg.l_mn,
    tan_gimbal: 0,
    tilt_rad: [0, 0],
    offset_m: [0, 0],
  };
}

/** Displacement of the leg's points for the joint's displacement `joint` and `flexible`. */
export function legMotion(leg: Leg, joint: Vector, flexible: Flexible): LegPoints {
  const { t, a2, n } = leg.axes;
  const arm = subtract(leg.platform_joint_m, leg.base_joint_m);
  const offsetMotion = along(scale(flexible[2], t), flexible[3], a2);
  const tiltMotion = rodDirectionMotion(leg, flexible);
  const left = subtract(joint, along(offsetMotion, leg.l_mn, tiltMotion));
  const aboutT = along(t, leg.tan_gimbal, n);
  const [extension, w1, w2] = solveColumns(n, cross(aboutT, arm), cross(a2, arm), left);
  const omega = along(scale(w1, aboutT), w2, a2);

  const turn = (arm: Vector): Vector => cross(omega, arm);
  const rest = restPoints(leg);
  const pistonArm = subtract(rest.piston, rest.base);
  const piston = add(along(turn(pistonArm), extension, n), offsetMotion);
  const rodMotion = add(turn(rodDirection(leg)), tiltMotion);
  return {
    base: [0, 0, 0],
    sleeve: turn(scale(leg.L_g, n)),
    piston,
    rodAtSleeve: along(piston, rodToSleeve(leg), rodMotion),
    joint,
  };
}

const rodToSleeve = (leg: Leg): number => leg.l_mh;

function offset(leg: Leg): Vector {
  return along(scale(leg.offset_m[0], leg.axes.t), leg.offset_m[1], leg.axes.a2);
}

/** e = sin φ2 t − sin φ1 cos φ2 a2 + cos φ1 cos φ2 n */
function rodDirection(leg: Leg): Vector {
  const { t, a2, n } = leg.axes;
  const [p1, p2] = leg.tilt_rad;
  const e = along(scale(Math.sin(p2), t), -Math.sin(p1) * Math.cos(p2), a2);
  return along(e, Math.cos(p1) * Math.cos(p2), n);
}

/** δe in the case's frame. */
function rodDirectionMotion(leg: Leg, flexible: Flexible): Vector {
  const { t, a2, n } = leg.axes;
  const [p1, p2] = leg.tilt_rad;
  const [d1, d2] = flexible;
  const alongT = Math.cos(p2) * d2;
  const alongA2 = -Math.cos(p1) * Math.cos(p2) * d1 + Math.sin(p1) * Math.sin(p2) * d2;
  const alongN = -Math.sin(p1) * Math.cos(p2) * d1 - Math.cos(p1) * Math.sin(p2) * d2;
  return along(along(scale(alongT, t), alongA2, a2), alongN, n);
}
