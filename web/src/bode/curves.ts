// The curves of one pair of directions over a band, and what is said about them.

import { magnitude, phase, type Complex } from '../complex';
import type { Band } from '../core/core';
import type { Bode, PoseReport } from '../document';
import { directions } from '../document';

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
  readonly omega: Float64Array;

  constructor(
    private readonly pose: PoseReport,
    private readonly band: Band,
  ) {
    this.omega = band.omega;
  }

  private of({ output, input }: Pair, legs: 'flexible' | 'rigid'): Complex[] {
    const { responses } = this.band;
    const first = (legs === 'rigid' ? 72 * this.omega.length : 0) + 2 * (6 * output + input);
    return Array.from(this.omega, (_, k) => ({ re: responses[first + 72 * k], im: responses[first + 72 * k + 1] }));
  }

  /** Of the machine as it is, or rigid where there is nothing else. */
  magnitudes(pair: Pair): number[] {
    return this.of(pair, this.pose.model === 'rigid' ? 'rigid' : 'flexible').map(magnitude);
  }

  curves(pair: Pair): Curves {
    const frequency = Array.from(this.omega, (omega) => omega / two_pi);
    const flexible = this.pose.model === 'rigid' ? null : this.of(pair, 'flexible');
    const rigid = this.of(pair, 'rigid');
    const coupled = this.isCoupled(pair);
    return {
      pair,
      frequency,
      flexible,
      rigid,
      marks: flexible && coupled ? this.marks(pair, 'flexible', frequency, flexible) : [],
      rigidMarks: coupled ? this.marks(pair, 'rigid', frequency, rigid) : [],
    };
  }

  /** Peaks: those that the program found where input and output agree, else those of the curve. */
  private marks({ output, input }: Pair, legs: 'flexible' | 'rigid', frequency: number[], H: Complex[]): Mark[] {
    if (output !== input)
      return this.band.peaks
        .filter((peak) => peak.legs === legs && peak.output === output && peak.input === input)
        .map(({ line, mode }) => ({ frequency: frequency[line], magnitude: magnitude(H[line]), mode }));
    const { peaks, rigid_peaks } = this.pose.bode as Bode;
    return (legs === 'flexible' ? peaks : rigid_peaks)
      .filter((peak) => peak.direction === directions[output])
      .filter((peak) => peak.frequency_hz >= frequency[0] && peak.frequency_hz <= frequency[frequency.length - 1])
      .map((peak) => ({ frequency: peak.frequency_hz, magnitude: peak.magnitude ?? highest(H), mode: peak.mode }));
  }

  /** Does the input move the output at all, beyond rounding? */
  isCoupled({ output, input }: Pair): boolean {
    const most = (i: number, j: number) =>
      this.magnitudes({ output: i, input: j }).reduce((max, size) => Math.max(max, size), 0);
    const rounding = 1e-9;
    return most(output, input) > rounding * Math.sqrt(most(output, output) * most(input, input));
  }
}

const highest = (H: Complex[]): number =>
  H.map(magnitude).reduce((a, b) => (Number.isFinite(b) && b > a ? b : a), 0);

export function unitOf({ output, input }: Pair): string {
  return `${output < 3 ? 'm' : 'rad'}/${input < 3 ? 'N' : '(N m)'}`;
}

export const motionName = (d: number): string => directions[d];
export const loadName = (d: number): string =>
  `${d < 3 ? 'force' : 'moment'} ${d < 3 ? directions[d] : directions[d][1]}`;

export const titleOf = (pair: Pair): string =>
  `${motionName(pair.output)} per ${loadName(pair.input)}`;

/** `about`: lines above the table. */
export function csv(curves: Curves, about: string[]): string {
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
  const comments = about.map((text) => `# ${text.replace(/[\u0000-\u001f]/g, ' ')}\n`);
  return `${comments.join('')}${head.join(',')}\n${rows.join('\n')}\n`;
}
