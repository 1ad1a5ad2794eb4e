// What a picture of two machines side by side can do, with WebGL or without.

import type { Geometry, Vector } from '../document';
import { sizeOf, type LegPoints, type MachinePoints } from './motion';
import { add, norm, scale, subtract } from './vector';

export type Side = 'flexible' | 'rigid';

/** Where the camera stands: on a sphere about `target`. */
export interface Camera {
  azimuth: number;
  elevation: number;
  /** Distance in radii of the machine. */
  distance: number;
}

export const homeCamera: Camera = { azimuth: -1.02, elevation: 0.3, distance: 3.75 };

export interface View {
  kind: 'webgl' | 'svg';
  element: HTMLElement;
  setMachine(geometry: Geometry, sides: Side[]): void;
  setPoints(side: Side, points: MachinePoints): void;
  /** Reads the points of a leg back from what is drawn. */
  readPoints(side: Side, leg: number): LegPoints;
  orbit(azimuth: number, elevation: number, zoom: number): void;
  resetCamera(): void;
  setLabels(shown: boolean): void;
  recolour(): void;
  draw(): void;
}

export interface Sizes {
  target: Vector;
  /** Longest leg [m]. */
  size: number;
  /** Of a sphere about `target` that holds all joints [m]. */
  radius: number;
  caseRadius(leg: number): number;
  rodRadius(leg: number): number;
  plate: number;
}

/** To scale where the machine says how thick things are; else cylinders of a common proportion. */
export function sizesOf(geometry: Geometry): Sizes {
  const size = sizeOf(geometry);
  const bottom = geometry.legs.reduce<Vector>((sum, leg) => add(sum, leg.base_joint_m), [0, 0, 0]);
  const top = geometry.legs.reduce<Vector>((sum, leg) => add(sum, leg.platform_joint_m), [0, 0, 0]);
  const wall = 1.2;
  const target = scale(1 / 12, add(bottom, top));
  const joints = geometry.legs.flatMap((leg) => [leg.base_joint_m, leg.platform_joint_m]);
  return {
    target,
    size,
    radius: Math.max(...joints.map((p) => norm(subtract(p, target)))),
    caseRadius: (leg) => (wall * (geometry.legs[leg]?.bore_m ?? 0.075 * size)) / 2,
    rodRadius: (leg) => (geometry.legs[leg]?.rod_diameter_m ?? 0.036 * size) / 2,
    plate: 0.03 * size,
  };
}

/** The joints in the order in which a plate through them is outlined. */
export function outline(joints: Vector[], center: Vector): number[] {
  const angle = (p: Vector) => Math.atan2(p[1] - center[1], p[0] - center[0]);
  return joints.map((_, i) => i).sort((a, b) => angle(joints[a]) - angle(joints[b]));
}
