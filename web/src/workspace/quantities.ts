// What a map can show, and the units of its directions.

import { map } from '../core/core';
import { directions, type Editable } from '../document';
import { fixed, significant } from '../numbers';

export interface Quantity {
  name: string;
  unit: string;
  /** In `unit`, of a row of the core's map. */
  of(row: Float64Array): number;
  /** Name of the column of `hydrapod map`. */
  column: string;
}

const column = (name: string, column: string, at: number, unit: string, factor = 1): Quantity => ({
  name,
  unit,
  column,
  of: (row) => factor * (row[at] as number),
});

/** Of the lowest mode, and of the first resonances. */
const ofModes = (name: string, of: 'drop' | 'share' | 'peak', unit: string, factor: number): Quantity[] => [
  column(`${name} of the lowest mode`, of, map[of], unit, factor),
  ...directions.map((d, k) => column(`${name} of the first resonance in ${d}`, `${of}_${d}`, map[`${of}s`] + k, unit, factor)),
];

export const quantities: Quantity[] = [
  column('Lowest mode', 'lowest', map.lowest, 'Hz'),
  ...directions.map((d, k) => column(`First resonance in ${d}`, d, map.first + k, 'Hz')),
  ...ofModes('Drop', 'drop', '%', 100),
  ...ofModes('Share', 'share', '%', 100),
  ...ofModes('Peak', 'peak', '', 1),
  column('Stroke left', 'stroke', map.stroke, 'mm', 1e3),
];

/** "Lowest mode, undamped": the tables of modes have damped frequencies. */
export const nameOf = ({ name, unit }: Quantity, { frequencies }: Editable): string =>
  unit === 'Hz' ? `${name}, ${frequencies}` : name;

const degree = Math.PI / 180;

/** Unit of a displacement, and its size in SI. */
export const unitOf = (direction: number): [name: string, size: number] =>
  direction < 3 ? ['mm', 1e-3] : ['deg', degree];

export function displacementText(direction: number, value: number): string {
  const [unit, size] = unitOf(direction);
  const shown = value / size;
  const digits = direction < 3 ? 1 : 2;
  // less than the last decimal is not nothing; rounding errors are
  const isSmall = Math.abs(shown) >= 1e-6 && Math.abs(shown) < 10 ** -digits;
  return `${isSmall ? significant(shown, 2) : fixed(Math.abs(shown) < 1e-6 ? 0 : shown, digits)} ${unit}`;
}

/** "x=12 mm, ry=0.5 deg", as `--pose` takes it; "neutral" where nothing is displaced. */
export function poseText(displaced: readonly number[]): string {
  const parts = displaced.flatMap((value, d) => {
    const [unit, size] = unitOf(d);
    return value === 0 ? [] : [`${directions[d]}=${Number((value / size).toPrecision(6))} ${unit}`];
  });
  return parts.join(', ') || 'neutral';
}
