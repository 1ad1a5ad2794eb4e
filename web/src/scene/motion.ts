// Where every point of the machine is while it moves in a mode.
//
// A mode moves the coordinates y(θ) = Re[(r + i m) e^{iθ}] = r cos θ − m sin θ; points move to
// first order, so a point's displacement is that of its real and imaginary parts, mixed in the same
// way. Complex modes therefore keep their phases: not all parts turn back at the same time.

import { directions, type DrawnLeg, type DrawnPoint, type Geometry, type Leg, type Mode, type Vector } from '../document';
import { add, cross, norm, scale, subtract } from './vector';

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

/** Of a mode of a model, or of one that was measured. */
export type ModeShape = Pick<Mode, 'shape' | 'shape_imaginary'>;

/** A machine at rest with the names of its coordinates. */
export interface AtRest {
  geometry: Geometry;
  coordinates: string[];
}

export interface MachinePoints {
  legs: LegPoints[];
  /** Mass centre of the platform, its displacement and rotation (zero at rest). */
  center: Vector;
  displacement: Vector;
  rotation: Vector;
}

/** A mode shape as displacements of points, per unit amplitude. */
export interface Shape {
  rest: LegPoints[];
  center: Vector;
  real: MachinePoints;
  imaginary: MachinePoints | null;
}

const keys = ['base', 'sleeve', 'piston', 'rodAtSleeve', 'joint'] as const;

const baseNames = directions.map((name) => `base.${name}`);

/** Motion of the base at the origin of its frame: the last of the coordinates, where it has any. */
function baseMotion(coordinates: string[], y: number[]): { shift: Vector; turn: Vector } {
  const of = (name: string): number => {
    const behind = coordinates.length - coordinates.indexOf(name);
    return coordinates.includes(name) ? (y[y.length - behind] ?? 0) : 0;
  };
  const all = baseNames.map(of);
  return { shift: all.slice(0, 3) as Vector, turn: all.slice(3, 6) as Vector };
}

/** The leg with `flexible` coordinates: bent, or with none the straight one in its place. */
const drawnLeg = (leg: Leg, flexible: number): DrawnLeg => (flexible > 0 && leg.bent) || leg.straight;

function restPoints(leg: Leg, flexible: number): LegPoints {
  const { sleeve, piston, rod_at_sleeve: rod } = drawnLeg(leg, flexible);
  return { base: leg.base_joint_m, sleeve: sleeve.at_m, piston: piston.at_m, rodAtSleeve: rod.at_m, joint: leg.platform_joint_m };
}

function displacements(pose: AtRest, y: number[], flexible: number, tilt: number): MachinePoints {
  const center = pose.geometry.platform.mass_center_m;
  const displacement = y.slice(0, 3) as Vector;
  const rotation = y.slice(3, 6) as Vector;
  const base = baseMotion(pose.coordinates, y);
  const carried = (point: Vector): Vector => add(base.shift, cross(base.turn, point));
  const legs = pose.geometry.legs.map((leg, i) => {
    const joint = add(displacement, cross(rotation, subtract(leg.platform_joint_m, center)));
    const own = y.slice(6 + i * flexible, 6 + (i + 1) * flexible).map((value) => tilt * value);
    const x = [...subtract(joint, carried(leg.platform_joint_m)), ...own];
    const moved = (point: DrawnPoint): Vector =>
      add(carried(point.at_m), point.motion.map((row) => row.reduce((sum, value, k) => sum + value * x[k], 0)) as Vector);
    const { sleeve, piston, rod_at_sleeve: rod } = drawnLeg(leg, flexible);
    return { base: carried(leg.base_joint_m), sleeve: moved(sleeve), piston: moved(piston), rodAtSleeve: moved(rod), joint };
  });
  return { legs, center, displacement, rotation };
}

/** The shape of `mode`; `tilt`: factor on rod tilt and piston offset, to make small ones visible. */
export function shapeOf(pose: AtRest, mode: ModeShape, tilt = 1): Shape {
  const beyondLegs = pose.coordinates.filter((name) => /^(base|payload)\./.test(name)).length;
  const flexible = (mode.shape.length - 6 - beyondLegs) / 6;
  const part = (y: number[]) => displacements(pose, y, flexible, tilt);
  return {
    rest: pose.geometry.legs.map((leg) => restPoints(leg, flexible)),
    center: pose.geometry.platform.mass_center_m,
    real: part(mode.shape),
    imaginary: mode.shape_imaginary ? part(mode.shape_imaginary) : null,
  };
}

/** No motion: what stands beside a mode without rigid counterpart. */
export function restShape(pose: AtRest & { rigid_modes: ModeShape[] }): Shape {
  const some = pose.rigid_modes[0] as ModeShape;
  return shapeOf(pose, { shape: some.shape.map(() => 0) });
}

/** Points at `phase`, with the shape multiplied by `amplitude`. */
export function pointsAt(shape: Shape, amplitude: number, phase: number): MachinePoints {
  const c = amplitude * Math.cos(phase);
  const s = -amplitude * Math.sin(phase);
  const mix = (real: Vector, imaginary: Vector | undefined): Vector =>
    imaginary ? add(scale(c, real), scale(s, imaginary)) : scale(c, real);
  const { real, imaginary } = shape;
  return {
    center: shape.center,
    displacement: mix(real.displacement, imaginary?.displacement),
    rotation: mix(real.rotation, imaginary?.rotation),
    legs: shape.rest.map((rest, i) => {
      const moved = { ...rest };
      for (const key of keys)
        moved[key] = add(
          rest[key],
          mix((real.legs[i] as LegPoints)[key], imaginary?.legs[i]?.[key]),
        );
      return moved;
    }),
  };
}

/** Largest displacement of the points named, over all legs and phases (for complex modes a bound). */
export function largest(shape: Shape, which: readonly (keyof LegPoints)[] = keys): number {
  let most = 0;
  shape.real.legs.forEach((leg, i) => {
    for (const key of which)
      most = Math.max(
        most,
        Math.hypot(norm(leg[key]), norm(shape.imaginary?.legs[i]?.[key] ?? [0, 0, 0])),
      );
  });
  return most;
}

/** A typical length of the machine [m]: the longest leg. */
export const sizeOf = (geometry: Geometry): number =>
  Math.max(...geometry.legs.map((leg) => leg.length_m));

/** +1 or −1: the sign that makes the platform move as in `other`. */
export function alignment(shape: Shape, other: Shape): number {
  let product = 0;
  shape.real.legs.forEach((leg, i) => {
    const twin = (other.real.legs[i] as LegPoints).joint;
    product += leg.joint[0] * twin[0] + leg.joint[1] * twin[1] + leg.joint[2] * twin[2];
  });
  return product < 0 ? -1 : 1;
}
