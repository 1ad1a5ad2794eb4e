// The selected poles: at first those of modes and heavily damped ones; the reader switches them, and
// adds poles of the chart by hand.

import type { ChartPole, FittedPole, Identification, Pole } from './types';

export interface ChosenPole extends Pole {
  kind: 'mode' | 'heavy' | 'hand';
  /** Of modes and heavily damped poles, from 1; of poles by hand their model order. */
  number: number;
  on: boolean;
  frequency_hz: number;
  damping_ratio: number;
}

export class Choice {
  readonly poles: ChosenPole[];
  private readonly added = new Map<ChartPole, ChosenPole>();
  onChange: () => void = () => {};

  constructor(private readonly data: Identification) {
    const from = (kind: ChosenPole['kind']) => (mode: FittedPole, k: number) => ({
      kind,
      number: k + 1,
      on: true,
      pole: mode.pole,
      participation: mode.participation,
      frequency_hz: mode.frequency_hz,
      damping_ratio: mode.damping_ratio,
    });
    this.poles = [...data.modes.map(from('mode')), ...data.heavily_damped.map(from('heavy'))];
  }

  get active(): ChosenPole[] {
    return this.poles.filter((pole) => pole.on);
  }

  /** Every pole of the identification is on, and no other. */
  get untouched(): boolean {
    return this.poles.every((pole) => pole.on && pole.kind !== 'hand');
  }

  /** The pole of a mark of the chart, if it is one of `poles`. */
  of(mark: ChartPole): ChosenPole | undefined {
    const cluster = mark.cluster === null ? undefined : this.data.clusters[mark.cluster - 1];
    if (cluster?.mode) return this.poles.find((p) => p.kind === 'mode' && p.number === cluster.mode);
    if (cluster?.heavily_damped)
      return this.poles.find((p) => p.kind === 'heavy' && p.number === cluster.heavily_damped);
    return this.added.get(mark);
  }

  /** Is it on, by itself or through its mode? */
  isOn(mark: ChartPole): boolean {
    return this.of(mark)?.on ?? false;
  }

  set(pole: ChosenPole, on: boolean): void {
    pole.on = on;
    if (!on && pole.kind === 'hand') this.remove(pole);
    this.onChange();
  }

  /** A click on a mark: switches its mode, or adds the pole or takes it out again. */
  toggle(mark: ChartPole, order: number): void {
    const known = this.of(mark);
    if (known) return this.set(known, !known.on);
    const pole: ChosenPole = {
      kind: 'hand',
      number: order,
      on: true,
      pole: mark.pole,
      participation: mark.participation,
      frequency_hz: mark.frequency_hz,
      damping_ratio: mark.damping_ratio,
    };
    this.added.set(mark, pole);
    this.poles.push(pole);
    this.onChange();
  }

  reset(): void {
    this.added.clear();
    for (let k = this.poles.length - 1; k >= 0; --k)
      if (this.poles[k].kind === 'hand') this.poles.splice(k, 1);
    for (const pole of this.poles) pole.on = true;
    this.onChange();
  }

  private remove(pole: ChosenPole): void {
    this.poles.splice(this.poles.indexOf(pole), 1);
    for (const [mark, chosen] of this.added) if (chosen === pole) this.added.delete(mark);
  }
}
