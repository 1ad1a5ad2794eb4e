// Ticks of logarithmic axes.

import { significant } from '../numbers';
import { niceLevels } from '../workspace/contour';

/** Multiples of the powers of ten, from fine to coarse. */
const steps = [[1, 2, 3, 4, 5, 6, 7, 8, 9], [1, 2, 5], [1, 3], [1]];

/** The multiples `of` powers of ten, of every `nth` power, between two values. */
function multiples(from: number, to: number, of: number[], nth = 1): number[] {
  const values: number[] = [];
  for (let e = Math.floor(Math.log10(from)); e <= Math.ceil(Math.log10(to)); ++e)
    for (const step of e % nth === 0 ? of : []) {
      const value = step * 10 ** e;
      if (value >= from * (1 - 1e-9) && value <= to * (1 + 1e-9)) values.push(value);
    }
  return values;
}

export const tickText = (value: number): string => significant(value, 6);

/** Width of a label [px] of 12 px high digits, and the least distance of two. */
const widthOf = (value: number): number => 8 * tickText(value).length;
const apart = 8;

/**
 * The finest ticks of a frequency axis whose labels, in the middle of `x` [px], do not touch each other. Those
 * whose labels do not end before `right` are left out.
 */
export function labelled(from: number, to: number, x: (value: number) => number, right: number): number[] {
  const within = to < 2 * from ? [niceLevels(from, to)] : [];
  const powers = [2, 3, 4].map((nth) => multiples(from, to, [1], nth));
  const candidates = [...within, ...steps.map((of) => multiples(from, to, of)), ...powers].map((values) =>
    values.filter((value) => x(value) + widthOf(value) / 2 <= right),
  );
  const fit = (values: number[]) =>
    values.every((value, k) => {
      const before = values[k - 1];
      return before === undefined || x(value) - x(before) >= (widthOf(value) + widthOf(before)) / 2 + apart;
    });
  // a band within one step has no tick of a coarse kind
  return candidates.find((values) => values.length > 0 && fit(values)) ?? [];
}

/** At most ten ticks of a logarithmic axis of magnitudes. */
export function magnitudeTicks(from: number, to: number): number[] {
  const decades = Math.log10(to / from);
  const all = multiples(from, to, [1, 2, 3, 4, 5, 6, 7, 8, 9]);
  const isDecade = (value: number) =>
    Math.abs(Math.log10(value) - Math.round(Math.log10(value))) < 1e-9;
  const shown =
    decades > 2.5
      ? all.filter(isDecade)
      : decades > 1
        ? all.filter((v) => /^[125]/.test(v.toExponential()))
        : all;
  const every = Math.ceil(shown.length / 10);
  return shown.filter((_, i) => i % every === 0);
}
