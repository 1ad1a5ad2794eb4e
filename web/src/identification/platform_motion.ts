// How the platform moves in a measured mode, from the outputs that measure its directions.

import type { Complex } from '../complex';
import { directions } from '../document';
import type { ModeShape } from '../scene/motion';
import type { Channel, Vector } from './types';

/** x … rz of the mass centre [m, rad], at any scale. */
export interface PlatformMotion extends Vector {
  /** Directions that no output measures; they are drawn at rest. */
  missing: string[];
}

/** null: no output is a direction of the platform. */
export function platformMotion(outputs: Channel[], displacement: Vector): PlatformMotion | null {
  const motion: PlatformMotion = { re: [], im: [], missing: [] };
  directions.forEach((name, d) => {
    motion.re[d] = motion.im[d] = 0;
    const o = outputs.map(({ direction }) => direction === name || direction === `-${name}`).lastIndexOf(true);
    const [re, im] = [displacement.re[o], displacement.im[o]];
    if (o < 0 || !Number.isFinite(re) || !Number.isFinite(im)) {
      motion.missing.push(name);
      return;
    }
    const sign = outputs[o].direction === name ? 1 : -1;
    motion.re[d] = sign * re;
    motion.im[d] = sign * im;
  });
  return motion.missing.length === directions.length ? null : motion;
}

/** Of outputs that are speeds or accelerations the displacement, φ/λ^d. */
export function displacementOf(outputs: Channel[], pole: Complex, shape: Complex[]): Vector {
  const result: Vector = { re: [], im: [] };
  shape.forEach((value, o) => {
    let { re, im } = value;
    const square = pole.re ** 2 + pole.im ** 2;
    for (let d = outputs[o].time_derivatives ?? 0; d > 0; --d)
      [re, im] = [(re * pole.re + im * pole.im) / square, (im * pole.re - re * pole.im) / square];
    result.re.push(re);
    result.im.push(im);
  });
  return result;
}

/**
 * The same motion with its phase turned so that most of it is in the real part, where `arm` [m] makes
 * lengths of rotations. A mode whose parts move in phase has no imaginary part then.
 */
export function turnedToReal({ re, im }: Vector, arm: number): ModeShape {
  let [c, s] = [0, 0];
  re.forEach((a, d) => {
    const size = d < 3 ? 1 : arm * arm;
    c += size * (a * a - im[d] * im[d]);
    s += size * 2 * a * im[d];
  });
  const angle = -0.5 * Math.atan2(s, c);
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  return {
    shape: re.map((a, d) => a * cos - im[d] * sin),
    shape_imaginary: re.map((a, d) => a * sin + im[d] * cos),
  };
}
