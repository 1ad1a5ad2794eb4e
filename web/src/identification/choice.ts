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
  /** Poles that the reader has added, also those that are switched off again. */
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
    const added = this.added.get(mark);
    return added?.on ? added : undefined;
  }

  /** Is it on, by itself or through its mode? */
  isOn(mark: ChartPole): boolean {
    return this.of(mark)?.on ?? false;
  }

  /** A pole that the reader has added is in the list only while it is on. */
  set(pole: ChosenPole, on: boolean): void {
    pole.on = on;
    if (pole.kind === 'hand') {
      const at = this.poles.indexOf(pole);
      if (on && at < 0) this.poles.push(pole);
      if (!on && at >= 0) this.poles.splice(at, 1);
    }
    this.onChange();
  }

  /** A click on a mark: switches its mode, or adds the pole or takes it out again. */
  toggle(mark: ChartPole, order: number): void {
    const known = this.of(mark) ?? this.added.get(mark) ?? this.add(mark, order);
    this.set(known, !known.on);
  }

  /** As identified: every pole of the identification is on, and no other. */
  reset(): void {
    for (const pole of this.added.values()) pole.on = false;
    this.poles.splice(0, this.poles.length, ...this.poles.filter((pole) => pole.kind !== 'hand'));
    for (const pole of this.poles) pole.on = true;
    this.onChange();
  }

  private add(mark: ChartPole, order: number): ChosenPole {
    const pole: ChosenPole = {
      kind: 'hand',
      number: order,
      on: false,
      pole: mark.pole,
      participation: mark.participation,
      frequency_hz: mark.frequency_hz,
      damping_ratio: mark.damping_ratio,
    };
    this.added.set(mark, pole);
    return pole;
  }
}
