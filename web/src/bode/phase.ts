// Phases over frequency. Measured curves are not made continuous: noise would turn them. They are cut where no curve is.

import type uPlot from 'uplot';
import { phase, type Complex } from '../complex';

/** [°] plus the whole turns that bring it to `from` or up to a turn above. */
export const withinTurn = (angle: number, from: number): number => angle - 360 * Math.floor((angle - from) / 360);

/** The angle from which a turn has most room at both ends, −360 … 0 [°]. */
export function phaseCut(curves: readonly (readonly Complex[])[]): number {
  const bins = 72;
  const counts = new Array<number>(bins).fill(0);
  for (const h of curves.flat()) if (Number.isFinite(h.re + h.im)) ++counts[Math.floor((withinTurn(phase(h), 0) * bins) / 360) % bins]!;
  const least = Math.min(...counts);
  let [longest, middle] = [0, bins / 2];
  for (let begin = 0; begin < bins; ++begin) {
    let length = 0;
    while (length < bins && counts[(begin + length) % bins] === least) ++length;
    if (length > longest && length < bins) [longest, middle] = [length, begin + length / 2];
  }
  return ((middle % bins) * 360) / bins - 360;
}

/** Steps of more than this are no way that a phase goes from line to line: they are at the cut, or noise. */
const most = 135;
export const isCut = (before: number, value: number): boolean => Math.abs(value - before) > most;

/** Phases [°] from `cut` on; null before and behind a step: the line has a gap there. */
export function phaseLine(H: readonly Complex[], cut: number): (number | null)[] {
  const angles = H.map((h) => withinTurn(phase(h), cut));
  const cuts = (k: number) => k > 0 && k < angles.length && isCut(angles[k - 1]!, angles[k]!);
  return angles.map((value, k) => (cuts(k) || cuts(k + 1) ? null : value));
}

/** Multiples of 90° in sight. */
export function phaseTicks(low: number, high: number): number[] {
  const first = Math.ceil(low / 90);
  return Array.from({ length: Math.max(0, Math.floor(high / 90) - first + 1) }, (_, k) => 90 * (first + k));
}

export const phaseText = (degrees: number): string => `${degrees}°`.replace('-', '−');

/** With room above and below, where a line along the frame would not be seen. */
export const phaseScale: uPlot.Scale = { distr: 1, range: (_, min, max) => [(min ?? -180) - 10, (max ?? 180) + 10] };
