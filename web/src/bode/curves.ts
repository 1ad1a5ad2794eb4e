// The curves of one pair of directions over a band, and what is said about them.

import type { Bode, PoseReport } from '../document';
import { directions } from '../document';
import type { Complex } from '../complex';
import { entry, grid, leadingMode, magnitude, phase, responseAt, type Matrix6 } from '../mechanics/response';

export interface Pair {
  output: number;
  input: number;
}

export interface Mark {
  frequency: number;
  magnitude: number;
  mode: number;
}

export interface Curves {
  pair: Pair;
  frequency: number[]; // Hz
  flexible: Complex[] | null;
  rigid: Complex[];
  marks: Mark[];
  rigidMarks: Mark[];
}

const two_pi = 2 * Math.PI;

/** All 36 responses over a band; the pairs are read out of it. */
export class Sweep {
  readonly omega: number[];
  private readonly flexible: Matrix6[] | null;
  private readonly rigid: Matrix6[];
  private readonly bode: Bode;

  constructor(pose: PoseReport, from: number, to: number, points: number) {
    this.bode = pose.bode as Bode;
    const flexible = pose.model !== 'rigid';
    this.omega = grid(
      flexible ? [this.bode.real, this.bode.rigid] : [this.bode.rigid],
      from,
      to,
      points,
    );
    this.flexible = flexible ? this.omega.map((omega) => responseAt(this.bode.real, omega)) : null;
    this.rigid = this.omega.map((omega) => responseAt(this.bode.rigid, omega));
  }

  /** The machine as it is, or rigid where there is nothing else. */
  get shown(): Matrix6[] {
    return this.flexible ?? this.rigid;
  }

  curves(pair: Pair): Curves {
    const of = (sweep: Matrix6[]) => sweep.map((H) => entry(H, pair.output, pair.input));
    const frequency = this.omega.map((omega) => omega / two_pi);
    const flexible = this.flexible && of(this.flexible);
    const rigid = of(this.rigid);
    const { bode } = this;
    const uncoupled = !this.isCoupled(pair);
    return {
      pair,
      frequency,
      flexible,
      rigid,
      marks: flexible && !uncoupled ? marks(bode, 'real', pair, frequency, flexible) : [],
      rigidMarks: uncoupled ? [] : marks(bode, 'rigid', pair, frequency, rigid),
    };
  }

  /** Does the input move the output at all, beyond rounding? */
  isCoupled({ output, input }: Pair): boolean {
    const most = (i: number, j: number) =>
      this.shown.reduce((max, H) => Math.max(max, magnitude(entry(H, i, j))), 0);
    const rounding = 1e-9;
    return most(output, input) > rounding * Math.sqrt(most(output, output) * most(input, input));
  }
}

/** Peaks: those that the program found where input and output agree, else the curve's maxima. */
function marks(
  bode: Bode,
  which: 'real' | 'rigid',
  pair: Pair,
  frequency: number[],
  H: Complex[],
): Mark[] {
  const [first, last] = [frequency[0], frequency[frequency.length - 1]];
  if (pair.output === pair.input)
    return (which === 'real' ? bode.peaks : bode.rigid_peaks)
      .filter((peak) => peak.direction === directions[pair.output])
      .filter((peak) => peak.frequency_hz >= first && peak.frequency_hz <= last)
      .map((peak) => ({
        frequency: peak.frequency_hz,
        magnitude: peak.magnitude ?? highest(H),
        mode: peak.mode,
      }));
  const size = H.map(magnitude);
  const found: Mark[] = [];
  for (let i = 1; i + 1 < size.length; ++i)
    if (size[i] > size[i - 1] && size[i] >= size[i + 1] && prominent(size, i))
      found.push({
        frequency: frequency[i],
        magnitude: size[i],
        mode: leadingMode(bode[which], pair.output, pair.input, two_pi * frequency[i]),
      });
  return found;
}

const highest = (H: Complex[]): number =>
  H.map(magnitude).reduce((a, b) => (Number.isFinite(b) && b > a ? b : a), 0);

/** Three decibels above the valleys on both sides. */
function prominent(size: number[], peak: number): boolean {
  const wanted = size[peak] / Math.SQRT2;
  const falls = (step: number): boolean => {
    for (let i = peak + step; i >= 0 && i < size.length; i += step) {
      if (size[i] > size[peak]) return false;
      if (size[i] < wanted) return true;
    }
    return false;
  };
  return falls(-1) && falls(1);
}

export function unitOf({ output, input }: Pair): string {
  return `${output < 3 ? 'm' : 'rad'}/${input < 3 ? 'N' : '(N m)'}`;
}

export const motionName = (d: number): string => directions[d];
export const loadName = (d: number): string =>
  `${d < 3 ? 'force' : 'moment'} ${d < 3 ? directions[d] : directions[d][1]}`;

export const titleOf = (pair: Pair): string =>
  `${motionName(pair.output)} per ${loadName(pair.input)}`;

export function csv(curves: Curves): string {
  const { flexible } = curves;
  const columns = (name: string) => [
    `${name}_re`,
    `${name}_im`,
    `${name}_magnitude`,
    `${name}_phase_deg`,
  ];
  const values = (h: Complex) => [h.re, h.im, magnitude(h), phase(h)];
  const head = [
    'frequency_hz',
    'omega_rad_s',
    ...(flexible ? columns('flexible') : []),
    ...columns('rigid'),
  ];
  const rows = curves.frequency.map((f, i) =>
    [f, two_pi * f, ...(flexible ? values(flexible[i]) : []), ...values(curves.rigid[i])].join(','),
  );
  return `${head.join(',')}\n${rows.join('\n')}\n`;
}
