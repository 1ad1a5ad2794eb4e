// Where the machine is when its platform has moved from the pose it is drawn at, exactly: the
// platform is a rigid body, and the legs are drawn straight between their joints.

import type { Geometry, Vector } from '../document';
import type { MachinePoints } from './motion';
import { add, along, subtract, unit } from './vector';

type Rotation = [Vector, Vector, Vector];

/** Rz(rz) Ry(ry) Rx(rx), row by row. */
export function rotationOf([rx, ry, rz]: Vector): Rotation {
  const [cx, sx, cy, sy] = [Math.cos(rx), Math.sin(rx), Math.cos(ry), Math.sin(ry)];
  const [cz, sz] = [Math.cos(rz), Math.sin(rz)];
  return [
    [cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx],
    [sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx],
    [-sy, cy * sx, cy * cx],
  ];
}

const turned = (R: Rotation, v: Vector): Vector =>
  R.map((row) => row[0] * v[0] + row[1] * v[1] + row[2] * v[2]) as Vector;

/** Displacement of the platform's origin [m] and its rotation (rx, ry, rz) [rad], base axes. */
export function movedMachine(geometry: Geometry, shift: Vector, angles: Vector): MachinePoints {
  const { origin_m: origin, mass_center_m: center } = geometry.platform;
  const R = rotationOf(angles);
  const moved = (p: Vector): Vector => add(add(origin, shift), turned(R, subtract(p, origin)));
  const legs = geometry.legs.map((leg) => {
    const base = leg.base_joint_m;
    const joint = moved(leg.platform_joint_m);
    if (leg.strut) return { base, sleeve: base, piston: base, rodAtSleeve: base, joint };
    const n = unit(subtract(joint, base));
    const sleeve = along(base, leg.L_g, n);
    return { base, sleeve, piston: along(joint, -leg.l_mn, n), rodAtSleeve: sleeve, joint };
  });
  return { legs, center, displacement: subtract(moved(center), center), rotation: angles };
}
