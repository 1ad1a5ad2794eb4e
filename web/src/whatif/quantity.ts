// Values in the units of the machine file, or typed with a unit of the reader's own.

import type { Parameter } from '../core/core';
import type { Editable } from '../document';
import { withPoint } from '../numbers';

export interface Unit {
  name: string;
  /** In SI. */
  size: number;
}

/** The unit in which the file writes the parameter, else SI. */
export const unitOf = (editable: Editable, parameter: Parameter): Unit =>
  editable.units[parameter.path] ?? { name: parameter.unit, size: 1 };

export const unitName = (unit: Unit): string => (unit.name === '1' ? '' : unit.name);

/** As short as it reads back, at most 7 digits. */
export const plain = (value: number): string => String(Number(value.toPrecision(7)));

export const inUnit = (value: number, unit: Unit): string => plain(value / unit.size);

export const quantity = (value: number, unit: Unit): string =>
  `${inUnit(value, unit)} ${unitName(unit)}`.trim().replace(/^-/, '−');

/** The value [SI] of "2.5", "2.5 kN/mm"; a text says what would be accepted. */
export function read(
  text: string,
  editable: Editable,
  parameter: Parameter,
): { value: number } | { problem: string } {
  const shown = unitOf(editable, parameter);
  const found = /^([-+−]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)\s*(.*)$/i.exec(withPoint(text.trim()));
  const number = found ? Number(found[1]!.replace('−', '-')) : Number.NaN;
  if (!found || !Number.isFinite(number))
    return { problem: `“${text.trim()}” is not a number, expected one such as ${inUnit(parameter.value, shown)}` };
  const name = found[2]!;
  if (name === '' || name === shown.name) return { value: number * shown.size };
  const scales = editable.scales[parameter.unit] ?? {};
  if (name in scales) return { value: number * scales[name]! };
  const known = Object.keys(scales).join(', ') || 'none';
  return { problem: `unknown unit “${name}”; accepted: ${known}` };
}

/** Where a slider begins and ends [SI], and whether it is logarithmic. */
export interface Range {
  from: number;
  to: number;
  logarithmic: boolean;
}

const spread = /^(N|Pa|kg|m\^3|1\/s$|N s)/;

/** Around the machine's own value: by a factor of ten, or by half for lengths and shares. */
export function rangeOf({ value, unit, bound }: Parameter): Range | null {
  if (value === 0) return null;
  const { lowest = -Infinity, highest = Infinity } = bound;
  const logarithmic = value > 0 && lowest >= 0 && spread.test(unit);
  const ends = logarithmic ? [value / 10, value * 10] : [0.5 * value, 1.5 * value];
  const [from, to] = ends.sort((a, b) => a - b) as [number, number];
  return { from: Math.max(from, lowest), to: Math.min(to, highest), logarithmic };
}

export const sliderSteps = 1000;

export const atStep = ({ from, to, logarithmic }: Range, step: number): number => {
  const share = step / sliderSteps;
  return logarithmic ? from * (to / from) ** share : from + (to - from) * share;
};

export const stepOf = ({ from, to, logarithmic }: Range, value: number): number => {
  const share = logarithmic
    ? Math.log(value / from) / Math.log(to / from)
    : (value - from) / (to - from);
  return Math.round(sliderSteps * Math.min(1, Math.max(0, Number.isNaN(share) ? 0 : share)));
};
